"""From one common release of balls in parallel cavities to the release that ends a word, by the event loop itself.

All balls that ride are on one wall and are let go at one instant, when the contact force vanishes: x1'' = -G. Phase and
v1 say where they and the frame are, and each ball that flies then adds its position and velocity. A periodic orbit with
such a release is a fixed point of the map from it to the one that follows a period later (docs/sticking.md).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants, open_window, room_of, run_window, tangent_product
from vines.dynamics.kernels import rows as col
from vines.dynamics.parallel.kernels import B_DECIDE, B_RELEASED, B_V2, B_WALL, B_X2, BALL, R_V2, R_X2, at
from vines.dynamics.runs import EVENTS_PER_PERIOD, IN_TURN

__all__ = ["Ran", "Section", "release_now", "releases_among", "run_round", "solve_round"]

Floats = npt.NDArray[np.float64]

_EARLY = 0.25
"""Most by which the release of a round may come early or late, in forcing periods."""

_HALVINGS = 12
_EPS = 2.220446049250313e-16

_CLOSES = 1e-11
"""Defect, beside rounding, at which a round counts as closed."""


@dataclass(frozen=True, slots=True)
class Section:
    """Which balls are let go on which wall, and how those are struck that arrive at one instant.

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

    def mirrored(self) -> Section:
        """Return the mirror image."""
        return Section(-self.side, self.riders, self.balls, self.ties)


class Ran(NamedTuple):
    """A round: its events, where it comes, and the slopes of that.

    Attributes
    ----------
    rows : ndarray
        From a row for the start to that of the last ball that is let go, of all that was run.
    last : int
        Which row ends the round.
    lasts : float
        Time from release to release.
    end : ndarray, shape (k,)
        The release: phase, v1, and x2, v2 of each ball that flies.
    slopes : ndarray, shape (k, k)
        Of (time, v1, x2, v2, …) at the end by those at the start.
    """

    rows: Floats
    last: int
    lasts: float
    end: Floats
    slopes: Floats


def release_now(section: Section, row: Floats) -> Floats:
    """Return phase, v1, and x2, v2 of each ball that flies, at the row of a release."""
    flying = [row[place + 2 * k] for k in section.flyers for place in (R_X2, R_V2)]
    return np.array([row[col.PHASE], row[col.A_V1], *flying])


def releases_among(rows: Floats, balls: int, ties: str) -> list[tuple[int, Section]]:
    """Return the rows that end a common release, each with its section; balls that are kicked off are none."""
    found: list[tuple[int, Section]] = []
    together: list[int] = []
    let_go = (rows[:, col.KIND] == col.RELEASE) & (rows[:, col.V1] == rows[:, col.V2])
    for i in np.flatnonzero(let_go).tolist():
        together = [*together, i] if together and together[-1] == i - 1 and rows[i, col.TAU] == 0.0 else [i]
        riders = tuple(sorted(int(rows[k, BALL]) - 1 for k in together))
        section = Section(int(rows[i, col.SIDE]), riders, balls, ties)
        if found and len(together) > 1:
            found.pop()
        found.append((i, section))
    return found


def _force_slope(p: Any, phase: float) -> float:
    """Return the derivative by time of the force of the base."""
    return p.A * p.Omega * (math.cos(phase) - p.lam * p.Omega * math.sin(phase))


def _falls(p: Any, phase: float, v1: float) -> float:
    """Return the derivative by time of x1'' + G at a release."""
    return _force_slope(p, phase) + p.lam * p.G - v1


def _start(p: Any, section: Section, z: Floats) -> Floats:
    """Return the state of a run just after a release."""
    room, n = room_of(p), p.balls
    phase, v1 = float(z[0]), float(z[1])
    x1 = p.A * (math.sin(phase) + p.lam * p.Omega * math.cos(phase)) - p.lam * v1 + p.G
    x2, v2 = np.empty(n), np.full(n, v1)
    for k in section.riders:
        x2[k] = x1 - section.side * p.beta[k]
    for place, k in enumerate(section.flyers):
        x2[k], v2[k] = z[2 + 2 * place], z[3 + 2 * place]
    state = np.zeros(room.layout(p).state)
    room.begin(constants(p), state, x1, v1, x2, v2, phase, 0.0)
    if section.ties == IN_TURN:
        room.strike_in_turn(state)
    for k in section.riders:
        state[at(k, B_X2)], state[at(k, B_V2)] = x1 - section.side * p.beta[k], v1
        state[at(k, B_WALL)], state[at(k, B_RELEASED)], state[at(k, B_DECIDE)] = section.side, 1.0, 0.0
    return state


