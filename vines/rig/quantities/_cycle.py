"""Impacts of a record against the forcing: phases in each place of a pattern, and the mean cycle of w and w'."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.fit import Motion
from vines.rig.quantities._pattern import Pattern, Periods

__all__ = ["Slots", "Track", "matching", "mean_cycle", "slots"]

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Motion of oscillator and ball between the first and the last impact, in any one system of units.

    Attributes
    ----------
    motion : Motion
        Of the oscillator.
    t, side : ndarray, shape (K,)
        Times and sides of the impacts.
    x2 : ndarray, shape (K,)
        Position of the ball at them.
    phase : ndarray, shape (K,)
        Omega t + phi, not reduced [rad].
    """

    motion: Motion
    t: Floats
    side: Floats
    x2: Floats
    phase: Floats

    def periods_begin(self, periods: Periods, number: npt.NDArray[np.int64]) -> Floats:
        """Return the times at which complete periods begin, numbered from 0."""
        turn = periods.cut + 2 * np.pi * (periods.first + number)
        return self.t[0] + (turn - self.phase[0]) / self.motion.omega

    def w(self, t: Floats) -> tuple[Floats, Floats]:
        """Return w = x1 - x2 and w' at times between the first and the last impact."""
        k = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        v2 = (self.x2[k + 1] - self.x2[k]) / (self.t[k + 1] - self.t[k])
        x2 = self.x2[k] + v2 * (t - self.t[k])
        x1, v1 = self.motion.both(t)
        return x1 - x2, v1 - v2


@dataclass(frozen=True, slots=True, eq=False)
class Slots:
    """Impact phases of the repetitions that show the pattern.

    Attributes
    ----------
    index : ndarray of int, shape (R, N)
        Which impacts they are.
    phase : ndarray, shape (R, N)
        Phase from the start of the repetition [rad], 0 to 2 pi p.
    side : ndarray, shape (N,)
    period : ndarray of int, shape (R,)
        Period in which the repetition begins, from 0.
    """

    index: npt.NDArray[np.int64]
    phase: Floats
    side: Floats
    period: npt.NDArray[np.int64]


def matching(periods: Periods, word: tuple[str, ...]) -> npt.NDArray[np.int64]:
    """Return the complete periods (numbers from 0) at which a repetition of the word begins."""
    p = len(word)
    if p == 1:
        return np.array([j for j, w in enumerate(periods.words) if w == word[0]], dtype=np.int64)
    found, j = [], 0
    while j + p <= len(periods.words):
        if tuple(periods.words[j : j + p]) == word:
            found.append(j)
            j += p
        else:
            j += 1
    return np.array(found, dtype=np.int64)


def slots(periods: Periods, pattern: Pattern, phase: Floats, side: Floats) -> Slots | None:
    """Return the phases of the impacts in each place of the pattern; None if it never shows."""
    begin = matching(periods, pattern.word)
    size = sum(map(len, pattern.word))
    if not len(begin) or not size:
        return None
    first = np.searchsorted(periods.number, begin + periods.first)
    index = first[:, None] + np.arange(size)
    start = periods.cut + 2 * np.pi * (begin + periods.first)
    return Slots(index, phase[index] - start[:, None], side[index[0]], begin)


def mean_cycle(track: Track, begin: Floats, length: float, points: int = 256) -> tuple[Floats, Floats]:
    """Return the mean of w and of w' over stretches of equal length, shape (points,) each.

    Parameters
    ----------
    track : Track
    begin : ndarray, shape (R,)
        Where the stretches begin [time]; those that leave the record are left out.
    length : float
        [time].
    """
    begin = begin[(begin >= track.t[0]) & (begin + length <= track.t[-1])]
    if not len(begin):
        return np.full(points, np.nan), np.full(points, np.nan)
    offsets = (np.arange(points) + 0.5) / points * length
    w, w_dot = track.w((begin[:, None] + offsets).ravel())
    return w.reshape(-1, points).mean(axis=0), w_dot.reshape(-1, points).mean(axis=0)
