"""Where the state of a run and the rows of its events hold the mass on the spring.

A row is as of one ball in parallel, whose number is 1, and has position and velocity of the mass behind that.
"""

from __future__ import annotations

from vines.dynamics._advance import ROW
from vines.dynamics.taylor._layout import TAYLOR_STATE
from vines.dynamics.taylor._layout import begin_step as begin_gap
from vines.kernels import fused_njit

__all__ = ["HYBRID_ROW", "HYBRID_STATE", "R_V3", "R_X3", "STEP_Y", "STEP_Z", "S_V3", "S_X3", "begin_step", "fill"]

STEP_Z, STEP_Y, S_X3, S_V3 = range(TAYLOR_STATE, TAYLOR_STATE + 4)
"""Gap x1 - x3 and its rate where the step begins, and position and velocity of the mass at the last event."""

HYBRID_STATE = TAYLOR_STATE + 4
"""Length of a state."""

BALL, TIES, BEFORE = ROW, ROW + 1, ROW + 2
"""Columns as of several balls: number of the ball, balls that hit with it, MODE before the event."""

R_X3, R_V3 = ROW + 3, ROW + 4
"""Columns: position and velocity of the mass on the spring; no event changes them."""

HYBRID_ROW = ROW + 5
"""Length of a row."""


@fused_njit
def begin_step(state, since, x, v, w, u, z, y):
    """Let a step begin at a time since the last event."""
    begin_gap(state, since, x, v, w, u)
    state[STEP_Z], state[STEP_Y] = z, y


@fused_njit
def fill(row, before, x3, v3):
    """Write what a row has behind that of one ball."""
    row[BALL], row[TIES], row[BEFORE] = 1.0, 0.0, before
    row[R_X3], row[R_V3] = x3, v3
