"""The event loop for a structure of several modes: as that of one oscillator, with the modes carried along."""

from __future__ import annotations

from vines.dynamics import _advance as col
from vines.dynamics._advance import (
    AFRESH,
    BUFFER_FULL,
    COMPLETE,
    EVENT_CAP,
    RELEASE,
    S_CLEAR,
    S_DECIDE,
    S_MODE,
    S_PHASE,
    S_T,
    S_T_LOW,
    S_V1,
    S_V2,
    S_WALL,
    S_X1,
    S_X2,
    START,
    STEP_LIMIT,
    STICK,
    advance,
    begin,
    count_run,
    move,
    place,
    set_state,
    strike,
    too_many,
    write_row,
)
from vines.dynamics._contact import CONTACT, NO_CONTACT, contact_within
from vines.dynamics._flight import advance_phase, derivatives, free_ball, turn
from vines.dynamics._sticking import merges, release_within
from vines.dynamics._window import width_of, write_end
from vines.dynamics.modes._constants import ModesConstants, ModesTable
from vines.dynamics.modes._jet import launch, modal_at
from vines.dynamics.modes._layout import BALL, BEFORE, MODAL, R_MODAL
from vines.dynamics.modes._motion import kick, place_first
from vines.kernels import entry_njit, fused_njit, linked_njit, loop_njit, njit

__all__ = ["set_modes"]


@entry_njit
def set_modes(c, state, x1, v1, x2, v2, phase, t):
    """Put a run at its start; x2 and v2 hold the ball's, then amplitude or velocity of each mode from the second on."""
    set_state(state, x1, v1, x2[0], v2[0], phase, t)
    for k in range(1, c.modes):
        state[MODAL + 2 * k], state[MODAL + 1 + 2 * k] = x2[k], v2[k]
    place_first(c, x1, v1, state[S_PHASE], state, MODAL)


@fused_njit
def _write_modes(c, row, state, before):
    """Write what a row has behind that of one ball."""
    row[BALL], row[BALL + 1], row[BEFORE] = 1.0, 0.0, before
    for i in range(2 * c.modes):
        row[R_MODAL + i] = state[MODAL + i]


@begin.register(ModesConstants)
@linked_njit
def _begin(c, state, rows):
    write_row(rows[0], state, START, int(state[S_WALL]), 0.0, state[S_X1], state[S_V1], state[S_X2], state[S_V2])
    _write_modes(c, rows[0], state, state[S_MODE])


@fused_njit
def _kicked(c, v2, row, state):
    """Let the modes take what the ball, which came with v2, gave in the event of a row."""
    kick(c, -c.mu * (state[S_V2] - v2), state, MODAL)
    _write_modes(c, row, state, 0.0)


@advance.register(ModesConstants)
@loop_njit
def _advance(c, state, stop, cap, rows, first):
    count = first
    size = rows.shape[0]
    while True:
        if count >= size:
            return count, BUFFER_FULL
        left = (stop - state[S_T]) - state[S_T_LOW]
        if left < 0.0:
            return count, COMPLETE
        side = int(state[S_MODE])
        x2, v2 = state[S_X2], state[S_V2]
        o = c.stuck if side != 0 else c.free
        motion = launch(c, o, state, MODAL, state[S_PHASE])
        until = min(left, AFRESH)
        if side != 0:
            code, tau, x, v = release_within(c, o, side, motion, state[S_CLEAR], until)
            if code == CONTACT:
                modal_at(c, o, tau, state, MODAL)
                move(c, state, tau)
                place(state, 0, side, 1.0, x, v, x - side, v)
                after = launch(c, c.free, state, MODAL, state[S_PHASE])
                if side * after[4] >= 0.0:
                    # Contact was lost at once, with a push away from the wall that is not zero.
                    state[col.S_RELEASED] = 0.0
                write_row(rows[count], state, RELEASE, side, tau, x, v, x - side, v)
                _write_modes(c, rows[count], state, float(side))
                count += 1
                if too_many(state, cap, c.period):
                    return count, EVENT_CAP
                continue
        else:
            wall = int(state[S_WALL])
            if state[S_DECIDE] != 0.0:
                state[S_DECIDE] = 0.0
                speed = max(wall * (v2 - state[S_V1]), 0.0)
                if merges(c, c.free, c.r, c.correction, wall, speed, motion, x2):
                    x1, v1 = state[S_X1], state[S_V1]
                    common = (v1 + c.law.ratio * v2) / (1.0 + c.law.ratio)
                    run = state[col.S_RUN]
                    state[col.S_RUN] = 0.0
                    place(state, wall, wall, 0.0, x1, common, x1 - wall, common)
                    write_row(rows[count], state, STICK, wall, 0.0, x1, v1, x2, v2)
                    rows[count, col.RUN] = run
                    _kicked(c, v2, rows[count], state)
                    count += 1
                    if too_many(state, cap, c.period):
                        return count, EVENT_CAP
                    continue
            code, tau, hit, x, v = contact_within(
                c, motion, x2, v2, wall, state[col.S_RELEASED] != 0.0, state[S_CLEAR], until
            )
            if code == CONTACT:
                modal_at(c, o, tau, state, MODAL)
                move(c, state, tau)
                count_run(state, hit)
                strike(c.law, state, hit, tau, x, v, v2, rows[count])
                _kicked(c, v2, rows[count], state)
                count += 1
                if too_many(state, cap, c.period):
                    return count, EVENT_CAP
                continue
        state[S_CLEAR] = tau
        if code != NO_CONTACT:
            return count, STEP_LIMIT
        if left <= AFRESH:
            return count, COMPLETE
        modal_at(c, o, until, state, MODAL)
        x, v, _, _, _ = derivatives(o, c.Omega, *turn(o, c.Omega, *motion, until))
        move(c, state, until)
        if side != 0:
            place(state, side, side, 0.0, x, v, x - side, v)
        else:
            place(state, 0, 0, 0.0, x, v, x2 + v2 * until, v2)
        write_row(rows[count], state, START, 0, until, x, v, state[S_X2], state[S_V2])
        _write_modes(c, rows[count], state, float(side))
        count += 1


@width_of.register(ModesTable)
@njit
def _width_of(table):
    return R_MODAL + 2 * table.constants.modes


@write_end.register(ModesConstants)
@linked_njit
def _write_end(c, state, end, last):
    tau = (end - state[S_T]) - state[S_T_LOW]
    side = state[S_MODE]
    o = c.stuck if side != 0.0 else c.free
    motion = launch(c, o, state, MODAL, state[S_PHASE])
    x, v, _, _, _ = derivatives(o, c.Omega, *turn(o, c.Omega, *motion, tau))
    way, v2 = free_ball(c, state[S_V2], tau)
    x2 = state[S_X2] + way
    if side != 0.0:
        x2, v2 = x - side, v
    last[col.KIND], last[col.SIDE], last[col.TIME], last[col.TAU] = col.END, 0.0, end, tau
    last[col.PHASE], last[col.MODE], last[col.RUN] = advance_phase(state[S_PHASE], c.Omega * tau), side, 0.0
    last[col.X1], last[col.V1], last[col.X2], last[col.V2] = x, v, x2, v2
    last[col.A_V1], last[col.A_V2] = v, v2
    last[BALL], last[BALL + 1], last[BEFORE] = 1.0, 0.0, side
    modal_at(c, o, tau, last, R_MODAL)
