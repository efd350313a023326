"""What the continuation needs to know of a family of orbits, and points on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from vines.errors import OrbitNotFound
from vines.model import Word
from vines.orbits._orbit import Orbit

__all__ = ["Point", "Problem", "ZeroSet"]

Floats = npt.NDArray[np.float64]

_ITERATIONS = 12
_CONVERGED = 1e-9
"""Scaled Newton step after which one more iteration reaches rounding, convergence being quadratic or nearly so."""

SMALL = 0.25
"""Least size that is taken for a coordinate of a motion without impacts, in half gaps."""


class Problem(Protocol):
    """A family of orbits in one parameter: n equations in n unknowns and the parameter, y = (unknowns, parameter)."""

    word: Word
    parameter: str
    start: Floats

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the n equations at y, and their derivatives, shape (n, n + 1)."""
        ...

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution y."""
        ...


@dataclass(frozen=True, eq=False)
class Point:
    """A point on the curve: solution, unit tangent (scaled coordinates, along the direction of travel), orbit."""

    y: Floats
    tangent: Floats
    orbit: Orbit

    @property
    def value(self) -> float:
        """Value of the parameter."""
        return float(self.y[-1])


class ZeroSet:
    """The zero set of a problem in scaled coordinates, in which steps of about one cross the whole range.

    Parameters
    ----------
    problem : Problem
    *spans : float
        Widths of the ranges of the parameters, the last coordinates.
    """

    def __init__(self, problem: Problem, *spans: float) -> None:
        self.problem = problem
        unknowns = np.abs(problem.start[: -len(spans)])
        # States without impacts may begin small and grow a hundred times.
        least = max(0.1 * unknowns.max(initial=1e-3), SMALL if problem.word.unstruck else 0.0)
        self.scale = np.append(np.maximum(unknowns, least), spans)

    def tangent(self, y: Floats, towards: Floats) -> Floats:
        """Return the unit tangent at y on the side of `towards`.

        Raises
        ------
        OrbitNotFound
            Where the equations do not exist: at its end a family that sticks may close, from what was rounded.
        """
        matrix = self.problem.equations(y)[1]
        if not np.isfinite(matrix).all():
            problem = self.problem
            raise OrbitNotFound(f"the {problem.word} branch closes at {problem.parameter} = {y[-1]:.9g}; stop before")
        null = np.linalg.svd(matrix * self.scale)[2][-1]
        return null if null @ towards >= 0 else -null

    def correct(self, guess: Floats, normal: Floats) -> tuple[Floats, int] | None:
        """Return the solution in the plane through `guess` with this normal, and the Newton steps, or None.

        `guess` is in the coordinates of the problem, `normal` in scaled ones.
        """
        y = guess.copy()
        close = False
        for iteration in range(1, _ITERATIONS + 1):
            right, matrix = self.problem.equations(y)
            matrix = np.vstack([matrix * self.scale, normal])
            right = np.append(right, normal @ ((y - guess) / self.scale))
            if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
                return None
            try:
                step = np.linalg.solve(matrix, right)
            except np.linalg.LinAlgError:
                return None
            y = y - self.scale * step
            if close:
                return y, iteration
            close = bool(np.abs(step).max() < _CONVERGED)
        return None

    def at_value(self, guess: Floats, value: float, coordinate: int = -1) -> Floats | None:
        """Return the solution near `guess` whose (last) parameter is exactly `value`, or None."""
        start = guess.copy()
        start[coordinate] = value
        normal = np.zeros(len(guess))
        normal[coordinate] = 1.0
        found = self.correct(start, normal)
        if found is None:
            return None
        found[0][coordinate] = value
        return found[0]

    def between(self, first: Point, second: Point, fraction: float) -> Point | None:
        """Return the point over this fraction of the chord from one point to another, or None."""
        chord = (second.y - first.y) / self.scale
        found = self.correct(first.y + fraction * (second.y - first.y), chord / np.linalg.norm(chord))
        return None if found is None else self.point(found[0], chord)

    def point(self, y: Floats, towards: Floats) -> Point:
        """Return the point at a solution y."""
        return Point(y, self.tangent(y, towards), self.problem.orbit(y))
