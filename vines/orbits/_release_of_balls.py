"""Sections of runs of balls in parallel, and the map from one to the next by the event loop itself (docs/sticking.md).

All balls that ride are on one wall and are let go at one instant, when the contact force vanishes: x1'' = -G. Phase and
v1 say where they and the frame are, and each ball that flies then adds its position and velocity. Where balls that ride
are always kicked off or struck instead, a section is a phase of the forcing at which none rides.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants, open_window, room_of, run_window, tangent_product
from vines.dynamics.kernels import rows as col
from vines.dynamics.parallel.kernels import B_DECIDE, B_RELEASED, B_V2, B_WALL, B_X2, BALL, R_V2, R_X2, at
from vines.dynamics.runs import EVENTS_PER_PERIOD, IN_TURN

__all__ = [
    "Moment",
    "Ran",
    "Release",
    "Section",
    "falling",
    "force_slope",
    "releases_among",
    "run_closed",
    "run_on",
    "run_round",
]

Floats = npt.NDArray[np.float64]

_EARLY = 0.25
"""Most by which the release of a round may come early or late, in forcing periods."""


@dataclass(frozen=True, slots=True)
class Release:
    """All balls that ride are let go; coordinates are phase, v1, and x2, v2 of each ball that flies.

    Attributes
    ----------
    side : int
        The wall, +1 or -1.
    riders : tuple of int
        The balls that are let go, counted from 0.
    balls : int
        How many there are.
    ties : str
        As for `vines.simulate`.
    """

    side: int
    riders: tuple[int, ...]
    balls: int
    ties: str = IN_TURN

    @property
    def flyers(self) -> tuple[int, ...]:
        """The balls that fly at the release."""
        return tuple(k for k in range(self.balls) if k not in self.riders)

    @property
    def mirrored(self) -> Release:
        """The mirror image."""
        return Release(-self.side, self.riders, self.balls, self.ties)

    def image(self, z: Floats) -> Floats:
        """Return the coordinates of the mirror image."""
        return np.append((z[0] + math.pi) % (2.0 * math.pi), -z[1:])

    def phase(self, z: Floats) -> float:
        """Return the phase of the forcing."""
        return float(z[0])

    def read(self, row: Floats) -> Floats:
        """Return the coordinates at the last row of a release."""
        flying = [row[place + 2 * k] for k in self.flyers for place in (R_X2, R_V2)]
        return np.array([row[col.PHASE], row[col.A_V1], *flying])

    def begin(self, p: Any, z: Floats) -> Floats | None:
        """Return the state of a run just after it, None where there can be none: the contact force has to fall."""
        phase, v1 = float(z[0]), float(z[1])
        if not self.side * falling(p, phase, v1) < 0.0:
            return None
        x1 = p.A * (math.sin(phase) + p.lam * p.Omega * math.cos(phase)) - p.lam * v1 + p.G
        x2, v2 = np.full(p.balls, x1), np.full(p.balls, v1)
        for place, k in enumerate(self.flyers):
            x2[k], v2[k] = z[2 + 2 * place], z[3 + 2 * place]
        state = _begin(p, x1, v1, x2, v2, phase, self.ties)
        for k in self.riders:
            state[at(k, B_X2)], state[at(k, B_V2)] = x1 - self.side * p.beta[k], v1
            state[at(k, B_WALL)], state[at(k, B_RELEASED)], state[at(k, B_DECIDE)] = self.side, 1.0, 0.0
        return state

    def disturbances(self, p: Any, z: Floats) -> Floats:
        """Return the disturbances, at the time of the release, by its time and coordinates, shape (2 + 2 N, k)."""
        columns = np.zeros((2 + 2 * p.balls, len(z)))
        # A release later by dt, with the same velocity, was before on its own motion.
        columns[0, 0], columns[1, 0] = force_slope(p, float(z[0])) - z[1], p.G
        columns[0, 1], columns[1, 1] = -p.lam, 1.0
        for k in self.riders:
            columns[2 + 2 * k : 4 + 2 * k] = columns[:2]
        for place, k in enumerate(self.flyers):
            columns[2 + 2 * k, 0], columns[3 + 2 * k, 0] = -z[3 + 2 * place], p.G
            columns[2 + 2 * k, 2 + 2 * place] = columns[3 + 2 * k, 3 + 2 * place] = 1.0
        return columns

    def arrivals(self, p: Any, end: Floats, Y: Floats) -> Floats:
        """Return time and coordinates of the disturbed release by disturbances at the time of the other one."""
        late = (p.lam * Y[1] + Y[0]) / falling(p, float(end[0]), float(end[1]))
        found = [late, Y[1] - p.G * late]
        for place, k in enumerate(self.flyers):
            found += [Y[2 + 2 * k] + end[3 + 2 * place] * late, Y[3 + 2 * k] - p.G * late]
        return np.stack(found)

    def still(self, p: Any, phase: float) -> float:
        """Return about which velocity the push, x1'' + G, does not change at a release."""
        return falling(p, phase, 0.0)

    def among(self, rows: Floats) -> Sequence[tuple[int, Release]]:
        """Return the last rows of releases, each with its section."""
        return releases_among(rows, self.balls, self.ties)

    def reached(self, p: Any, rows: Floats, span: float) -> int | None:
        """Return the row of that release which comes nearest to a time, None if none comes about then."""
        ends = [i for i, met in self.among(rows) if met == self]
        last = min(ends, key=lambda i: abs(rows[i, col.TIME] - span), default=None)
        return None if last is None or abs(rows[last, col.TIME] - span) > _EARLY * p.period else last

    def stop(self, p: Any, span: float) -> float:
        """Return how long to run for a round."""
        return span + _EARLY * p.period

    def closing(self, p: Any, ran: Ran, span: float, z: Floats, sign: float) -> tuple[Floats, Floats]:
        """Return by how much it misses itself (sign 1) or its mirror image (-1), and the slopes in the coordinates."""
        defect = np.append(ran.lasts - span, ran.end[1:] - sign * z[1:])
        slope = ran.slopes - np.diag([1.0, *[sign] * (len(z) - 1)])
        slope[:, 0] /= p.Omega
        return defect, slope

    def mirror(self, z: Floats) -> Floats:
        """Return what the mirror does to time and coordinates of a disturbance."""
        return np.diag([1.0, *[-1.0] * (len(z) - 1)])


@dataclass(frozen=True, slots=True)
class Moment:
    """A phase of the forcing at which no ball rides; coordinates are x1, v1, and x2, v2 of each ball."""

    at: float
    ties: str = IN_TURN

    @property
    def flyers(self) -> tuple[int, ...]:
        """Some balls fly."""
        return (0,)

    @property
    def mirrored(self) -> Moment:
        """The mirror image."""
        return Moment((self.at + math.pi) % (2.0 * math.pi), self.ties)

    def image(self, z: Floats) -> Floats:
        """Return the coordinates of the mirror image."""
        return -z

    def phase(self, z: Floats) -> float:
        """Return the phase of the forcing."""
        return self.at

    def read(self, row: Floats) -> Floats:
        """Return the coordinates at a row."""
        return np.append(row[[col.X1, col.A_V1]], row[R_X2:])

    def begin(self, p: Any, z: Floats) -> Floats | None:
        """Return the state of a run there, None where a ball is outside its cavity."""
        if (np.abs(z[0] - z[2::2]) > np.array(p.beta)).any():
            return None
        return _begin(p, float(z[0]), float(z[1]), z[2::2].copy(), z[3::2].copy(), self.at, self.ties)

    def disturbances(self, p: Any, z: Floats) -> Floats:
        """Return the disturbances by the coordinates."""
        return np.eye(len(z))

    def arrivals(self, p: Any, end: Floats, Y: Floats) -> Floats:
        """Return the coordinates by disturbances at that time."""
        return Y

    def reached(self, p: Any, rows: Floats, span: float) -> int | None:
        """Return the row of the end, None if a ball rides there."""
        return len(rows) - 1 if rows[-1, col.MODE] == 0.0 else None

    def stop(self, p: Any, span: float) -> float:
        """Return how long to run for a round."""
        return span

    def closing(self, p: Any, ran: Ran, span: float, z: Floats, sign: float) -> tuple[Floats, Floats]:
        """Return by how much it misses itself (sign 1) or its mirror image (-1), and the slopes in the coordinates."""
        return ran.end - sign * z, ran.slopes - sign * np.eye(len(z))

    def mirror(self, z: Floats) -> Floats:
        """Return what the mirror does to a disturbance."""
        return -np.eye(len(z))


Section = Release | Moment


class Ran(NamedTuple):
    """A round: its events, where it comes, and the slopes of that.

    Attributes
    ----------
    rows : ndarray
        From a row for the start to that of the end.
    lasts : float
        Time that it takes.
    end : ndarray, shape (k,)
        Coordinates there.
    slopes : ndarray, shape (k, k)
        What a disturbance at the start is at the end; its eigenvalues over a period are the multipliers.
    """

    rows: Floats
    lasts: float
    end: Floats
    slopes: Floats


def force_slope(p: Any, phase: float) -> float:
    """Return the derivative by time of the force of the base."""
    return p.A * p.Omega * (math.cos(phase) - p.lam * p.Omega * math.sin(phase))


def falling(p: Any, phase: float, v1: float) -> float:
    """Return the derivative by time of x1'' + G at a release."""
    return force_slope(p, phase) + p.lam * p.G - v1


def _begin(p: Any, x1: float, v1: float, x2: Floats, v2: Floats, phase: float, ties: str) -> Floats:
    room = room_of(p)
    state = np.zeros(room.layout(p).state)
    room.begin(constants(p), state, x1, v1, x2, v2, phase, 0.0)
    if ties == IN_TURN:
        room.strike_in_turn(state)
    return state


def releases_among(rows: Floats, balls: int, ties: str) -> list[tuple[int, Release]]:
    """Return the last rows of common releases, each with its section; balls that are kicked off are none."""
    found: list[tuple[int, Release]] = []
    together: list[int] = []
    let_go = (rows[:, col.KIND] == col.RELEASE) & (rows[:, col.V1] == rows[:, col.V2])
    for i in np.flatnonzero(let_go).tolist():
        goes_on = bool(together) and together[-1] == i - 1 and rows[i, col.TAU] == 0.0
        together = [*together, i] if goes_on else [i]
        riders = tuple(sorted(int(rows[k, BALL]) - 1 for k in together))
        if goes_on:
            found.pop()
        found.append((i, Release(int(rows[i, col.SIDE]), riders, balls, ties)))
    return found


def run_on(p: Any, section: Section, z: Floats, stop: float) -> Floats | None:
    """Return the events from a section on, the last row being that of the end; None where it is none."""
    state = section.begin(p, z) if np.isfinite(z).all() else None
    if state is None:
        return None
    c, layout = constants(p), room_of(p).layout(p)
    rows = np.empty((layout.rows, layout.width))
    rows, count, code = run_window(c, state, stop, EVENTS_PER_PERIOD, rows, open_window(c, state, rows))
    return rows[: count + 1].copy() if code == col.COMPLETE else None


def run_round(p: Any, section: Section, span: float, z: Floats, target: Section) -> Ran | None:
    """Run from a section to the target about a time `span` later, None where it is not met then.

    Parameters
    ----------
    p : Parallel
    section, target : Section
    span : float
    z : ndarray
        Coordinates at the start.
    """
    rows = run_on(p, section, z, section.stop(p, span))
    last = None if rows is None else target.reached(p, rows, span)
    if rows is None or last is None:
        return None
    end = target.read(rows[last])
    Y = tangent_product(constants(p), rows, 0, last) @ section.disturbances(p, z)
    return Ran(rows[: last + 1], float(rows[last, col.TIME]), end, target.arrivals(p, end, Y))


def run_closed(
    p: Any, section: Section, span: float, z: Floats, *, mirrored: bool
) -> tuple[Ran, tuple[Floats, Floats]] | None:
    """Return what `run_round` does to the section again, or to its mirror image, and what is left to close with slopes.

    None where that is not met then.
    """
    ran = run_round(p, section, span, z, section.mirrored if mirrored else section)
    return None if ran is None else (ran, section.closing(p, ran, span, z, -1.0 if mirrored else 1.0))
