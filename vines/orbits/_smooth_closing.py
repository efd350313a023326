"""What closes orbits without impacts: the state at phase 0 after a period, or its mirror image after half of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants
from vines.model import Word
from vines.orbits._closing import Closed
from vines.orbits._moved import moved
from vines.orbits._orbit import Orbit
from vines.orbits._smooth_flow import fly

__all__ = ["SmoothClosing", "smooth_solved"]

Floats = npt.NDArray[np.float64]

_ITERATIONS = 20
_LEAST_SHARE = 1.0 / 16.0
_ROUNDING = 1e-12
_CLOSES = 1e-12
"""Largest defect of an orbit, relative to its size: Newton's method is taken on to rounding, unless it creeps."""

_EARLY, _FALLEN = 8, 0.1
"""Newton steps after which the defect has to have fallen to this part: what has not is on no way to an orbit."""


class SmoothClosing:
    """As `Closing`; its unknowns are the coordinates of the state at phase 0.

    The slope is the tangent map less one; for a symmetric orbit that of the half map less one.
    """

    def __init__(self, orbit: Orbit, names: Sequence[str], symmetric: bool) -> None:
        self.word = orbit.word
        self.side = np.zeros(1, dtype=np.int64)
        self._names = tuple(names)
        self._fixed = orbit.params
        self._symmetric = symmetric
        start = orbit.states[0]
        if symmetric:
            # An orbit next to the loss of its symmetry is the mean of itself and its mirror image.
            start = (start - fly(constants(orbit.params), start, orbit.period / 2).end) / 2
        self.start = np.append(start, [orbit.params.as_dict()[name] for name in names])

    def params(self, values: Sequence[float] | Floats) -> Any:
        """Return the parameters with those that vary at some values, None where the system does not exist."""
        return moved(self._fixed, dict(zip(self._names, values, strict=True)))

    def at(self, start: Floats, values: Sequence[float] | Floats) -> Closed | None:
        """Return what the equations say; None where the system does not exist."""
        p = self.params(values)
        if p is None:
            return None
        c, duration = constants(p), self.word.p * p.period
        defect, slope = _closed(c, duration, start, self._symmetric)
        return Closed(p, c, duration, np.zeros(1), np.array(start)[None, :], defect, slope)

    def defect(self, start: Floats, values: Sequence[float] | Floats) -> Floats:
        """Return the defects alone, nan where the system does not exist."""
        closed = self.at(start, values)
        return np.full(len(start), np.nan) if closed is None else closed.defect


def _closed(c: Any, duration: float, start: Floats, symmetric: bool) -> tuple[Floats, Floats]:
    """Return by how much a state is off after a period, or its mirror image after half of it, and the slope of that."""
    sign, span = (-1.0, duration / 2) if symmetric else (1.0, duration)
    flown = fly(c, start, span)
    return sign * flown.end - start, sign * flown.map - np.eye(len(start))


def smooth_solved(word: Word, p: Any, start: Floats, *, symmetric: bool) -> tuple[bool, Floats, float]:
    """Return where damped Newton steps come to from a state at phase 0: whether they converged, state, largest defect.

    Parameters
    ----------
    symmetric : bool
        Whether an orbit is looked for that is its own mirror image.
    """
    c, duration = constants(p), word.p * p.period
    z = np.array(start, dtype=np.float64)
    defect, slope = _closed(c, duration, z, symmetric)
    size = first = float(np.abs(defect).max())
    for done in range(_ITERATIONS):
        if not (np.isfinite(size) and np.isfinite(slope).all()):
            return False, z, np.inf
        if done == _EARLY and size > _FALLEN * first:
            break
        try:
            step = np.linalg.solve(slope, defect)
        except np.linalg.LinAlgError:
            return False, z, size
        share = 1.0
        while True:
            trial = z - share * step
            there, slope_there = _closed(c, duration, trial, symmetric)
            better = float(np.abs(there).max())
            # At rounding no shorter step is any better.
            if better < size or share < _LEAST_SHARE or size < _ROUNDING:
                break
            share *= 0.5
        if not better < size:
            break
        z, defect, slope, size = trial, there, slope_there, better
    return size < _CLOSES * (1.0 + np.abs(z).max()), z, size
