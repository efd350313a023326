"""Impact times from which Newton's method may find an orbit of a long word, gathered in several ways."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import simulate
from vines.dynamics.kernels import Constants, room_of
from vines.model import STATE_NAMES, VI_NES, Params, Word
from vines.orbits._flights import start_kernel
from vines.orbits._floquet import monodromy
from vines.orbits._orbit import Orbit

__all__ = [
    "STARTS",
    "base_word",
    "doubled_times",
    "harvested_times",
    "random_times",
    "simplex_times",
    "starts_of",
    "stretches",
]

Floats = npt.NDArray[np.float64]

STARTS = (
    (0.0, 0.0, 0.0, 0.1),
    (0.3, 0.0, 0.3, -1.0),
    (-0.5, 0.8, 0.1, 0.6),
    (0.0, -1.0, 0.5, 1.5),
    (1.0, 0.0, 0.2, 0.0),
)
"""x1, v1, x2, v2 from which simulations start."""

_PERIODS = 300
_BEST = 3
"""Recurrences kept of each simulation: those that come back nearest."""

_KICKS = (0.01, 0.05, 0.2)
"""How far a seed is moved along the critical direction, in flight times of its base orbit."""


def harvested_times(word: Word, p: Any) -> Iterator[Floats]:
    """Yield the times of stretches of simulations that read as the word and almost come back."""
    yield from (times for times, _ in stretches(word, p))


def stretches(word: Word, p: Any) -> Iterator[tuple[Floats, npt.NDArray[np.void]]]:
    """Yield these times with the impacts that they are of."""
    duration, N = word.p * p.period, len(word)
    for start in starts_of(p):
        hits = simulate(p, **start, periods=_PERIODS, max_impacts_per_period=200).impacts
        if len(hits) <= N:
            continue
        letters = VI_NES.letters(hits["side"])
        if any(word.balls):
            letters = p.system.letters(hits["side"], hits["ball"].tolist())
        width = len(word.letters) // N
        t = np.asarray(hits["t"])
        change = np.abs(t[N:] - t[:-N] - duration)
        for name in STATE_NAMES:
            change = np.maximum(change, np.abs(hits[name][N:] - hits[name][:-N]))
        reads = np.array([letters[k * width : (k + N) * width] == word.letters for k in range(len(change))])
        for k in [k for k in np.argsort(change, kind="stable") if reads[k] and change[k] < 0.5][:_BEST]:
            flights = np.diff(t[k : k + N + 1])
            # The stretch is made to close after pT exactly.
            begins = np.concatenate([[0.0], np.cumsum(flights[:-1])])
            yield t[k] % p.period + begins * duration / flights.sum(), hits[k : k + N]


def starts_of(p: Any) -> Iterator[dict[str, Any]]:
    """Yield the starts of simulations: of another system with all in the middle, at several speeds of the balls."""
    if isinstance(p, Params):
        yield from (dict(zip(STATE_NAMES, start, strict=True)) for start in STARTS)
        return
    balls = [body.velocity.name for body in p.system.bodies if body.name != "oscillator"]
    for frame in ({}, *room_of(p).swings(p)):
        for *_, speed in STARTS:
            yield {**frame, **{name: speed / (1 + k) for k, name in enumerate(balls)}}


def base_word(word: Word) -> Word | None:
    """Return the word that a word is the repetition of over twice the period, None if it is none.

    Examples
    --------
    >>> base_word(Word("LRLR/2T")), base_word(Word("LLRLR/2T"))
    (Word('LR'), None)
    """
    half, odd = divmod(len(word), 2)
    if odd or word.p % 2 or word.letters[:half] != word.letters[half:]:
        return None
    return Word(f"{word.letters[:half]}/{word.p // 2}T")


def doubled_times(base: Orbit) -> Iterator[Floats]:
    """Yield an orbit run twice, moved along the eigenvector of its multiplier nearest to period doubling."""
    for kick in _kicks(base, lambda values: -np.abs(values + 1)):
        yield np.concatenate([base.t + kick, base.t + base.period - kick])


def asymmetric_times(base: Orbit) -> Iterator[Floats]:
    """Yield the impact times of an orbit moved along the eigenvector of its largest multiplier."""
    for kick in _kicks(base, np.abs):
        yield base.t + kick


def _kicks(base: Orbit, rank: Callable[[Any], Floats]) -> Iterator[Floats]:
    """Yield displacements of the impact times along the eigenvector whose multiplier ranks highest."""
    values, vectors = np.linalg.eig(monodromy(base.jacobians).astype(complex))
    moved = [np.real(vectors)[:, int(np.argmax(rank(values)))]]
    for J in base.jacobians[:-1]:
        moved.append(J @ moved[-1])
    along = np.array(moved)[:, 3]
    if not np.abs(along).max() > 0:
        return
    along *= base.flight_times.min() / np.abs(along).max()
    for size in _KICKS:
        yield size * along


def random_times(word: Word, p: Any, count: int) -> Iterator[Floats]:
    """Yield random flight times, each with a random phase; from a fixed seed."""
    duration, N = word.p * p.period, len(word)
    rng = np.random.default_rng(N)
    for _ in range(count):
        tau = rng.dirichlet(np.ones(N)) * duration
        yield rng.uniform(0, p.period) + np.concatenate([[0.0], np.cumsum(tau[:-1])])


def simplex_times(word: Word, p: Params, c: Constants, count: int) -> Iterator[Floats]:
    """Yield random flight times, each with the phase that fits them best and with a random one; from a fixed seed."""
    duration, N = word.p * p.period, len(word)
    side = np.array(word.sides, dtype=np.int64)
    rng = np.random.default_rng(N)
    for _ in range(count):
        tau = rng.dirichlet(np.ones(N)) * duration
        t = np.concatenate([[0.0], np.cumsum(tau[:-1])])
        yield start_kernel(c, duration, 1, side, tau) + t
        yield rng.uniform(0, p.period) + t
