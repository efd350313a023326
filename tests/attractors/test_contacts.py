"""Repetitions of a run, and how a disturbance shrinks, against what they mean, written plainly."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vines.attractors._contacts import difference, repetition
from vines.attractors._multipliers import multipliers
from vines.dynamics import _advance as col


def _rows(times: np.ndarray, sides: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    rows = rng.normal(size=(len(times) + 1, col.ROW))
    rows[1:, col.TIME], rows[1:, col.SIDE] = times, sides
    return rows


def _plainly(rows: np.ndarray, kept: np.ndarray, span: float, scale: float) -> tuple[int, list[float]]:
    """Return the contacts in a span and the largest difference of each repetition, the newest first."""
    n = len(kept)
    away = np.abs(rows[kept[1:], col.TIME] - (rows[kept[0], col.TIME] + span))
    lag = int(np.flatnonzero(away == away.min())[-1]) + 1
    differences = []
    for end in range(n, 2 * lag - 1, -lag):
        now, before = rows[kept[end - lag : end]], rows[kept[end - 2 * lag : end - lag]]
        if np.any(now[:, col.SIDE] != before[:, col.SIDE]):
            return 0, []
        states = (col.X1, col.V1, col.V2)
        parts = [np.abs(now[:, col.TIME] - before[:, col.TIME] - span)]
        parts += [np.abs(now[:, k] - before[:, k]) / scale for k in states]
        differences.append(float(np.max(parts)))
    return (lag, differences) if differences else (0, [])


@settings(deadline=None, max_examples=200)
@given(st.integers(0, 2**31), st.integers(2, 40), st.integers(1, 5), st.booleans())
def test_repetitions_are_those_of_the_definition(seed: int, n: int, length: int, even: bool) -> None:
    rng = np.random.default_rng(seed)
    # Times of equal spacing have two contacts equally near to the end of a span.
    times = np.arange(1.0, n + 1.0) if even else np.cumsum(rng.exponential(size=n))
    sides = np.resize(rng.choice([-1.0, 1.0], size=length), n)
    rows, kept = _rows(times, sides, rng), np.arange(1, n + 1)
    for span in (0.5, 1.5, float(length), *rng.uniform(0.0, times[-1], 3).tolist()):
        lag, differences = _plainly(rows, kept, span, 0.7)
        assert repetition(rows, kept, span) == (lag, len(differences))
        for age, expected in enumerate(differences):
            assert difference(rows, kept, lag, span, 0.7, age) == pytest.approx(expected, rel=1e-12)


@settings(deadline=None, max_examples=100)
@given(st.integers(0, 2**31))
def test_multipliers_are_eigenvalues_with_the_largest_first(seed: int) -> None:
    Y = np.random.default_rng(seed).normal(size=(4, 4))
    roots = np.empty(4, dtype=complex)
    largest = multipliers(Y, roots)
    assert largest == pytest.approx(abs(roots[0]), rel=1e-12)
    assert np.all(np.diff(np.abs(roots)) <= 1e-12)
    expected = np.linalg.eigvals(Y)
    assert all(np.min(np.abs(expected - root)) < 1e-8 for root in roots)
