"""From release to release at a bound of orbits that stick, where something just comes or just does not.

Beyond a bound other events come, and the round of `round_kernel` does not exist. Here it does on either side, and is
smooth across: a contact that may just come is leapt over, and of a chatter that may just be complete only so many
impacts are followed as are near the one limit of all that just are (docs/sticking.md, "Bounds in two parameters").
"""

from __future__ import annotations

import math
from typing import NamedTuple

from vines.dynamics.kernels import (
    CONTACT,
    advance,
    begin,
    derivatives,
    flight,
    free_ball,
    next_release,
    state_now,
    turn,
)
from vines.dynamics.kernels import rows as col
from vines.kernels import linked_njit, new_vector, njit
from vines.orbits._sticking_map import CHATTER, LONGEST, next_event, put_at_release, round_slopes

__all__ = ["LIMIT", "NOTHING", "PRESSED", "TOUCH", "Bound", "bound_kernel"]

NOTHING, TOUCH, PRESSED, LIMIT = range(4)
"""What is at the bound: nothing; a turning point of a flight touches a wall; the contact force has a minimum of zero
within a spell; the last chatter is only just complete."""

_NEAR = 0.4
"""Share by which a hop may differ from those of the limit, to count as one of it."""

_FAR, _LEAST = 5e-3, 2e-4
"""Times left of a chatter: where the distance to the limit is read off, and where the merge comes. Hops have the
height of their cube, so that doubles still resolve them; what is left of them acts as the fourth power."""


class Bound(NamedTuple):
    """What is at the bound and where in a round.

    Attributes
    ----------
    kind : int
    reached : int
        Contacts complete before it.
    hits : int
        Impacts before it of a chatter that is under way.
    wall : float
        The wall that is touched.
    skip : float
        Time after the turning point, or the minimum, from which on contacts, or a release, count again.
    splits : int
        1 if the flight is to have a row where it touches.
    hop, shrink, growth : float
        Of the limit (`self_similar`).
    """

    kind: int
    reached: int
    hits: int
    wall: float
    skip: float
    splits: int
    hop: float
    shrink: float
    growth: float


@linked_njit
def _leap(c, bound, state, tau, rows, count, out):
    """Write what vanishes at the bound, and go on to where events count again; return the rows that are filled."""
    side = state[col.S_MODE]
    o = c.stuck if side != 0.0 else c.free
    motion = flight(c, o, state[col.S_X1], state[col.S_V1], state[col.S_PHASE], state[col.S_T])
    x, v, a, j, k = derivatives(o, c.Omega, *turn(o, c.Omega, *motion, tau))
    if side == 0.0:
        way, ball = free_ball(c, state[col.S_V2], tau)
        out[6], out[7], out[8] = x - (state[col.S_X2] + way) - bound.wall, v - ball, a
    else:
        out[6], out[7], out[8] = side * a, side * j, side * k
    out[9] = count - 1
    rest = tau + bound.skip
    if bound.splits:
        _move(c, state, tau, rows[count])
        count, rest = count + 1, bound.skip
    _move(c, state, rest, rows[count])
    return count + 1


@linked_njit
def _move(c, state, tau, row):
    """Go on by a time, whatever is met, and write a row."""
    side, t = state[col.S_MODE], state[col.S_T] + tau
    x1, v1, x2, v2, phase, passed = state_now(c, state, t)
    state[col.S_X1], state[col.S_V1], state[col.S_X2], state[col.S_V2] = x1, v1, x2, v2
    state[col.S_PHASE], state[col.S_T], state[col.S_T_LOW], state[col.S_CLEAR] = phase, t, 0.0, 0.0
    state[col.S_WALL], state[col.S_RELEASED], state[col.S_DECIDE] = side, 0.0, 0.0
    _write(row, col.START, 0.0, t, passed, phase, x1, v1, x2, v2, v1, v2, side)


@njit
def _write(row, kind, side, t, tau, phase, x1, v1, x2, v2, after1, after2, mode):
    row[col.KIND], row[col.SIDE], row[col.TIME], row[col.TAU], row[col.PHASE] = kind, side, t, tau, phase
    row[col.X1], row[col.V1], row[col.X2], row[col.V2] = x1, v1, x2, v2
    row[col.A_V1], row[col.A_V2], row[col.MODE], row[col.RUN] = after1, after2, mode, 0.0


@linked_njit
def _if_merged(c, wall, row):
    """Return what would be if the ball merged at an impact.

    That is, after what time it would be let go, x1 and v1 then, and how fast the push on a ball in flight falls there;
    a time of zero where it is not pushed to the wall.
    """
    common = (row[col.A_V1] + c.mu * row[col.A_V2]) / (1.0 + c.mu)
    motion = flight(c, c.stuck, row[col.X1], common, row[col.PHASE], 0.0)
    if not wall * derivatives(c.stuck, c.Omega, *motion)[2] > 0.0:
        return 0.0, 0.0, 0.0, 0.0
    code, tau, x, v = next_release(c, int(wall), motion, 0.0, c.period)
    if code != CONTACT:
        return 0.0, 0.0, 0.0, 0.0
    after = flight(c, c.free, x, v, row[col.PHASE] + c.Omega * tau, 0.0)
    return tau, x, v, -wall * derivatives(c.free, c.Omega, *after)[3]


