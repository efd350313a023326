"""From one release to the release that ends a sequence of contacts, by the event loop of the simulator itself.

Just after a release the ball is on a wall, moves with it, and the contact force vanishes: x1'' = F - lam v1 - x1 = 0.
So the phase of the forcing and v1 say all, and a periodic orbit that sticks is a fixed point of a map of the plane. The
impacts of its chatters are not unknowns: the event loop finds them, as many as it takes until a merge is exact to
rounding. The derivative of the map is that of the tangent map, through impacts, merges and releases (docs/sticking.md).
"""

from __future__ import annotations

import math

from vines.dynamics.kernels import advance, begin, flow_basis, jump_basis
from vines.dynamics.kernels import rows as col
from vines.kernels import linked_njit, new_vector, njit, zero_matrix

__all__ = [
    "CHATTER",
    "LONGEST",
    "ROOM",
    "force_slope",
    "newton_round",
    "next_event",
    "put_at_release",
    "round_kernel",
    "round_slopes",
    "search_rounds",
]

CHATTER = 2
"""Size of the mark of a contact that is a complete chatter; that of a single impact is 1."""

ROOM = 8192
"""Events that a round may have at most."""

LONGEST = 2.0
"""A round may last that many spans and one forcing period more."""

_HALVINGS = 12

_QUICK = 40
"""Rounds that Newton's method may take from a release of a grid: from a good one it takes five to ten."""

_EPS = 2.220446049250313e-16


@njit
def force_slope(c, phase):
    """Return the derivative by time of the force F of the base at a phase of the forcing."""
    return c.A * c.Omega * math.cos(phase) - c.lam * c.Omega * c.Omega * c.A * math.sin(phase)


@njit
def put_at_release(c, side, phase, v1, state):
    """Put a run just after a release on a wall; say whether there can be one: the contact force has to fall."""
    force = c.A * math.sin(phase) + c.lam * c.Omega * c.A * math.cos(phase)
    for k in range(state.shape[0]):
        state[k] = 0.0
    x1 = force - c.lam * v1
    state[col.S_WALL], state[col.S_RELEASED] = side, 1.0
    state[col.S_X1], state[col.S_V1], state[col.S_X2], state[col.S_V2] = x1, v1, x1 - side, v1
    state[col.S_PHASE] = phase % (2.0 * math.pi)
    return side * (force_slope(c, phase) - v1) < 0.0


@njit
def next_event(c, state, stop, rows, count):
    """Go on to the next event, which row `count` is filled with; return its kind and wall, kind -1 if there is none."""
    after, status = advance(c, state, stop, rows.shape[0], rows[: count + 1], count)
    if status != col.BUFFER_FULL or after != count + 1:
        return -1, 0
    return int(rows[count, col.KIND]), int(rows[count, col.SIDE])


@linked_njit
def round_slopes(c, phase, v1, rows, out):
    """Fill `out` with time and velocity at the last row, a release, and their derivatives by those of the first."""
    count = rows.shape[0]
    last = rows[count - 1]
    last[col.A_V1], last[col.A_V2] = last[col.V1], last[col.V2]
    out[0], out[1] = last[col.TIME], last[col.V1]
    # Columns: the start later by dt, with the same velocity, carried back to the time of the start; a larger velocity.
    Y = zero_matrix(4, 4)
    Y[0, 0] = Y[2, 0] = force_slope(c, phase) - v1
    Y[0, 1] = Y[2, 1] = -c.lam
    Y[1, 1] = Y[3, 1] = 1.0
    for i in range(1, count):
        flow_basis(c, rows[i - 1, col.MODE], rows[i, col.TAU], Y)
        jump_basis(c, rows[i], Y)
    # A disturbed run is let go when its own force vanishes. Until then x1'' is 0, to first order.
    falls = force_slope(c, last[col.PHASE]) - last[col.V1]
    for j in range(2):
        out[2 + j] = (c.lam * Y[1, j] + Y[0, j]) / falls
        out[4 + j] = Y[1, j]


