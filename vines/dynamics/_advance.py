"""The event loop: from one impact, merge or release to the next, resumable at any point.

The whole state of a run is one array of doubles, so that the kernel can stop when its buffer of rows is full, or where
a window of time ends, and go on later as if nothing had been: a run does not depend on how it was cut into calls.
"""

from __future__ import annotations

import numpy as np

from vines.dynamics._constants import Constants
from vines.dynamics._contact import CONTACT, NO_CONTACT, next_contact
from vines.dynamics._flight import advance_phase, ball_flown, derivatives, flown, launched, phase_after, relative
from vines.dynamics._impact_law import after_impact_kernel
from vines.dynamics._sticking import merges, next_release
from vines.kernels import by_type, fused_njit, linked_njit, loop_njit, njit

__all__ = [
    "A_V1",
    "A_V2",
    "BUFFER_FULL",
    "COMPLETE",
    "EVENT_CAP",
    "IMPACT",
    "KIND",
    "MODE",
    "PHASE",
    "RELEASE",
    "ROW",
    "RUN",
    "SIDE",
    "SLIDE",
    "START",
    "STEP_LIMIT",
    "STICK",
    "STOP",
    "TAU",
    "TIME",
    "V1",
    "V2",
    "X1",
    "X2",
    "advance",
    "begin",
    "count_run",
    "law_of",
    "merge",
    "move",
    "new_state",
    "pass_over",
    "place",
    "set_state",
    "shift_time",
    "state_now",
    "strike",
    "too_many",
    "write_row",
]

# Kinds of rows. START is also written inside a very long flight, where the closed form is started afresh. With friction
# a ball may STOP in mid-cavity, and SLIDE is where it begins to slide the other way, or again.
START, IMPACT, STICK, RELEASE, END, STOP, SLIDE = range(7)

# Columns of a row: what happened, on which wall, when (and how long after the row before), the state just before and
# the velocities just after, the mode of the motion after it (0 flight, else the wall stuck to) and, for STICK, the
# impacts of the chatter that it ends.
KIND, SIDE, TIME, TAU, PHASE, X1, V1, X2, V2, A_V1, A_V2, MODE, RUN = range(13)
ROW = 13

# Entries of the state of a run.
(
    S_MODE,
    S_WALL,
    S_RELEASED,
    S_X1,
    S_V1,
    S_X2,
    S_V2,
    S_PHASE,
    S_T,
    S_T_LOW,
    S_CLEAR,
    S_RUN,
    S_RUN_SIDE,
    S_PERIOD_START,
    S_PERIOD_EVENTS,
    S_DECIDE,
    S_IMPACTS,
) = range(17)
STATE = 17

COMPLETE, BUFFER_FULL, EVENT_CAP, STEP_LIMIT = 0, 1, 2, 3

AFRESH = 256.0
"""Time after which a flight without impact is started afresh, so that its phases keep their digits."""

SNAP = 8.0 * 2.220446049250313e-16
"""A start whose gap is this near to a wall, relative to the positions, is a start on that wall."""


@linked_njit
def set_state(state, x1, v1, x2, v2, phase, t):
    """Put a run at its start: a state with |x1 - x2| <= 1 up to rounding, the phase of the forcing, and the time."""
    w = x1 - x2
    side = 0
    if abs(w) >= 1.0 - SNAP * (1.0 + abs(x1) + abs(x2)):
        side = 1 if w > 0.0 else -1
        x2 = x1 - side
    state[:] = 0.0
    approaching = side * (v1 - v2) > 0.0
    state[S_WALL] = 0.0 if approaching else side
    state[S_DECIDE] = 0.0 if approaching or side == 0 else 1.0
    state[S_X1] = x1
    state[S_V1] = v1
    state[S_X2] = x2
    state[S_V2] = v2
    state[S_PHASE] = advance_phase(phase, 0.0)
    state[S_T] = t
    state[S_PERIOD_START] = t


