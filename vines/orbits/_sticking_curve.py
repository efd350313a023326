"""Bifurcations and bounds of orbits that stick as zero sets in two parameters (docs/sticking.md)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants
from vines.dynamics.kernels import rows as col
from vines.errors import OrbitNotFound
from vines.model import PARAMETER_NAMES, Params
from vines.orbits._assemble import asymmetry
from vines.orbits._curve_equations import CurveEquations
from vines.orbits._moved import moved
from vines.orbits._orbit import Orbit
from vines.orbits._problem import Point, ZeroSet
from vines.orbits._special import BOUNDS
from vines.orbits._sticking_bounds import LIMIT, NOTHING, PRESSED, TOUCH, Bound, bound_kernel
from vines.orbits._sticking_ends import (
    GRAZING,
    INCOMPLETE_CHATTER,
    RELEASE_TANGENCY,
    self_similar,
    what_vanishes,
)
from vines.orbits._sticking_map import CHATTER, ROOM
from vines.orbits._sticking_orbit import Release, Round, orbit_of_rows, release_of
from vines.orbits._sticking_survey import RESOLVED, least_force, round_turnings

__all__ = ["StickingCurve", "bound_beside"]

Floats = npt.NDArray[np.float64]

_SAME = 1e-5
"""Time between the turning point that touches and one that is found, below which they are one."""

_ALIKE = 1e-3
"""Largest difference of an orbit at an end to its mirror image, to be that of a symmetric family: one half may touch
where the other one does not yet."""

_STEP, _FINE = 1e-7, 1e-8
"""Step of differences, and where something touches: beside it the next thing may touch too."""

_APART = 1e-2
"""Distance of the point, in scaled coordinates, to whose margins those of the last one are compared."""

_MOVES, _SHARE = 0.5, 0.5
"""By how many such distances farther a margin may run out that is told as the end of a curve; and what may be left."""

_ROWS = np.empty((ROOM, col.ROW))


class _Place(NamedTuple):
    """An event of a round: its row, contacts complete and impacts of a chatter under way before and after it."""

    row: int
    before: tuple[int, int]
    after: tuple[int, int]
    chatters: bool


class StickingCurve(CurveEquations):
    """A bifurcation or a bound of orbits that stick.

    The unknowns are phase and v1 of a release; where something touches, then the time at which it does.

    Parameters
    ----------
    kind : str
        Type of the bifurcation.
    orbit : Orbit
        The orbit there, or at a bound beside it.
    parameters : tuple of str, str
    spans : tuple of float, float
        Widths of their ranges.

    Raises
    ------
    OrbitNotFound
        If the bound cannot be followed from this orbit.
    """

    def __init__(self, kind: str, orbit: Orbit, parameters: tuple[str, str], spans: tuple[float, float]) -> None:
        super().__init__(kind, orbit, parameters, spans)
        if self.word.symmetric and kind in BOUNDS:
            # At its end rounding may hide that a family is symmetric.
            self.symmetric = asymmetry(self.word, orbit.period, orbit.t, orbit.states) < _ALIKE
        self.step = _STEP
        self._fixed = orbit.params
        self._bound = Bound(NOTHING, 0, 0, 0.0, 0.0, 0, 0.0, 0.0, 0.0)
        spell, extra = 0, []
        if kind == INCOMPLETE_CHATTER:
            spell = int(np.argmin(orbit.spells["t_release"] - orbit.spells["t_start"]))
            self._bound = self._bound._replace(kind=LIMIT)
        self._way = Round(self.word, self.symmetric, int(orbit.spells["contact"][spell]))
        self._whole = Round(self.word, False, int(orbit.spells["contact"][spell]))
        self._wanted = self._way.wanted
        begin = release_of(orbit, spell)
        if kind in (GRAZING, RELEASE_TANGENCY):
            met = self._way.run(orbit.params, begin)
            if met is None:
                raise OrbitNotFound(
                    f"the {self.word} orbit at {orbit.params} does not come back; locate the bound afresh"
                )
            self.step = _FINE
            extra = [(self._settle_touch if kind == GRAZING else self._settle_pressed)(orbit, met[0])]
        values = [orbit.params.as_dict()[name] for name in parameters]
        self.start = np.array([begin.phase, begin.v1, *extra, *values])

    def _settle_touch(self, orbit: Orbit, rows: Floats) -> float:
        """Work out what touches, and where in the round; return the time at which it does since the event before."""
        places = list(self._places(rows))
        turnings = self.turnings(orbit)
        # An impact and a turning point are compared by how far the ball would go beyond the wall, or is from it.
        heights = {
            place.row: 0.5 * _speed(rows[place.row]) ** 2 for place in places if _may_be_slow(rows, place, places)
        }
        if len(turnings) and turnings[:, 3].min() <= min(heights.values(), default=math.inf):
            row, tau, wall = turnings[np.argmin(turnings[:, 3]), :3].tolist()
            self.touches = True
            reached, hits = places[int(row)].after
            rest = rows[int(row) + 1, col.TAU] - tau
        elif heights:
            at = places[min(heights, key=lambda row: heights[row])]
            (reached, hits), wall, tau = at.before, rows[at.row, col.SIDE], rows[at.row, col.TAU]
            rest = rows[at.row + 1, col.TAU]
            if not at.chatters:
                # At the bound this impact changes nothing, and beyond there is none.
                self._wanted = np.delete(self._wanted, reached)
                self._bound = self._bound._replace(splits=1)
        else:
            raise OrbitNotFound(f"nothing grazes on the {self.word} orbit at {orbit.params}; locate the bound afresh")
        self._bound = self._bound._replace(
            kind=TOUCH, reached=reached, hits=hits, wall=float(wall), skip=0.5 * float(rest)
        )
        return float(tau)

    def _settle_pressed(self, orbit: Orbit, rows: Floats) -> float:
        """Work out where the contact force has a minimum that vanishes; return the time at which, since the merge."""
        c, found = constants(orbit.params), []
        for place in self._places(rows):
            if rows[place.row, col.KIND] != col.STICK:
                continue
            ends = place.row + int(np.argmax(rows[place.row :, col.KIND] == col.RELEASE))
            lasts = rows[ends, col.TIME] - rows[place.row, col.TIME]
            force, tau = least_force(c, rows[place.row], lasts)
            found.append((force, tau, place.before[0], lasts))
        force, tau, reached, lasts = min(found)
        if not force < float(np.min(orbit.spells["falls"])):
            raise OrbitNotFound(
                f"on the {self.word} orbit at {orbit.params} the ball is let go where the contact force hardly falls, "
                "and lands again at once; follow this bound from the other side, where it is not let go"
            )
        self._bound = self._bound._replace(kind=PRESSED, reached=reached, skip=0.5 * (lasts - tau))
        return float(tau)

    def _places(self, rows: Floats) -> Iterator[_Place]:
        reached = hits = 0
        yield _Place(0, (0, 0), (0, 0), False)
        for row in range(1, len(rows)):
            before, kind = (reached, hits), rows[row, col.KIND]
            chatters = reached < len(self._wanted) and abs(self._wanted[reached]) == CHATTER
            if kind == col.IMPACT and chatters:
                hits += 1
            elif kind == col.RELEASE or (kind == col.IMPACT and not chatters):
                reached, hits = reached + 1, 0
            yield _Place(row, before, (reached, hits), chatters)

    def _params(self, y: Floats) -> Params | None:
        return moved(self._fixed, dict(zip(self.names, y[-2:], strict=True)))

    def _run(self, y: Floats) -> tuple[Params, Floats, Floats] | None:
        """Return parameters, events and what `bound_kernel` says of the round from the release of y."""
        p = self._params(y)
        if p is None:
            return None
        bound, tau = self._bound, float(y[2]) if len(y) == 5 else 0.0
        if bound.kind == LIMIT:
            if not 0 < p.r < 1:
                return None
            bound = bound._replace(**self_similar(p.r)._asdict())
        out = np.zeros(10)
        count = bound_kernel(
            constants(p), self._way.side, self._wanted, self._way.span(p.period), float(y[0]), float(y[1]), bound, tau,
            _ROWS, out,
        )  # fmt: skip
        return (p, _ROWS[:count].copy(), out) if count else None

    def _slopes(self, out: Floats) -> Floats:
        """Return the slopes of the way, or of half of it with the mirror image taken."""
        matrix = out[2:6].reshape(2, 2)
        return np.diag([1.0, -1.0]) @ matrix if self.symmetric else matrix

    def residual(self, y: Floats) -> Floats:
        """Return the equations at y, shape (y.size - 1,), nan where other contacts come."""
        met = self._run(y)
        if met is None:
            return np.full(len(y) - 1, math.nan)
        p, _, out = met
        closing = [out[0] - self._way.span(p.period), out[1] - self._way.sign * y[1]]
        if self._bound.kind in (TOUCH, PRESSED):
            return np.array([*closing, out[6], out[7]])
        if self._bound.kind == LIMIT:
            return np.array([*closing, out[6]])
        return np.array([*closing, self._defining(self._slopes(out))])

    def _defining(self, matrix: Floats) -> float:
        if self.kind == "neimark_sacker":
            return float((np.linalg.det(matrix) - 1.0) / (1.0 + np.linalg.norm(matrix)) ** 2)
        sign = -1.0 if self.kind == "fold" else 1.0
        return float(np.linalg.det(np.eye(2) + sign * matrix) / (1.0 + np.linalg.norm(matrix)))

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution.

        Raises
        ------
        OrbitNotFound
            If other contacts come.
        """
        met = self._run(y)
        if met is None:
            raise OrbitNotFound(f"the {self.word} orbit is lost next to a {self.kind}; follow it with a smaller step")
        p, rows, out = met
        if self._bound.splits:
            # The impact of no speed.
            rows[int(out[9]) + 1, [col.KIND, col.SIDE]] = col.IMPACT, self._bound.wall
        half = None
        if self.symmetric:
            half = self._slopes(out)
            rows = np.concatenate([rows, _mirrored(rows)])
            out = np.concatenate([out[:2], (half @ half).ravel()])
        found = orbit_of_rows(self._whole, p, Release(float(y[0]) % (2 * math.pi), float(y[1])), rows, out[:6], half)
        return self._without_stick(found) if self._bound.kind == LIMIT else found

    def _without_stick(self, orbit: Orbit) -> Orbit:
        """Return the orbit with spells of no length where the chatter is only just complete."""
        spells = orbit.spells.copy()
        contact = self._whole.order[-1]
        at = {contact, (contact + len(self.word) // 2) % len(self.word)} if self.symmetric else {contact}
        ends = np.isin(spells["contact"], list(at))
        spells["t_start"][ends], spells["phase_start"][ends] = spells["t_release"][ends], spells["phase_release"][ends]
        spells.setflags(write=False)
        return replace(orbit, spells=spells)

    def bend(self, y: Floats) -> float:
        """Return w'' at the turning point that touches the wall, negative where it touches L."""
        met = self._run(y)
        return math.nan if met is None else float(met[2][8])

    def turnings(self, orbit: Orbit) -> Floats:
        """Return all turning points of the round, rows of event before, time since it, wall, clearance, w'', 0."""
        met = self._way.run(orbit.params, release_of(orbit))
        rows = round_turnings(constants(orbit.params), met[0]) if met is not None else np.empty((0, 5))
        return np.column_stack([rows, np.zeros(len(rows))])

    def elsewhere(self, orbit: Orbit, y: Floats) -> float:
        """Return the least clearance of a turning point other than the one that touches."""
        met = self._run(y)
        if met is None:
            return math.nan
        rows = round_turnings(constants(met[0]), met[1])
        mine = (rows[:, 0] == met[2][9]) & (np.abs(rows[:, 1] - y[2]) < _SAME)
        return float(rows[~mine, 3].min(initial=2.0))

    def runs_out(self, points: Sequence[Point]) -> str | None:
        """Return what the orbits of the curve need that runs out just behind its last point, None if nothing does."""
        last, scale = points[-1], np.append(np.ones(len(self.start) - 2), self.spans)
        far = (point for point in reversed(points) if np.linalg.norm((point.y - last.y) / scale) > _APART)
        before = next(far, points[0])
        if before is last:
            return None
        if self._bound.kind == PRESSED and 0 < last.y[2] < _SHARE * before.y[2]:
            # The minimum comes to the beginning of its spell.
            return INCOMPLETE_CHATTER
        found = what_vanishes(before, last, _MOVES)
        return None if found is None else found[0]


def bound_beside(kind: str, orbit: Orbit, parameter: str, width: float) -> float | None:
    """Return the value of a parameter at the bound beside an orbit, None if its equations are not solved from there.

    They are those of the VI-NES: an orbit of another system has none.

    Parameters
    ----------
    kind : str
        Type of the bound.
    orbit : Orbit
    parameter : str
    width : float
        Of the range of the parameter.
    """
    if not isinstance(orbit.params, Params):
        return None
    other = next(name for name in PARAMETER_NAMES if name != parameter)
    fixed = orbit.params.as_dict()[other]
    try:
        problem = StickingCurve(kind, orbit, (other, parameter), (1.0, width))
    except OrbitNotFound:
        return None
    y = ZeroSet(problem, *problem.spans).at_value(problem.start, fixed, coordinate=-2)
    return None if y is None else float(y[-1])


def _speed(row: Floats) -> float:
    return float(abs(row[col.V1] - row[col.V2]))


def _may_be_slow(rows: Floats, place: _Place, places: list[_Place]) -> bool:
    """Say whether an event is an impact that may lose its speed: of a chatter only one that a faster one follows."""
    if rows[place.row, col.KIND] != col.IMPACT:
        return False
    later = [
        _speed(rows[each.row])
        for each in places
        if each.row > place.row and each.before[0] == place.before[0] and rows[each.row, col.KIND] == col.IMPACT
    ]
    return not place.chatters or max(later, default=0.0) > max(_speed(rows[place.row]), RESOLVED)


def _mirrored(rows: Floats) -> Floats:
    """Return the other half of the events of an orbit that is its own mirror image."""
    image = rows[1:].copy()
    image[:, [col.SIDE, col.X1, col.V1, col.X2, col.V2, col.A_V1, col.A_V2, col.MODE]] *= -1
    image[:, col.PHASE] = (image[:, col.PHASE] + math.pi) % (2 * math.pi)
    image[:, col.TIME] += rows[-1, col.TIME]
    return image