@linked_njit
def round_kernel(c, side, wanted, span, phase, v1, rows, out):
    """Run from a release to the one that ends the wanted contacts.

    Parameters
    ----------
    c : vines.dynamics._constants.Constants
    side : int
        Wall of the release, +1 or -1.
    wanted : (N,) int array
        Wall of each contact, times CHATTER where it is a complete chatter, as the last one has to be.
    span : float
        Time in which the orbit sought comes back, or to its mirror image.
    phase, v1 : float
        Phase of the forcing and velocity of ball and oscillator at the release.
    rows : (ROOM, ROW) float array
        Filled with the events, from a row for the start to that of the release.
    out : (6,) float array
        Filled with the time from release to release, the velocity there, and the derivatives of that time by time and
        velocity of the start, then those of the velocity.

    Returns
    -------
    int
        Rows filled, 0 where other contacts come.
    """
    state = new_vector(col.STATE)
    if not put_at_release(c, side, phase, v1, state):
        return 0
    begin(c, state, rows)
    stop = LONGEST * span + c.period
    count, reached, chatters = 1, 0, False
    while True:
        if count == rows.shape[0]:
            return 0
        kind, wall = next_event(c, state, stop, rows, count)
        if kind < 0:
            return 0
        count += 1
        want = wanted[reached]
        if kind == col.IMPACT:
            if wall * want < 0:
                return 0
            if abs(want) == CHATTER:
                chatters = True
            else:
                reached += 1
                if reached == wanted.shape[0]:
                    return 0
        elif kind == col.STICK:
            if not chatters:
                return 0
        elif kind == col.RELEASE:
            if not chatters:
                return 0
            chatters = False
            reached += 1
            if reached == wanted.shape[0]:
                break
    round_slopes(c, phase, v1, rows[:count], out)
    return count


@njit
def _defect(out, span, sign, v1):
    return out[0] - span, out[1] - sign * v1


@linked_njit
def newton_round(c, side, wanted, span, sign, phase, v1, most, rows, out):
    """Solve for a release that comes back after a span, or as its mirror image (sign -1), by damped Newton steps.

    Parameters
    ----------
    c, side, wanted, span, phase, v1, rows, out
        As for `round_kernel`; the release from which to start.
    sign : float
        +1 or -1.
    most : int
        Rounds that may be run.

    Returns
    -------
    (count, phase, v1, defect)
        Rows filled in the last round, 0 where it does not converge; the release; what is left of time and velocity.
    """
    count = round_kernel(c, side, wanted, span, phase, v1, rows, out)
    if count == 0:
        return 0, phase, v1, math.inf
    late, fast = _defect(out, span, sign, v1)
    size = max(abs(late), abs(fast))
    ran = 1
    while ran < most:
        a, b = out[2] - 1.0, out[3]
        d, e = out[4], out[5] - sign
        det = a * e - b * d
        if det == 0.0:
            return 0, phase, v1, size
        dt, dv = -(late * e - b * fast) / det, -(a * fast - d * late) / det
        share, better, met = 1.0, math.inf, 0
        trial_phase, trial_v = phase, v1
        for _ in range(_HALVINGS):
            trial_phase, trial_v = phase + share * c.Omega * dt, v1 + share * dv
            met = round_kernel(c, side, wanted, span, trial_phase, trial_v, rows, out)
            ran += 1
            if met > 0:
                late, fast = _defect(out, span, sign, trial_v)
                better = max(abs(late), abs(fast))
                if better < size:
                    break
            if share * max(abs(dt), abs(dv)) < 64.0 * _EPS * (span + abs(v1)):
                break
            share *= 0.5
        floor = 64.0 * _EPS * (span + abs(v1)) * (1.0 + abs(out[3]) + abs(out[5]))
        if met == 0 or not better < size:
            # No step gets nearer: it is as near as rounding allows, or it does not converge.
            count = round_kernel(c, side, wanted, span, phase, v1, rows, out)
            return (count if size < max(1e-11, floor) else 0), phase, v1, size
        step = share * max(abs(dt), abs(dv))
        phase, v1, size, count = trial_phase, trial_v, better, met
        if size < 1e-15 or (share == 1.0 and step < 4.0 * _EPS * (span + abs(v1))):
            return count, phase, v1, size
    return (count if size < 1e-11 else 0), phase, v1, size


@linked_njit
def search_rounds(c, side, wanted, span, sign, phases, speeds, rows, found):
    """Try Newton's method from each release of a grid; fill `found` with phase and velocity of those it leads to.

    Parameters
    ----------
    phases, speeds : float arrays
        Phases at the release, and by how much the wall is faster there, against the ball, than the contact force asks.
    found : (m, 2) float array

    Returns
    -------
    (count, met)
        Solutions written, and from how many releases of the grid the wanted contacts come.
    """
    out = new_vector(6)
    count, met = 0, 0
    for i in range(phases.shape[0]):
        for j in range(speeds.shape[0]):
            v1 = force_slope(c, phases[i]) + side * speeds[j]
            if round_kernel(c, side, wanted, span, phases[i], v1, rows, out) == 0:
                continue
            met += 1
            rounds, phase, v, _ = newton_round(c, side, wanted, span, sign, phases[i], v1, _QUICK, rows, out)
            if rounds == 0 or count == found.shape[0]:
                continue
            new = True
            for k in range(count):
                turned = (phase - found[k, 0]) / (2.0 * math.pi)
                turned -= round(turned)
                if abs(turned) < 1e-7 and abs(v - found[k, 1]) < 1e-6:
                    new = False
                    break
            if new:
                found[count, 0], found[count, 1] = phase % (2.0 * math.pi), v
                count += 1
    return count, met
