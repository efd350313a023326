"""Rows of events of several balls."""

from __future__ import annotations

import math

from vines.dynamics import _advance as col
from vines.dynamics._flight import advance_phase, derivatives, flight, flown, free_ball
from vines.dynamics._sticking import UNRESOLVED
from vines.dynamics._window import width_of, write_end
from vines.dynamics.parallel._constants import ParallelConstants, ParallelTable, frame_with
from vines.dynamics.parallel._layout import (
    B_BETA,
    B_DECIDE,
    B_MODE,
    B_RUN,
    B_V2,
    B_WALL,
    B_X2,
    BALL,
    BEFORE,
    R_V2,
    R_X2,
    S_NEXT,
    TIES,
    at,
)
from vines.kernels import fused_njit, linked_njit, njit

__all__ = ["count_riding", "place_balls", "write"]


@linked_njit
def count_riding(balls, state):
    """Let S_MODE be the number of the set of balls that ride on a wall, with the sign of the wall."""
    modes = 0.0
    for i in range(balls):
        modes += state[at(i, B_MODE)] * (1 << i)
    state[col.S_MODE] = modes


@linked_njit
def write(balls, row, state, kind, side, tau, i, v1, v2, ties, before):
    """Write a row for ball i: v1, v2 and the set of riding balls are those just before, all else is as it is now.

    As all balls are looked at here, the one that the search for the next contact begins with is noted, too.
    """
    row[col.KIND], row[col.SIDE], row[col.TIME], row[col.TAU] = kind, side, state[col.S_T], tau
    row[col.PHASE], row[col.X1], row[col.V1] = state[col.S_PHASE], state[col.S_X1], v1
    row[col.X2], row[col.V2] = state[at(i, B_X2)], v2
    row[col.A_V1], row[col.A_V2] = state[col.S_V1], state[at(i, B_V2)]
    row[col.MODE] = state[col.S_MODE]
    row[col.RUN] = state[at(i, B_RUN)] if kind == col.STICK else 0.0
    row[BALL], row[TIES], row[BEFORE] = i + 1.0, ties, before
    first, soonest = 0, math.inf
    for k in range(balls):
        x2, v2, beta = state[at(k, B_X2)], state[at(k, B_V2)], state[at(k, B_BETA)]
        row[R_X2 + 2 * k], row[R_V2 + 2 * k] = x2, v2
        w, rate = state[col.S_X1] - x2, state[col.S_V1] - v2
        lasts = (beta - w if rate > 0.0 else beta + w) / abs(rate)
        if lasts < soonest:
            first, soonest = k, lasts
    state[S_NEXT] = first


@fused_njit
def place_balls(c, state, x, v, tau):
    """Move all balls on by tau, at whose end the frame is at x with velocity v; say whether one of them is on a wall.

    Those that ride are, and one that has just left its wall and is not yet higher over it than doubles resolve: it may
    come to ride there at once.
    """
    if not tau > 0.0:
        return True
    on_wall = False
    for i in range(c.balls):
        wall, beta = state[at(i, B_MODE)], state[at(i, B_BETA)]
        if wall != 0.0:
            state[at(i, B_X2)], state[at(i, B_V2)] = x - wall * beta, v
            state[at(i, B_WALL)] = wall
            on_wall = True
            continue
        way, speed = free_ball(c, state[at(i, B_V2)], tau)
        x2 = state[at(i, B_X2)] + way
        left = state[at(i, B_WALL)]
        if left != 0.0:
            if left * (v - speed) <= 0.0 and beta - left * (x - x2) <= UNRESOLVED * (beta + abs(x) + abs(x2)):
                x2 = x - left * beta
                state[at(i, B_DECIDE)] = state[col.S_DECIDE] = 1.0
                on_wall = True
            else:
                state[at(i, B_WALL)] = 0.0
        state[at(i, B_X2)], state[at(i, B_V2)] = x2, speed
    return on_wall


@width_of.register(ParallelTable)
@njit
def _width_of(table):
    return R_X2 + 2 * table.constants.balls


@write_end.register(ParallelConstants)
@linked_njit
def _write_end(c, state, end, last):
    tau = (end - state[col.S_T]) - state[col.S_T_LOW]
    modes = state[col.S_MODE]
    o = frame_with(c, modes)
    motion = flight(c, o, state[col.S_X1], state[col.S_V1], state[col.S_PHASE], state[col.S_T])
    x, v, _, _, _ = derivatives(o, c.Omega, *flown(c, o, motion, tau))
    for k in range(last.shape[0]):
        last[k] = 0.0
    last[col.KIND], last[col.TIME], last[col.TAU], last[col.MODE] = col.END, end, tau, modes
    last[col.PHASE] = advance_phase(state[col.S_PHASE], c.Omega * tau)
    last[col.X1], last[col.V1], last[col.A_V1] = x, v, v
    for i in range(c.balls):
        wall = state[at(i, B_MODE)]
        if wall != 0.0:
            last[R_X2 + 2 * i], last[R_V2 + 2 * i] = x - wall * state[at(i, B_BETA)], v
        else:
            way, speed = free_ball(c, state[at(i, B_V2)], tau)
            last[R_X2 + 2 * i], last[R_V2 + 2 * i] = state[at(i, B_X2)] + way, speed
    last[col.X2], last[col.V2], last[col.A_V2] = last[R_X2], last[R_V2], last[R_V2]
    last[BALL], last[BEFORE] = 1.0, modes
