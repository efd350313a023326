"""Curves of bifurcations in two parameters by pseudo-arclength; derived in docs/orbits.md, "Curves"."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from vines.domains import Interval, Named, Names, Number, Of, Whole, stated
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params
from vines.orbits._arclength import Chord, Walk
from vines.orbits._branch import Bifurcation
from vines.orbits._chain_curve import ChainCurve
from vines.orbits._conditions import TIE
from vines.orbits._curve import Curve, SpecialPoint
from vines.orbits._curve_equations import CurveEquations
from vines.orbits._curve_problem import CurveProblem
from vines.orbits._joined import is_joint, left_family
from vines.orbits._problem import Point, ZeroSet
from vines.orbits._slid_curve import SlidCurve
from vines.orbits._slid_round import slides
from vines.orbits._smooth_curve import SmoothCurve
from vines.orbits._special import END, Special, special_functions
from vines.orbits._sticking_curve import StickingCurve
from vines.orbits._sticking_curve_of_balls import BallsCurve
from vines.orbits._sticking_of_balls import by_sections

__all__ = ["follow_curve"]

Floats = npt.NDArray[np.float64]

_SMALLEST_STEP = 1e-7
_TURN = 0.2
_REACH = 4.0
_TOLERANCE = 1e-13
"""Of a special point, as a fraction of the step in which it lies."""
_ENDS = (END, TIE, "resonance_1_1", "resonance_1_2", "double_grazing", "degenerate_grazing")
"""Special points beyond which the equations describe something else."""
_RANK = 1e-10
"""Least singular value of the equations relative to the largest: below it they do not depend on the parameters."""

_ROUNDING = 1e-9
"""Residual beyond which the equations have lost their digits: next to a resonance they are small differences."""

_NEAREST = 1e-3
"""Margin at which a curve ends if its equations fail at zero: M grows as its inverse, and loses digits."""

_FINE = 1e-8
"""Of that point, as a fraction of the step in which it lies."""

_FIRST = 4
"""Points before which a curve is not looked at for having closed."""


@stated(
    ParameterError,
    bifurcation=Of("Bifurcation", how="one of Branch.bifurcations"),
    parameters=Names(2),
    box=Named(Interval()),
    step=Number(above=0, most=1),
    max_points=Whole(most=1_000_000),
)
def follow_curve(
    bifurcation: Bifurcation,
    parameters: tuple[str, str] = ("A", "mu"),
    *,
    box: Mapping[str, tuple[float, float]],
    step: float = 0.02,
    max_points: int = 2000,
) -> Curve:
    """Follow a bifurcation in two parameters, both ways from where it was found.

    Parameters
    ----------
    bifurcation : Bifurcation
        A fold, symmetry breaking, period doubling, Neimark-Sacker point or grazing; of orbits that stick also an
        incomplete chatter or a release tangency.
    parameters : tuple of str, str
        Two of mu, A, Omega, r, lam; of another system two of its own.
    box : mapping of str to (float, float)
        Range of each of the two; the curve ends at its border.
    step : float
        Largest step, relative to the sizes of box and unknowns.
    max_points : int
        Most points each way.

    Returns
    -------
    Curve

    Raises
    ------
    ParameterError
        If the parameters or the box do not fit, or a parameter breaks the symmetry whose breaking is to be followed.
    OrbitNotFound
        If the bifurcation is not found again by the equations of the curve, or is one whatever the two parameters are.

    Notes
    -----
    Every point satisfies closing and defining equations (docs/orbits.md, "Curves").

    Examples
    --------
    >>> from vines.model import Params
    >>> from vines.orbits import continue_orbit, find_orbit
    >>> branch = continue_orbit(find_orbit("LR", Params(mu=0.01, A=0.017)), "A", 0.02)
    >>> curve = follow_curve(branch.bifurcations[0], box={"A": (0.015, 0.02), "mu": (0.008, 0.012)})
    >>> curve.type, curve.ends
    ('symmetry_breaking', ('box', 'box'))

    Where the chatter of 1:1 that sticks on both walls is only just complete:

    >>> branch = continue_orbit(find_orbit("L*R*", Params(mu=0.01, A=0.3)), "A", 0.1)
    >>> curve = follow_curve(branch.bifurcations[-1], box={"A": (0.2, 0.3), "mu": (0.008, 0.012)}, step=0.2)
    >>> curve.type, curve.ends
    ('incomplete_chatter', ('box', 'box'))
    """
    low, high = _bounds(bifurcation, parameters, box)
    problem = _problem(bifurcation, parameters, high - low)
    zero = ZeroSet(problem, *problem.spans)
    _, sizes, directions = np.linalg.svd(zero.problem.equations(problem.start)[1] * zero.scale)
    if sizes[-1] < _RANK * sizes[0]:
        raise OrbitNotFound(
            f"{bifurcation} is one at all values of {' and '.join(parameters)} around, so that there is no curve to "
            "follow; give another parameter"
        )
    normal = directions[-1]
    found = zero.correct(problem.start, normal)
    if found is None or np.abs((found[0] - problem.start) / zero.scale).max() > 0.05:
        raise OrbitNotFound(f"{bifurcation} does not satisfy the equations of a curve; locate it afresh")
    begin = zero.point(found[0], normal)
    ways = []
    for sign in (-1, 1):
        way = _Way(problem, zero, low, high, step, max_points)
        way.run(Point(begin.y, sign * begin.tangent, begin.orbit))
        ways.append(way)
        if way.end == "closed":
            ways.append(_Way(problem, zero, low, high, step, max_points, end="closed"))
            break
    back, ahead = ways
    points = [*reversed(back.points), begin, *ahead.points]
    return Curve(
        type=bifurcation.type,
        word=problem.word,
        symmetric=problem.symmetric,
        parameters=parameters,
        orbits=tuple(point.orbit for point in points),
        residuals=np.array([float(np.abs(problem.residual(point.y)).max()) for point in points]),
        special=(*reversed(back.special), *ahead.special),
        ends=(back.end, ahead.end),
    )


def _bounds(
    bifurcation: Bifurcation, parameters: tuple[str, str], box: Mapping[str, tuple[float, float]]
) -> tuple[Floats, Floats]:
    """Return the lower and upper ends of the box.

    Raises
    ------
    ParameterError
        If it is none around the bifurcation.
    """
    p = bifurcation.params
    for name in parameters:
        p.system.parameter(name)
    if len(set(parameters)) != 2:
        raise ParameterError(f"parameters are {parameters}, allowed are two different ones")
    if set(box) != set(parameters):
        raise ParameterError(f"box names {sorted(box)}, it has to give the ranges of {' and '.join(parameters)}")
    low, high = (np.array([sorted(box[name])[k] for name in parameters]) for k in (0, 1))
    start = np.array([p.as_dict()[name] for name in parameters])
    if not np.all((low <= start) & (start <= high) & (low < high)):
        raise ParameterError(f"box is {dict(box)}; it has to hold the bifurcation at {tuple(start.tolist())}")
    for end in (low, high):
        p.replace(**dict(zip(parameters, end.tolist(), strict=True)))
    return low, high


def _problem(bifurcation: Bifurcation, parameters: tuple[str, str], spans: Floats) -> CurveEquations:
    orbit = left_family(bifurcation) if is_joint(bifurcation) else bifurcation.orbit
    breaks = set(parameters) & set(orbit.params.system.mirror.broken_by)
    if bifurcation.type == "symmetry_breaking" and breaks:
        name = breaks.pop()
        raise ParameterError(
            f"parameters are {parameters}; there is no symmetry to break unless {name} = 0, and folds of {orbit.word} "
            "have a cusp there; give two others, or follow a fold"
        )
    form = CurveProblem if isinstance(orbit.params, Params) else SlidCurve if slides(orbit.params) else ChainCurve
    if orbit.word.unstruck:
        form = SmoothCurve
    if orbit.word.sticking:
        form = BallsCurve if by_sections(orbit.params) else StickingCurve
    return form(bifurcation.type, orbit, parameters, tuple(spans.tolist()))


@dataclass
class _Way:
    """The curve one way from its start."""

    problem: CurveEquations
    zero: ZeroSet
    low: Floats
    high: Floats
    step: float
    max_points: int
    points: list[Point] = field(default_factory=list)
    special: list[SpecialPoint] = field(default_factory=list)
    end: str = "points"

    def run(self, begin: Point) -> None:
        self.begin = begin
        out = begin.tangent[-2:]
        if np.any((begin.y[-2:] <= self.low) & (out < 0) | (begin.y[-2:] >= self.high) & (out > 0)):
            self.end = "box"
            return
        self.functions = special_functions(self.problem)
        self.values = [special.function(begin) for special in self.functions]
        walk = Walk(
            self.zero,
            self.low,
            self.high,
            largest=self.step,
            smallest=_SMALLEST_STEP,
            turn=_TURN,
            reach=_REACH,
        )
        self.end = walk.follow(begin, self._record, self.max_points)
        if self.end == "lost":
            here = self.points[-1] if self.points else begin
            ahead = here.y + self.step * self.zero.scale * here.tangent
            exists = np.isfinite(self.problem.residual(ahead)).all()
            self.end = self.problem.runs_out([begin, *self.points]) or ("lost" if exists else "domain")

    def _record(self, here: Point, there: Point, last: bool) -> str | None:
        """Add what lies between two points, and the second one; return why the curve ends there, if it does."""
        if not np.abs(self.problem.residual(there.y)).max() < _ROUNDING:
            return self.problem.runs_out([self.begin, *self.points]) or "rounding"
        after = [special.function(there) for special in self.functions]
        hits = [self._cusp(here, there)] + [
            self._locate(special, here, there, a, b)
            for special, a, b in zip(self.functions, self.values, after, strict=True)
        ]
        for _, kind, point in sorted((hit for hit in hits if hit is not None), key=lambda hit: hit[0]):
            self._note(kind, point)
            if kind in _ENDS and not (kind.startswith("resonance") and self.problem.kind != "neimark_sacker"):
                self.points.append(point)
                return kind
        self.points.append(there)
        self.values = after
        if last:
            return "box"
        return "closed" if len(self.points) > _FIRST and self._passes(here, there) else None

    def _far(self, first: Floats, second: Floats) -> float:
        return float(np.linalg.norm((second - first) / self.zero.scale))

    def _passes(self, here: Point, there: Point) -> bool:
        """Say whether the curve comes past the point at which it began."""
        near = self._far(self.begin.y, there.y) < self._far(here.y, there.y)
        return near and float(self.begin.tangent @ there.tangent) > 0.9

    def _note(self, kind: str, point: Point) -> None:
        first, second = point.y[-2:].tolist()
        self.special.append(SpecialPoint(kind, (first, second), point.orbit))

    def _locate(
        self, special: Special, here: Point, there: Point, first: float, second: float
    ) -> tuple[float, str, Point] | None:
        if not (math.isfinite(first) and math.isfinite(second)) or (first > 0) == (second > 0):
            return None
        found = self._root(special.function, here, there)
        if found is None and special.type == END:
            found = self._before(special.function, here, there)
        return (found[0], special.type, found[1]) if found is not None and special.holds(found[1]) else None

    def _before(self, function: Callable[[Point], float], here: Point, there: Point) -> tuple[float, Point]:
        """Return the last point found on the side of the first one, where the equations fail at the zero itself.

        That is so where an impact loses its speed: M is infinite there.
        """
        chord = Chord(self.zero, here, there)
        sign = math.copysign(1.0, function(here))
        low, high = 0.0, 1.0
        while high - low > _FINE:
            middle = 0.5 * (low + high)
            try:
                inside = sign * function(chord.point(middle)) > _NEAREST
            except OrbitNotFound:
                inside = False
            low, high = (middle, high) if inside else (low, middle)
        return low, chord.point(low)

    def _cusp(self, here: Point, there: Point) -> tuple[float, str, Point] | None:
        """Return the cusp between two points: the parameters turn back though the curve goes on."""
        along = here.tangent[-2:]
        if self.problem.kind != "fold" or along @ there.tangent[-2:] >= 0:
            return None
        found = self._root(lambda point: float(along @ point.tangent[-2:]), here, there)
        if found is None or np.linalg.norm(found[1].tangent[-2:]) > 1e-4 * np.linalg.norm(along):
            return None
        return found[0], "cusp", found[1]

    def _root(self, function: Callable[[Point], float], here: Point, there: Point) -> tuple[float, Point] | None:
        """Return where between two points a function vanishes, or None if the curve is lost there."""
        chord = Chord(self.zero, here, there)
        try:
            root = chord.root(function, _TOLERANCE)
        except (OrbitNotFound, ValueError):
            return None
        return root, chord.point(root)
