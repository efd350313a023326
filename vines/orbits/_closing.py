"""The closing equations of a word of any system as functions of phases and parameters, where the system exists."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants
from vines.orbits._equations import closing_kernel
from vines.orbits._moved import moved
from vines.orbits._orbit import Orbit
from vines.orbits._values import frequency_of, marks_of

__all__ = ["Closed", "Closing", "difference", "stays_symmetric"]

Floats = npt.NDArray[np.float64]


class Closed(NamedTuple):
    """What the closing equations say at given phases and parameters.

    Attributes
    ----------
    params : Parameters
    constants : tuple
        Those of the kernels.
    duration : float
        The period pT.
    t : (N,) float array
    states : (N, 4) float array
        x1, v1 and position and velocity of the ball that hits, just before each impact.
    defect : (n,) float array
        Of the free impacts.
    slope : (n, n) float array
        Its derivatives in their phases.
    """

    params: Any
    constants: Any
    duration: float
    t: Floats
    states: Floats
    defect: Floats
    slope: Floats


class Closing:
    """The closing equations of the word of an orbit in the phases of its free impacts and in some parameters.

    Parameters
    ----------
    orbit : Orbit
        Gives the word and the parameters that stay fixed.
    names : sequence of str
        Parameters that vary.
    symmetric : bool
        Whether only the first half of the impacts is free, and the others are its mirror image.
    """

    def __init__(self, orbit: Orbit, names: Sequence[str], symmetric: bool) -> None:
        self.word = orbit.word
        self.side = marks_of(orbit.word)
        self._names = tuple(names)
        self._fixed = orbit.params
        self._sets = 2 if symmetric else 1
        n = len(self.side) // self._sets
        self.start = np.append(orbit.t[:n] * frequency_of(orbit.params), [orbit.params.as_dict()[k] for k in names])

    def params(self, values: Sequence[float] | Floats) -> Any:
        """Return the parameters with those that vary at some values, None where the system does not exist."""
        return moved(self._fixed, dict(zip(self._names, values, strict=True)))

    def at(self, phases: Floats, values: Sequence[float] | Floats) -> Closed | None:
        """Return what the equations say, with defects that are nan where they have no solution.

        None where the system does not exist.
        """
        p = self.params(values)
        if p is None:
            return None
        n = len(phases)
        later = math.pi * self.word.p * np.repeat(np.arange(self._sets), n)
        t = (np.tile(phases, self._sets) + later) / frequency_of(p)
        c, duration = constants(p), self.word.p * p.period
        regular, defect, slope, states = closing_kernel(c, duration, self.side, t)
        folded = slope[:n].reshape(n, -1, n).sum(axis=1) / frequency_of(p)
        return Closed(p, c, duration, t, states, defect[:n] if regular else np.full(n, np.nan), folded)

    def defect(self, phases: Floats, values: Sequence[float] | Floats) -> Floats:
        """Return the defects alone, nan where the system does not exist."""
        closed = self.at(phases, values)
        return np.full(len(phases), np.nan) if closed is None else closed.defect


def stays_symmetric(orbit: Orbit, *names: str) -> bool:
    """Say whether an orbit is its own mirror image and remains so when these parameters change.

    Examples
    --------
    >>> from vines.orbits import find_orbit
    >>> from vines.systems import ImpactPair
    >>> level = find_orbit("LR", ImpactPair(B=0.6, r=0.5))
    >>> stays_symmetric(level, "B"), stays_symmetric(level, "B", "G")
    (True, False)
    """
    return orbit.symmetric and not set(names) & set(orbit.params.system.mirror.broken_by)


def difference(function: Callable[[Floats], Floats], y: Floats, coordinate: int, step: float) -> Floats:
    """Return the derivative of a function in one coordinate by a difference.

    It is central; at the border of where the system exists, beyond which the function is nan, it is one-sided.
    Newton's method is steered by such derivatives, which do not move its goal.

    Examples
    --------
    >>> root = lambda y: np.where(y >= 0, np.sqrt(np.abs(1 + y)), np.nan)
    >>> difference(root, np.array([0.0]), 0, 1e-6).round(5), difference(root, np.array([3.0]), 0, 1e-6).round(5)
    (array([0.5]), array([0.25]))
    """
    move = np.zeros(len(y))
    move[coordinate] = step
    above, below = function(y + move), function(y - move)
    if np.isfinite(above).all() and np.isfinite(below).all():
        return (above - below) / (2 * step)
    here = function(y)
    return (above - here) / step if np.isfinite(above).all() else (here - below) / step