@linked_njit
def state_now(c, state, t):
    """Return (x1, v1, x2, v2, phase, tau) at time t, which must not lie before the last event or after the next."""
    tau = (t - state[S_T]) - state[S_T_LOW]
    side = state[S_MODE]
    o = c.stuck if side != 0.0 else c.free
    motion = launched(c, o, state[S_X1], state[S_V1], state[S_V2], state[S_PHASE], state[S_T])
    x1, v1, _, _, _ = derivatives(o, c.Omega, *flown(c, o, motion, tau))
    phase = phase_after(c, state[S_PHASE], c.Omega * tau, state[S_T], t)
    if side != 0.0:
        return x1, v1, x1 - side, v1, phase, tau
    way, v2 = ball_flown(c, motion, state[S_V2], tau)
    return x1, v1, state[S_X2] + way, v2, phase, tau


@fused_njit
def move(c, state, tau):
    """Move time and phase on by tau; time is kept as a sum of two doubles so that it loses nothing over many events."""
    step = tau + state[S_T_LOW]
    t = state[S_T]
    total = t + step
    rest = total - t
    state[S_T_LOW] = (t - (total - rest)) + (step - rest)
    state[S_PHASE] = phase_after(c, state[S_PHASE], c.Omega * tau, t, total)
    state[S_T] = total
    state[S_CLEAR] = 0.0


@fused_njit
def write_row(row, state, kind, side, tau, x1, v1, x2, v2):
    """Write an event that has come to the state as it is now: x1, v1, x2, v2 are those just before."""
    row[KIND] = kind
    row[SIDE] = side
    row[TIME] = state[S_T]
    row[TAU] = tau
    row[PHASE] = state[S_PHASE]
    row[X1] = x1
    row[V1] = v1
    row[X2] = x2
    row[V2] = v2
    row[A_V1] = state[S_V1]
    row[A_V2] = state[S_V2]
    row[MODE] = state[S_MODE]
    row[RUN] = 0.0


@fused_njit
def place(state, mode, wall, released, x1, v1, x2, v2):
    """Put a run where it goes on from; the mode is 0 in flight, else the gap at which the ball rides."""
    state[S_MODE] = mode
    state[S_WALL] = wall
    state[S_RELEASED] = released
    state[S_X1] = x1
    state[S_V1] = v1
    state[S_X2] = x2
    state[S_V2] = v2


@fused_njit
def count_run(state, hit):
    """Count an impact on a wall in its chatter."""
    if hit != state[S_RUN_SIDE] or state[S_RELEASED] != 0.0:
        state[S_RUN] = 0.0
    state[S_RUN] += 1.0
    state[S_RUN_SIDE] = hit


@fused_njit
def strike(law, state, hit, tau, x, v, v2, row):
    """Let the ball hit a wall at the present instant, which comes tau after the row before, and write that."""
    after1, after2 = after_impact_kernel(law, v, v2)
    state[S_IMPACTS] += 1.0
    place(state, 0, hit, 0.0, x, after1, x - hit, after2)
    state[S_DECIDE] = 1.0
    write_row(row, state, IMPACT, hit, tau, x, v, x - hit, v2)


@fused_njit
def merge(c, state, wall, x1, v1, x2, v2, row):
    """Let the ball ride on a wall from now on, with the common velocity, and write that."""
    common = (v1 + c.mu * v2) / (1.0 + c.mu)
    run = state[S_RUN]
    state[S_RUN] = 0.0
    place(state, wall, wall, 0.0, x1, common, x1 - wall, common)
    write_row(row, state, STICK, wall, 0.0, x1, v1, x2, v2)
    row[RUN] = run


@by_type(Constants)
@fused_njit
def law_of(c, closing, number):
    """Return the `ImpactLaw` of impact `number` of a run, at v1 - v2 = closing."""
    return c.law


@by_type(Constants)
@njit
def begin(c, state, rows):
    """Write the row of the start."""
    write_row(rows[0], state, START, int(state[S_WALL]), 0.0, state[S_X1], state[S_V1], state[S_X2], state[S_V2])