@linked_njit
def _to_the_limit(c, bound, state, stop, rows, first, out):
    """Follow the last chatter, of which row `first` is the first impact, and merge it where little is left of it.

    Returns
    -------
    int
        Rows filled, up to the release, 0 where the chatter is far from the limit.
    """
    wall = rows[first, col.SIDE]
    q, k = bound.shrink, bound.growth
    power = math.log(k) / -math.log(q)
    count, impacts, near, merges, impacts_then = first + 1, 0, 0, -1, 0
    old, mid, new = 0.0, 0.0, 0.0
    out[6] = math.nan
    final = False
    while True:
        row = rows[count - 1]
        if row[col.KIND] == col.IMPACT:
            impacts += 1
            left, _, _, falls = _if_merged(c, wall, row)
            hop = wall * (row[col.A_V2] - row[col.A_V1]) / (falls * left * left) if left > 0.0 else 0.0
            old, mid, new = mid, new, hop / bound.hop - 1.0
            near = near + 1 if abs(new) < _NEAR else 0
            if not left > 0.0 and math.isfinite(out[6]):
                # The ball has left for good; before the hops of the limit the wall may leave it, too.
                break
            if near > 0:
                merges, impacts_then = count - 1, impacts
            if near >= 3 and not final:
                # Of the limit hops are the same but for terms of the time left and its square, which three hops tell.
                apart = (new - (q + q * q) * mid + q * q * q * old) / ((k - q) * (k - q * q))
                out[6] = k * k * apart * left**power
                final = left < _FAR
            if left < _LEAST and near > 0:
                break
        if count + 3 > rows.shape[0]:
            return 0
        after, status = advance(c, state, stop, rows.shape[0], rows[: count + 1], count)
        if status != col.BUFFER_FULL or after != count + 1:
            break
        if rows[count, col.KIND] == col.STICK or (
            rows[count, col.KIND] == col.IMPACT and rows[count, col.SIDE] != wall
        ):
            break
        count += 1
    if merges < 0 or not math.isfinite(out[6]):
        return 0
    last = rows[merges]
    tau, x, v, _ = _if_merged(c, wall, last)
    common = (last[col.A_V1] + c.mu * last[col.A_V2]) / (1.0 + c.mu)
    t, phase, x1 = last[col.TIME], last[col.PHASE], last[col.X1]
    _write(
        rows[merges + 1], col.STICK, wall, t, 0.0, phase, x1, last[col.A_V1], last[col.X2], last[col.A_V2],
        common, common, wall,
    )  # fmt: skip
    rows[merges + 1, col.RUN] = impacts_then
    phase = (phase + c.Omega * tau) % (2.0 * math.pi)
    _write(rows[merges + 2], col.RELEASE, wall, t + tau, tau, phase, x, v, x - wall, v, v, v, 0.0)
    return merges + 3


@linked_njit
def bound_kernel(c, side, wanted, span, phase, v1, bound, tau, rows, out):
    """Run from a release to the one that ends the wanted contacts, at a bound or beside it.

    Parameters
    ----------
    c, side, wanted, span, phase, v1, rows
        As for `round_kernel`.
    bound : Bound
    tau : float
        Time of the turning point, or minimum, since the event before it.
    out : (10,) float array
        Filled as by `round_kernel`; then, at a turning point, with w less the wall, w' and w''; at a minimum of the
        contact force, with this, over 1 + mu, and its two derivatives; and with the row before it. At a chatter that is
        only just complete, with how far it is from the limit, positive where it is not complete.

    Returns
    -------
    int
        Rows filled, 0 where other contacts come, or the chatter is far from the limit.
    """
    state = new_vector(col.STATE)
    if not put_at_release(c, side, phase, v1, state):
        return 0
    begin(c, state, rows)
    stop = LONGEST * span + c.period
    count, reached, hits = 1, 0, 0
    leaps = bound.kind in (TOUCH, PRESSED)
    while reached < wanted.shape[0]:
        if count + 2 > rows.shape[0]:
            return 0
        if leaps and reached == bound.reached:
            stuck = state[col.S_MODE] != 0.0
            if stuck if bound.kind == PRESSED else hits == bound.hits and not stuck:
                count = _leap(c, bound, state, tau, rows, count, out)
                leaps = False
                continue
        kind, wall = next_event(c, state, stop, rows, count)
        if kind < 0:
            return 0
        count += 1
        want = wanted[reached]
        if kind == col.IMPACT:
            if wall * want < 0:
                return 0
            if abs(want) == CHATTER:
                hits += 1
                if bound.kind == LIMIT and reached == wanted.shape[0] - 1:
                    count = _to_the_limit(c, bound, state, stop, rows, count - 1, out)
                    if count == 0:
                        return 0
                    reached += 1
            else:
                reached += 1
                if reached == wanted.shape[0]:
                    return 0
        elif kind != col.START:
            if hits == 0:
                return 0
            if kind == col.RELEASE:
                hits = 0
                reached += 1
    if leaps:
        return 0
    round_slopes(c, phase, v1, rows[:count], out)
    return count
