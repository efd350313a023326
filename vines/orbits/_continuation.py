"""Families of orbits followed by pseudo-arclength continuation, with their bifurcations located on the way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from vines.domains import Name, Number, Numbers, Of, Pair, Whole, stated
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params
from vines.orbits._arclength import Chord, Walk
from vines.orbits._branch import Bifurcation, Branch
from vines.orbits._chain_family import ChainProblem
from vines.orbits._closing import stays_symmetric
from vines.orbits._conditions import (
    GRAZING,
    REMARKS,
    TIE,
    Condition,
    conditions,
    critical_multiplier,
    grazing_margin,
    tie_margin,
)
from vines.orbits._family import GeneralProblem
from vines.orbits._general import origin
from vines.orbits._orbit import Orbit
from vines.orbits._problem import Point, Problem, ZeroSet
from vines.orbits._slid import SlidProblem
from vines.orbits._slid_round import slides
from vines.orbits._sticking_capsule import CapsuleSticking, rides_capsule
from vines.orbits._sticking_curve import bound_beside
from vines.orbits._sticking_ends import end_of
from vines.orbits._sticking_family import StickingProblem
from vines.orbits._sticking_family_of_balls import BallsProblem
from vines.orbits._sticking_of_balls import by_sections
from vines.orbits._symmetric import SymmetricProblem

__all__ = ["CLOSED", "continue_orbit"]

_SMALLEST_STEP = 1e-8
_TURN = 0.15
_MARGINS = {GRAZING: grazing_margin, TIE: tie_margin}
"""What has to be positive for orbits to be admissible."""

_ELSEWHERE = 1e-6
"""Distance of an orbit from its own repetition or mirror image below which it is one of the family that is left."""
_EXTRAPOLATED = 1e-5
"""Most by which an extrapolated end may be wrong, in ranges of the parameter."""

CLOSED = "closed"
_FIRST = 4
"""Points before which a branch is not looked at for having closed."""
_ALONG = 0.9
"""Least cosine of the angle between the directions in which it passes where it began."""
_BESIDE = 1e-4
"""Length of a step, next to an end of a family beyond which its map does not exist, that may be of rounding alone."""

_TOLERANCE = 1e-14
"""Of the root of a defining equation, as a fraction of the step in which it lies."""


@stated(
    ParameterError,
    orbit=Of("Orbit", how="as vines.find_orbit returns it"),
    parameter=Name(),
    stop=Number(),
    within=Pair(optional=True),
    at=Numbers(),
    step=Number(),
    max_points=Whole(most=1_000_000),
)
def continue_orbit(
    orbit: Orbit,
    parameter: str,
    stop: float,
    *,
    within: tuple[float, float] | None = None,
    at: Sequence[float] = (),
    step: float = 0.02,
    beyond_grazing: bool = False,
    max_points: int = 5000,
) -> Branch:
    """Follow an orbit in one parameter, through folds, and locate the bifurcations on the way.

    The branch ends where the parameter leaves its range on either side, or at the grazing that ends admissibility,
    or where two balls hit together, beyond which their impacts have changed places, or where it closes. A family that
    sticks ends also where a chatter no longer completes, or the contact force vanishes without falling.

    Parameters
    ----------
    orbit : Orbit
        Where to begin.
    parameter : str
        mu, A, Omega, r or lam; of another system one of its own.
    stop : float
        The other end of the range; the branch sets out towards it.
    within : tuple of float, float, optional
        The range, if it is to be wider than from the present value to `stop`: a branch that folds then passes the
        value at which it began.
    at : sequence of float
        Values of the parameter that are to be among the orbits, on every sheet of the branch.
    step : float
        Largest step, relative to the size of range and unknowns.
    beyond_grazing : bool
        Whether to go on where the orbits are no longer admissible.
    max_points : int
        Most steps.

    Returns
    -------
    Branch

    Raises
    ------
    ParameterError
        If the parameter does not exist, `stop` is out of its range or its present value, or `within` leaves out one of
        both.
    OrbitNotFound
        If the branch is lost while a bifurcation is being located.

    Notes
    -----
    Each bifurcation is the root of its defining equation along the branch (docs/orbits.md, "Bifurcations"), not an
    interpolation.

    Examples
    --------
    >>> from vines.model import Params
    >>> from vines.orbits import symmetric_orbits
    >>> branch = continue_orbit(symmetric_orbits(Params(mu=0.01, A=0.016))[0], "A", 0.02)
    >>> [(b.type, round(b.value, 4)) for b in branch.bifurcations]
    [('symmetry_breaking', 0.018)]
    """
    orbit.params.system.parameter(parameter)
    start = orbit.params.as_dict()[parameter]
    stop = orbit.params.replace(**{parameter: stop}).as_dict()[parameter]
    if start == stop:
        raise ParameterError(f"stop is {stop:g}, which is where {parameter} is already; give another value")
    low, high = sorted((start, stop) if within is None else within)
    for bound in (low, high):
        orbit.params.replace(**{parameter: bound})
    if not (low <= min(start, stop) and max(start, stop) <= high):
        raise ParameterError(
            f"within is {low:g} … {high:g}; it has to hold {parameter} = {start:g} and stop = {stop:g}"
        )
    if not 0 < step <= 1:
        raise ParameterError(f"step is {step!r}, allowed is 0 < step <= 1")
    walk = _Branch(_problem(orbit, parameter), orbit, stop, low, high, tuple(at), step, beyond_grazing, max_points)
    return walk.run()


def _problem(orbit: Orbit, parameter: str) -> Problem:
    if orbit.word.sticking and rides_capsule(orbit.params):
        return CapsuleSticking(orbit, parameter)
    if orbit.word.sticking and by_sections(orbit.params):
        return BallsProblem(orbit, parameter)
    if slides(orbit.params):
        return SlidProblem(orbit, parameter)
    if not isinstance(orbit.params, Params):
        return ChainProblem(orbit, parameter)
    if orbit.word.sticking:
        return StickingProblem(orbit, parameter)
    if orbit.symmetric and len(orbit.word) == 2:
        return SymmetricProblem(orbit, parameter)
    return GeneralProblem(orbit, parameter)


@dataclass
class _Branch:
    """One run of the continuation."""

    problem: Problem
    orbit: Orbit
    stop: float
    low: float
    high: float
    at: tuple[float, ...]
    step: float
    beyond_grazing: bool
    max_points: int
    orbits: list[Orbit] = field(default_factory=list)
    bifurcations: list[Bifurcation] = field(default_factory=list)
    events: list[Bifurcation] = field(default_factory=list)

    def run(self) -> Branch:
        start = float(self.problem.start[-1])
        self.curve = ZeroSet(self.problem, self.high - self.low)
        self.symmetric = stays_symmetric(self.orbit, self.problem.parameter)
        self.conditions = conditions(self.symmetric, several=any(self.orbit.word.balls))
        towards = np.zeros(len(self.problem.start))
        towards[-1] = np.sign(self.stop - start)
        here = Point(self.problem.start, self.curve.tangent(self.problem.start, towards), self.orbit)
        self.orbits.append(self.orbit)
        self.points = [here]
        end = Walk(
            self.curve,
            np.array([self.low]),
            np.array([self.high]),
            largest=self.step,
            smallest=_SMALLEST_STEP,
            turn=_TURN,
            only_inside=True,
            is_on=None if self.symmetric or origin(self.orbit, _ELSEWHERE) else self._is_on,
        ).follow(here, self._record, self.max_points)
        if end == "lost" and self._ends_by_itself:
            end = self._ended() or end
        return Branch(
            self.problem.word,
            self.problem.parameter,
            tuple(self.orbits),
            tuple(self.bifurcations),
            tuple(self.events),
            (CLOSED if end == CLOSED else "range", end),
        )

    @property
    def _ends_by_itself(self) -> bool:
        """Whether the orbits are those of a map that does not exist beyond the end of the family."""
        return bool(self.orbit.word.sticking) or slides(self.orbit.params)

    def _is_on(self, point: Point) -> bool:
        """Say whether a point is not on the family that this one comes out of, whose orbits solve its equations too."""
        found = origin(point.orbit, _ELSEWHERE)
        return found is None or (found == "symmetry_breaking" and not self.orbit.params.mirrored)

    def _ended(self) -> str | None:
        """Add the bifurcation at which a family that sticks ends just behind its last orbit, and return its type."""
        found = end_of(self.points, self.high - self.low)
        if found is None:
            return None
        last, nothing = self.points[-1].orbit, complex(math.nan, math.nan)
        value = self.points[-1].value + found.beyond
        exact = bound_beside(found.type, last, self.problem.parameter, self.high - self.low)
        if exact is not None and abs(exact - value) < _EXTRAPOLATED * (self.high - self.low):
            value = exact
        value = min(max(value, self.low), self.high)
        there = last.params.replace(**{self.problem.parameter: value})
        self.bifurcations.append(Bifurcation(found.type, self.problem.parameter, value, there, nothing, nothing, last))
        return found.type

    def _record(self, here: Point, there: Point, last: bool) -> str | None:
        """Add what lies between two points, and the second one; return why the branch ends there, if it does."""
        closed = len(self.points) > _FIRST and self._passes(here, there)
        if closed:
            there = self.points[0]
        self.points.append(there)
        met = sorted(
            (hit for condition in self.conditions if (hit := self._locate(condition, here, there)) is not None),
            key=lambda hit: hit[0],
        )
        before = here
        for _, found, point in met:
            joined = origin(point.orbit) if found == "fold" and not self.symmetric else None
            kind = joined or found
            critical = critical_multiplier(found, point, self.symmetric)
            if critical is None:
                continue
            half, whole = critical
            event = Bifurcation(kind, self.problem.parameter, point.value, point.orbit.params, whole, half, point.orbit)
            if kind in REMARKS:
                self.events.append(event)
                continue
            self._add_values(before, point)
            self.bifurcations.append(event)
            self.orbits.append(point.orbit)
            before = point
            if kind in _MARGINS and not self.beyond_grazing and _MARGINS[kind](here) > 0:
                return kind
            if joined:
                return kind
        self._add_values(before, there)
        self.orbits.append(there.orbit)
        if closed:
            return CLOSED
        return "range" if last else None

    def _passes(self, here: Point, there: Point) -> bool:
        """Say whether the branch comes past the orbit at which it began, in the same direction."""
        begin, scale = self.points[0], self.curve.scale
        near = np.linalg.norm((there.y - begin.y) / scale) < np.linalg.norm((there.y - here.y) / scale)
        return bool(near and begin.tangent @ there.tangent > _ALONG)

    def _locate(self, condition: Condition, here: Point, there: Point) -> tuple[float, str, Point] | None:
        first, second = condition.function(here), condition.function(there)
        if not (math.isfinite(first) and math.isfinite(second)) or (first > 0) == (second > 0):
            return None
        chord = Chord(self.curve, here, there)
        try:
            return self._root(condition, chord, first)
        except OrbitNotFound:
            far = float(np.linalg.norm((there.y - here.y) / self.curve.scale))
            if self._ends_by_itself and (condition.type in _MARGINS or far < _BESIDE):
                # Next to the end, on one side of which no equations hold; steps get short there.
                return None
            raise

    def _root(self, condition: Condition, chord: Chord, first: float) -> tuple[float, str, Point]:
        try:
            root = chord.root(condition.function, _TOLERANCE)
        except OrbitNotFound:
            # Where families join the equations degenerate. The parameter has an extremum there, so that next to it
            # its value is right to the square of the distance.
            last = list(chord.seen)[-1]
            if condition.type != "fold" or origin(chord.seen[last].orbit) is None:
                raise
            root = last
        if condition.type in _MARGINS:
            # The search may have come from beyond; the orbit to show is the last one that is still admissible.
            back = math.copysign(1e-15, -1 if first > 0 else 1)
            while not condition.function(chord.point(root)) > 0:
                root = min(max(root + back, 0.0), 1.0)
                back *= 2
        return root, condition.type, chord.point(root)

    def _add_values(self, here: Point, there: Point) -> None:
        """Add the orbits at the wanted values of the parameter between two points."""
        low, high = sorted((here.value, there.value))
        wanted = sorted((value for value in self.at if low < value < high), reverse=here.value > there.value)
        for value in wanted:
            share = (value - here.value) / (there.value - here.value)
            y = self.curve.at_value(here.y + share * (there.y - here.y), value)
            if y is not None:
                self.orbits.append(self.problem.orbit(y))
