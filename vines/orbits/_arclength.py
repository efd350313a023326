"""Pseudo-arclength continuation of a zero set: steps whose length follows the curve, its ends, roots on the way."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.errors import OrbitNotFound
from vines.orbits._problem import Point, ZeroSet

__all__ = ["Chord", "Walk"]

Floats = npt.NDArray[np.float64]

_EASY = 5
"""Newton steps up to which the next step along the curve may be longer."""


@dataclass(frozen=True)
class Walk:
    """How a curve is followed.

    Attributes
    ----------
    zero : ZeroSet
        The curve.
    low, high : ndarray, shape (k,)
        Ranges of its parameters, the last k coordinates; it ends at a border.
    largest, smallest : float
        Steps in scaled coordinates; the first is a quarter of the largest.
    turn : float
        Steps over which the tangent turns by more than this angle are halved, so that no fold or event slips through.
    only_inside : bool
        Whether the corrector is kept from looking beyond the border, where the model may not exist.
    reach : float
        A solution farther away than so many steps is on another part of the curve.
    is_on : callable, optional
        Of a point; whether it is on this curve. Where two curves cross, a step that is long beside the bend of the one
        may end on the other; a shorter one is then taken.
    """

    zero: ZeroSet
    low: Floats
    high: Floats
    largest: float
    smallest: float
    turn: float
    only_inside: bool = False
    reach: float = math.inf
    is_on: Callable[[Point], bool] | None = None

    def follow(self, begin: Point, record: Callable[[Point, Point, bool], str | None], most: int) -> str:
        """Follow the curve from a point in the direction of its tangent, by at most so many steps.

        `record` is given each point with the one before and whether it lies on the border; the curve ends with what it
        says unless that is None.

        Returns
        -------
        str
            Why it ended: what `record` said, ``lost`` or ``points``.
        """
        here, length = begin, self.largest / 4
        for _ in range(most):
            found = self._advance(here, length)
            while found is None:
                length /= 2
                if length < self.smallest:
                    return "lost"
                found = self._advance(here, length)
            there, iterations, last = found
            end = record(here, there, last)
            if end is not None:
                return end
            if iterations <= _EASY and here.tangent @ there.tangent > math.sqrt(math.cos(self.turn)):
                length = min(1.5 * length, self.largest)
            here = there
        return "points"

    def _advance(self, here: Point, length: float) -> tuple[Point, int, bool] | None:
        """Return the next point, how many Newton steps it took, and whether it lies on the border; or None."""
        ahead = here.y + length * self.zero.scale * here.tangent
        crossed = self._crossing(here.y, ahead)
        y, iterations = None, 1
        if crossed is None or not self.only_inside:
            y, iterations = self.zero.correct(ahead, here.tangent) or (None, 1)
        if y is None and crossed is not None:
            # Beyond the border there may be no system to correct in.
            y = self._at_border(here.y, ahead, *crossed)
        if y is None:
            return None
        crossed = self._crossing(here.y, y)
        if crossed is not None:
            if crossed[2] <= 0.0:
                # The curve begins on this border, and turned back to it within the step.
                return None
            y = self._at_border(here.y, y, *crossed)
            # Next to a corner another parameter may be beyond its range there.
            if y is None or not self._within(y):
                return None
        if np.linalg.norm((y - here.y) / self.zero.scale) > self.reach * length:
            return None
        try:
            there = self.zero.point(y, (y - here.y) / self.zero.scale)
        except OrbitNotFound:
            return None
        if here.tangent @ there.tangent < math.cos(self.turn) or (self.is_on and not self.is_on(there)):
            return None
        return there, iterations, crossed is not None

    def _within(self, y: Floats) -> bool:
        own = y[-len(self.low) :]
        return bool(((self.low <= own) & (own <= self.high)).all())

    def _crossing(self, start: Floats, end: Floats) -> tuple[int, float, float] | None:
        """Return the parameter that leaves its range first on the way, its bound, and the share of the way until it."""
        k = len(self.low)
        outside = np.flatnonzero((end[-k:] <= self.low) | (end[-k:] >= self.high))
        if not len(outside):
            return None
        bounds = np.where(end[-k:] <= self.low, self.low, self.high)
        move = (end - start)[-k:]
        shares = [(bounds[j] - start[j - k]) / move[j] if move[j] else 1.0 for j in outside]
        first = int(outside[np.argmin(shares)])
        return first - k, float(bounds[first]), float(min(shares))

    def _at_border(self, start: Floats, end: Floats, coordinate: int, bound: float, share: float) -> Floats | None:
        return self.zero.at_value(start + share * (end - start), bound, coordinate)


class Chord:
    """The curve between two points, by the fraction of the chord from one to the other; no point is solved for twice.

    Parameters
    ----------
    zero : ZeroSet
    here, there : Point
    """

    def __init__(self, zero: ZeroSet, here: Point, there: Point) -> None:
        self.zero = zero
        self.seen: dict[float, Point] = {0.0: here, 1.0: there}

    def point(self, fraction: float) -> Point:
        """Return the point over a fraction of the chord.

        Raises
        ------
        OrbitNotFound
            If there is none.
        """
        if fraction not in self.seen:
            here, there = self.seen[0.0], self.seen[1.0]
            found = self.zero.between(here, there, fraction)
            if found is None:
                problem = self.zero.problem
                raise OrbitNotFound(
                    f"the {problem.word} branch was lost between {problem.parameter} = {here.value:.9g} and "
                    f"{there.value:.9g} while a bifurcation was being located; give a smaller step"
                )
            self.seen[fraction] = found
        return self.seen[fraction]

    def root(self, function: Callable[[Point], float], tolerance: float) -> float:
        """Return the fraction at which a function of points that changes its sign vanishes.

        Raises
        ------
        OrbitNotFound
            If the curve is lost on the way.
        """
        from scipy.optimize import root_scalar  # a third of a second to load: only where something is located

        found = root_scalar(
            lambda fraction: function(self.point(fraction)),
            bracket=(0.0, 1.0),
            method="brentq",
            xtol=tolerance / 10,
            rtol=tolerance,
        )
        root = float(found.root)
        self.point(root)
        return root
