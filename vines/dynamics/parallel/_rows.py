"""Rows of events of several balls."""

from __future__ import annotations

from vines.dynamics import _advance as col
from vines.dynamics._flight import advance_phase, derivatives, flight, flown, free_ball
from vines.dynamics._window import width_of, write_end
from vines.dynamics.parallel._constants import ParallelConstants, ParallelTable, frame_with
from vines.dynamics.parallel._layout import B_MODE, B_RUN, B_V2, B_WALL, B_X2, BALL, BEFORE, R_V2, R_X2, TIES, at
from vines.kernels import fused_njit, linked_njit, njit

__all__ = ["modes_of", "place_balls", "write"]


@njit
def modes_of(mu, state):
    """Return the number of the set of balls that ride on a wall, with the sign of the wall."""
    modes = 0.0
    for i in range(len(mu)):
        modes += state[at(i, B_MODE)] * (1 << i)
    return modes


@linked_njit
def write(mu, row, state, kind, side, tau, i, v1, v2, ties, before):
    """Write a row for ball i: v1, v2 and the set of riding balls are those just before, all else is as it is now."""
    row[col.KIND], row[col.SIDE], row[col.TIME], row[col.TAU] = kind, side, state[col.S_T], tau
    row[col.PHASE], row[col.X1], row[col.V1] = state[col.S_PHASE], state[col.S_X1], v1
    row[col.X2], row[col.V2] = state[at(i, B_X2)], v2
    row[col.A_V1], row[col.A_V2] = state[col.S_V1], state[at(i, B_V2)]
    row[col.MODE] = modes_of(mu, state)
    row[col.RUN] = state[at(i, B_RUN)] if kind == col.STICK else 0.0
    row[BALL], row[TIES], row[BEFORE] = i + 1.0, ties, before
    for k in range(len(mu)):
        row[R_X2 + 2 * k], row[R_V2 + 2 * k] = state[at(k, B_X2)], state[at(k, B_V2)]


@fused_njit
def place_balls(c, state, x, v, tau):
    """Move all balls on by tau, at whose end the frame is at x with velocity v: only those that ride are on a wall."""
    for i in range(len(c.mu)):
        wall = state[at(i, B_MODE)]
        if tau > 0.0:
            state[at(i, B_WALL)] = wall
        if wall != 0.0:
            state[at(i, B_X2)], state[at(i, B_V2)] = x - wall * c.beta[i], v
        else:
            way, speed = free_ball(c, state[at(i, B_V2)], tau)
            state[at(i, B_X2)] += way
            state[at(i, B_V2)] = speed


@width_of.register(ParallelTable)
@njit
def _width_of(table):
    return R_X2 + 2 * len(table.constants.mu)


@write_end.register(ParallelConstants)
@linked_njit
def _write_end(c, state, end, last):
    tau = (end - state[col.S_T]) - state[col.S_T_LOW]
    modes = modes_of(c.mu, state)
    o = frame_with(c, modes)
    motion = flight(c, o, state[col.S_X1], state[col.S_V1], state[col.S_PHASE], state[col.S_T])
    x, v, _, _, _ = derivatives(o, c.Omega, *flown(c, o, motion, tau))
    for k in range(last.shape[0]):
        last[k] = 0.0
    last[col.KIND], last[col.TIME], last[col.TAU], last[col.MODE] = col.END, end, tau, modes
    last[col.PHASE] = advance_phase(state[col.S_PHASE], c.Omega * tau)
    last[col.X1], last[col.V1], last[col.A_V1] = x, v, v
    for i in range(len(c.mu)):
        wall = state[at(i, B_MODE)]
        if wall != 0.0:
            last[R_X2 + 2 * i], last[R_V2 + 2 * i] = x - wall * c.beta[i], v
        else:
            way, speed = free_ball(c, state[at(i, B_V2)], tau)
            last[R_X2 + 2 * i], last[R_V2 + 2 * i] = state[at(i, B_X2)] + way, speed
    last[col.X2], last[col.V2], last[col.A_V2] = last[R_X2], last[R_V2], last[R_V2]
    last[BALL], last[BEFORE] = 1.0, modes
