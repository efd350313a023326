"""Standard errors of motion that never repeats: those of series whose law is known, and the scatter between runs."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.errors import NAMES, scores
from vines.attractors import classify_many, settle
from vines.attractors._errors import PARTS, WINDOWS, errors_of
from vines.dynamics import ensemble
from vines.dynamics._batches import error_of_mean
from vines.model import Params


def _series(memory: float, runs: int, parts: int, seed: int) -> np.ndarray:
    """Return series of x1^2, v1^2, v2^2 and largest |x1| whose logarithms forget as exp(-parts/memory)."""
    rng = np.random.default_rng(seed)
    keep = np.exp(-1.0 / memory) if memory else 0.0
    noise = rng.normal(size=(runs, parts + 400, 4))
    for k in range(1, noise.shape[1]):
        noise[:, k] = keep * noise[:, k - 1] + np.sqrt(1.0 - keep**2) * noise[:, k]
    return np.exp(0.3 * noise[:, 400:])


@pytest.mark.parametrize("memory", [0.0, 3.0, 12.0])
def test_the_scatter_of_windows_is_that_between_independent_ones(memory: float) -> None:
    # Many windows of a run of its own each: their scatter is the true one, whatever the memory is.
    duration = np.full(2000, float(PARTS))
    series = _series(memory, 2000, PARTS, 1)
    true = np.std([errors_of(series, PARTS, duration)[0]], axis=1, ddof=1)[0]
    found, scatter, freedom = errors_of(_series(memory, 400, PARTS * WINDOWS, 2), PARTS, duration[:400])
    assert np.isfinite(found).all()
    assert np.sqrt(np.mean(scatter**2, axis=0)) == pytest.approx(true, rel=0.12)
    assert np.median(freedom) == pytest.approx({0.0: 14.5, 3.0: 11.0, 12.0: 7.0}[memory], rel=0.2)


def test_the_largest_of_windows_is_taken_over_the_window() -> None:
    series = np.zeros((1, 4 * PARTS, 4))
    series[0, :, :3] = 1.0
    series[0, :, 3] = np.arange(4 * PARTS)
    mean, _, _ = errors_of(series, PARTS, np.array([1.0]))
    assert mean[0, 1] == pytest.approx(np.mean(np.arange(PARTS - 1, 4 * PARTS)))


def test_parts_of_one_run_tell_an_error_only_if_they_look_independent() -> None:
    series = _series(0.0, 500, 8, 3)[:, :, 0]
    errors = np.array([error_of_mean(each, 1.0) for each in series])
    assert np.mean(np.isfinite(errors)) > 0.55
    z = (series.mean(axis=1) - series.mean()) / errors
    assert np.nanmean(z**2) == pytest.approx(1.0, abs=0.3)
    related = np.array([error_of_mean(each, 1.0) for each in _series(5.0, 500, 8, 3)[:, :, 0]])
    assert np.mean(np.isfinite(related)) < 0.25


def test_parts_shorter_than_the_memory_of_the_oscillator_tell_no_error() -> None:
    p = Params(mu=0.01, A=0.03)
    # 2/lam is 26.5 forcing periods.
    short = ensemble(p, {"v2": [0.1]}, settle=50, periods=300, record="measures").measures
    assert short is not None
    assert np.isnan([short["kinetic_ratio_error"][0], short["rms_x1_error"][0]]).all()
    regular = ensemble(p.replace(A=0.015), {"v2": [0.1]}, settle=3000, periods=16, record="measures").measures
    assert regular is not None
    assert regular["rms_x1_error"][0] < 1e-8


def test_of_what_repeats_errors_are_none_and_a_run_cut_short_has_none() -> None:
    found = settle(Params(mu=0.01, A=0.015))
    assert (found.kinetic_ratio_error, found.max_abs_x1_error, found.rms_x1_error) == (0.0, 0.0, 0.0)
    cut = settle(Params(mu=0.0084, A=0.015), max_impacts_per_period=8)
    assert np.isnan([cut.kinetic_ratio_error, cut.max_abs_x1_error, cut.rms_x1_error]).all()
    bare = settle(Params(mu=0.01, A=0.03), errors=False)
    assert bare.regime == "chaotic"
    assert np.isnan([bare.kinetic_ratio_error, bare.max_abs_x1_error, bare.rms_x1_error]).all()


def test_a_memory_longer_than_patience_leaves_no_error_and_says_so() -> None:
    # Damping so weak that the oscillator remembers for 1,600 forcing periods.
    p = {"mu": 1e-4, "A": 1e-3, "Omega": 1.02, "lam": 2e-4}
    many = classify_many({**p, "r": np.linspace(0.6, 0.7, 8)}, patience=500)
    wild = many.regime == "chaotic"
    assert np.any(wild)
    silent = wild & np.isnan(many.errors).any(axis=1)
    assert np.any(silent)
    assert all("no standard errors: the motion remembers" in many.reason[k] for k in np.flatnonzero(silent))


def test_errors_are_the_scatter_between_runs() -> None:
    found = scores(points=6, starts=24, seed=5)
    for name in NAMES:
        z = found.of(name)
        # Of so few points one run in an intermittent stretch may outweigh all others in the mean of exponents.
        assert 0.5 < np.mean(z**2) < 1.5 or name == "lyapunov"
        assert np.mean(np.abs(z) > 3) <= 0.05
        assert found.told(name) > 0.9


@pytest.mark.full
def test_errors_are_the_scatter_between_runs_at_40_random_points() -> None:
    found = scores()
    for name in NAMES:
        assert 0.8 < np.mean(found.of(name) ** 2) < 1.25
        assert np.mean(np.abs(found.of(name)) > 3) <= 0.02
        assert found.told(name) > 0.95