def _carried_back(p: Any, section: Section, z: Floats) -> Floats:
    """Return the disturbances at the time of the start by time and coordinates of the release, (2 + 2 N, k)."""
    columns = np.zeros((2 + 2 * p.balls, len(z)))
    # A release later by dt, with the same velocity, was before on its own motion.
    columns[0, 0], columns[1, 0] = _force_slope(p, float(z[0])) - z[1], p.G
    columns[0, 1], columns[1, 1] = -p.lam, 1.0
    for k in section.riders:
        columns[2 + 2 * k : 4 + 2 * k] = columns[:2]
    for place, k in enumerate(section.flyers):
        columns[2 + 2 * k, 0], columns[3 + 2 * k, 0] = -z[3 + 2 * place], p.G
        columns[2 + 2 * k, 2 + 2 * place] = columns[3 + 2 * k, 3 + 2 * place] = 1.0
    return columns


def _at_release(p: Any, section: Section, end: Floats, Y: Floats) -> Floats:
    """Return time and coordinates of the disturbed release from disturbances at the time of the other one."""
    late = (p.lam * Y[1] + Y[0]) / _falls(p, float(end[0]), float(end[1]))
    found = [late, Y[1] - p.G * late]
    for place, k in enumerate(section.flyers):
        found += [Y[2 + 2 * k] + end[3 + 2 * place] * late, Y[3 + 2 * k] - p.G * late]
    return np.stack(found)


def run_round(p: Any, section: Section, span: float, z: Floats, target: Section, beyond: float = 0.0) -> Ran | None:
    """Run from a release to one of the target about a time `span` later; None if there is none, or none can be here.

    Parameters
    ----------
    p : Parallel
    section, target : Section
    span : float
    z : ndarray
        The release: phase, v1, and x2, v2 of each ball that flies.
    beyond : float
        How much longer to run on, whose rows are kept as well.
    """
    rising = section.side * _falls(p, float(z[0]), float(z[1])) >= 0.0
    if rising or not np.isfinite(z).all():
        return None
    c, layout = constants(p), room_of(p).layout(p)
    state = _start(p, section, z)
    rows = np.empty((layout.rows, layout.width))
    stop = span + _EARLY * p.period + beyond
    rows, count, code = run_window(c, state, stop, EVENTS_PER_PERIOD, rows, open_window(c, state, rows))
    if code != col.COMPLETE:
        return None
    rows = rows[:count]
    ends = [i for i, met in releases_among(rows, p.balls, section.ties) if met == target]
    last = min(ends, key=lambda i: abs(rows[i, col.TIME] - span), default=None)
    if last is None or abs(rows[last, col.TIME] - span) > _EARLY * p.period:
        return None
    end = release_now(target, rows[last])
    Y = tangent_product(c, rows, 0, last) @ _carried_back(p, section, z)
    return Ran(rows.copy(), last, float(rows[last, col.TIME]), end, _at_release(p, target, end, Y))


def solve_round(p: Any, section: Section, span: float, z: Floats, mirrored: bool, most: int) -> tuple[Floats, float]:
    """Solve for a release that comes back after a span, or as its mirror image, by damped Newton steps.

    Returns
    -------
    (z, defect)
        The release, and what is left; inf where it does not converge.
    """
    target = section.mirrored() if mirrored else section
    z = z.copy()
    ran = run_round(p, section, span, z, target)
    if ran is None:
        return z, math.inf
    defect, slope = closing(p, ran, span, z, mirrored)
    size, runs = float(np.abs(defect).max()), 1
    while runs < most and size > 0.0:
        try:
            step = -np.linalg.solve(slope, defect)
        except np.linalg.LinAlgError:
            return z, math.inf
        share, better = 1.0, math.inf
        floor = 64.0 * _EPS * (span + float(np.abs(z).max()))
        while share > 0.5**_HALVINGS and runs < most:
            trial = z + share * step
            ran = run_round(p, section, span, trial, target)
            runs += 1
            if ran is not None:
                defect, slope = closing(p, ran, span, trial, mirrored)
                better = float(np.abs(defect).max())
                if better < size:
                    break
            if share * float(np.abs(step).max()) < floor:
                break
            share *= 0.5
        if not better < size:
            break
        z, size = trial, better
        if share == 1.0 and float(np.abs(step).max()) < floor:
            break
    rounding = floor_of(slope, span, z)
    z[0] %= 2.0 * math.pi
    return z, (size if size < max(_CLOSES, rounding) else math.inf)


def floor_of(slope: Floats, span: float, z: Floats) -> float:
    """Return the defect that rounding may leave."""
    return 64.0 * _EPS * (span + float(np.abs(z).max())) * (1.0 + float(np.abs(slope).max()))


def closing(p: Any, ran: Ran, span: float, z: Floats, mirrored: bool) -> tuple[Floats, Floats]:
    """Return by how much a release misses itself, or its mirror image, and the slopes by phase and coordinates."""
    sign = -1.0 if mirrored else 1.0
    defect = np.append(ran.lasts - span, ran.end[1:] - sign * z[1:])
    slope = ran.slopes - np.diag([1.0, *[sign] * (len(z) - 1)])
    slope[:, 0] /= p.Omega
    return defect, slope