@by_type(Constants)
@loop_njit
def advance(c, state, stop, cap, rows, first):
    """Run on to the time `stop` or until `rows` is full.

    Parameters
    ----------
    c : Constants
    state : ndarray, shape (STATE,)
        Changed in place.
    stop : float
        Time at which to stop; what lies after the last event is not written.
    cap : int
        Most events in one forcing period.
    rows : ndarray, shape (n, ROW)
        Filled from row `first` on.

    Returns
    -------
    (count, status)
        Rows filled, `first` included, and COMPLETE, BUFFER_FULL, EVENT_CAP or STEP_LIMIT.
    """
    count = first
    size = rows.shape[0]
    period = c.period
    seen = relative(c)
    while True:
        if count >= size:
            return count, BUFFER_FULL
        left = (stop - state[S_T]) - state[S_T_LOW]
        if left < 0.0:
            return count, COMPLETE
        side = int(state[S_MODE])
        x1 = state[S_X1]
        v1 = state[S_V1]
        x2 = state[S_X2]
        v2 = state[S_V2]
        o = c.stuck if side != 0 else c.free
        motion = launched(c, o, x1, v1, v2, state[S_PHASE], state[S_T])

        if side != 0:
            code, tau, x, v = next_release(c, side, motion, state[S_CLEAR], min(left, AFRESH))
            if code == CONTACT:
                move(c, state, tau)
                place(state, 0, side, 1.0, x, v, x - side, v)
                after = launched(c, c.free, x, v, v, state[S_PHASE], state[S_T])
                _, _, _, j, _ = derivatives(seen.free, c.Omega, *after)
                if side * j >= 0.0:
                    # Contact was lost at once, with a push away from the wall that is not zero.
                    state[S_RELEASED] = 0.0
                write_row(rows[count], state, RELEASE, side, tau, x, v, x - side, v)
                count += 1
                if too_many(state, cap, period):
                    return count, EVENT_CAP
                continue
        else:
            wall = int(state[S_WALL])
            if state[S_DECIDE] != 0.0:
                state[S_DECIDE] = 0.0
                if merges(seen, seen.free, c.r, c.correction, wall, max(wall * (v2 - v1), 0.0), motion, x2):
                    merge(c, state, wall, x1, v1, x2, v2, rows[count])
                    count += 1
                    if too_many(state, cap, period):
                        return count, EVENT_CAP
                    continue
            code, tau, hit, x, v = next_contact(
                c, motion, x2, v2, wall, state[S_RELEASED] != 0.0, state[S_CLEAR], min(left, AFRESH)
            )
            if code == CONTACT:
                move(c, state, tau)
                _, v2 = ball_flown(c, motion, v2, tau)
                count_run(state, hit)
                strike(law_of(c, v - v2, state[S_IMPACTS]), state, hit, tau, x, v, v2, rows[count])
                count += 1
                if too_many(state, cap, period):
                    return count, EVENT_CAP
                continue

        state[S_CLEAR] = tau
        if code != NO_CONTACT:
            return count, STEP_LIMIT
        if left <= AFRESH:
            return count, COMPLETE
        x, v, _, _, _ = derivatives(o, c.Omega, *flown(c, o, motion, tau))
        move(c, state, tau)
        if side != 0:
            place(state, side, side, 0.0, x, v, x - side, v)
        else:
            way, v2 = ball_flown(c, motion, v2, tau)
            place(state, 0, 0, 0.0, x, v, x2 + way, v2)
        write_row(rows[count], state, START, 0, tau, x, v, state[S_X2], state[S_V2])
        count += 1


@fused_njit
def too_many(state, cap, period):
    """Count an event of the running period; say whether there were more than `cap`."""
    if state[S_T] - state[S_PERIOD_START] >= period:
        state[S_PERIOD_START] = state[S_T]
        state[S_PERIOD_EVENTS] = 0.0
    state[S_PERIOD_EVENTS] += 1.0
    return state[S_PERIOD_EVENTS] > cap


def new_state() -> np.ndarray:
    """Return room for the state of a run."""
    return np.zeros(STATE)


@linked_njit
def pass_over(c, state, stop, cap, rows):
    """Run on to `stop` keeping no row; `rows` is only room to work in. Returns COMPLETE, EVENT_CAP or STEP_LIMIT."""
    status = BUFFER_FULL
    while status == BUFFER_FULL:
        _, status = advance(c, state, stop, cap, rows, 0)
    return status


@njit
def shift_time(state, by):
    """Count the time of a run from an origin that lies `by` later."""
    state[S_T] -= by
    state[S_PERIOD_START] -= by
