"""Every orbit of a word of few impacts: search of all flight times (docs/orbits.md, "All orbits of a word").

A word of two or three impacts, or the first half of a symmetric orbit of four or six, leaves one or two flight times
free; the functions of them that vanish on an orbit are entire, and a subdivision passes over no part of their domain.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import Constants
from vines.model import Params, Word
from vines.orbits._boxes import NODES, common_zeros
from vines.orbits._flights import sample_kernel, start_kernel
from vines.orbits._shortest import shortest_crossing
from vines.orbits._tails import tails

__all__ = ["Starts", "can_search", "search_flights"]

Floats = npt.NDArray[np.float64]

_FIRST = 12
"""Boxes per forcing period, and direction, to begin with: the functions turn a few times in a period."""

_LEVELS = 15
"""Bisections: the last boxes are 12 · 2^15 = 4e5 times shorter than a forcing period."""


class Starts(NamedTuple):
    """What a search of all flight times leaves.

    Attributes
    ----------
    times : list of list of (N,) float array
        For each box that is left, impact times to start Newton's method from, in the canonical order of the word.
    whole : bool
        Whether the search went to its last level everywhere.
    """

    times: list[list[Floats]]
    whole: bool


def can_search(word: Word, halves: bool) -> bool:
    """Say whether the orbits of a word, or the symmetric ones if `halves`, leave one or two flight times free."""
    return len(word) in (4, 6) and word.symmetric if halves else len(word) in (2, 3)


def search_flights(word: Word, p: Params, c: Constants, halves: bool, *, proof: bool = False) -> Starts:
    """Search all flight times for orbits of a word with impacts on both walls.

    Parameters
    ----------
    word : Word
    p : Params
    c : Constants
    halves : bool
        Whether to search for symmetric orbits only, by their first half.
    """
    flip, N = (-1, len(word) // 2) if halves else (1, len(word))
    span = word.p * p.period * N / len(word)
    # Three flights begin with the one between equal walls; the other two may be short together.
    turned = 0 if halves or N == 2 else next(k for k in range(3) if word.sides[k] == word.sides[(k + 1) % 3])
    side = np.roll(np.array(word.sides, dtype=np.int64), -turned)[:N]
    symmetric_zero = N == 2 and not halves and word.p % 2 == 1

    def sample(low: Floats, width: float) -> Floats:
        out = np.empty((len(low), len(NODES) ** (N - 1), 1 if N == 2 else 4))
        sample_kernel(c, span, flip, side, symmetric_zero, low, width, NODES, out)
        return out

    crossing = shortest_crossing(p, len(word), word.p * p.period) if proof else 0.0

    def tail(low: Floats, width: float) -> Floats:
        if not proof:
            return np.zeros((len(low), 1))
        found = tails(c, span, flip, side, symmetric_zero, low, width, len(NODES))
        found[_too_short(span, flip, side, low, width, crossing)] = -np.inf
        return found

    low, width, whole = common_zeros(sample, tail, N - 1, _FIRST * word.p, _LEVELS)
    times = []
    for box in low:
        starts = []
        for place in _places(N - 1):
            tau = _flights(span, box + width * place)
            t = start_kernel(c, span, flip, side, tau) + np.concatenate([[0.0], np.cumsum(tau[:-1])])
            if halves:
                t = np.concatenate([t, t + span])
            starts.append(np.append(t[N - turned :] - word.p * p.period, t[: N - turned]) if turned else t)
        times.append(starts)
    return Starts(times, whole)


def _too_short(
    span: float, flip: int, side: npt.NDArray[np.int64], low: Floats, width: float, crossing: float
) -> npt.NDArray[np.bool_]:
    """Say of each box whether the ball would cross the cavity faster than it can everywhere in it."""
    high, rest = low + width, 1.0 - low
    longest = (
        [high[:, 0], rest[:, 0]] if len(side) == 2 else [high[:, 0], rest[:, 0] * high[:, 1], rest[:, 0] * rest[:, 1]]
    )
    after = np.append(side[1:], flip * side[0])
    return np.any(
        [span * tau < crossing for tau, crosses in zip(longest, after != side, strict=True) if crosses], axis=0
    )


def _places(dimension: int) -> Iterator[Floats]:
    """Yield the centre of the unit box, then its corners pulled in a little."""
    yield np.full(dimension, 0.5)
    for corner in itertools.product((0.05, 0.95), repeat=dimension):
        yield np.array(corner)


def _flights(span: float, y: Floats) -> Floats:
    """Return the flight times of a point of the unit interval or square; see `sample_kernel`."""
    if len(y) == 1:
        return span * np.array([y[0], 1 - y[0]])
    return span * np.array([y[0], (1 - y[0]) * y[1], (1 - y[0]) * (1 - y[1])])
