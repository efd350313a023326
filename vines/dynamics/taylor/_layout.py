"""Where the state of a run holds the step of its series: it begins as that of one ball does."""

from __future__ import annotations

from vines.dynamics._advance import STATE
from vines.kernels import fused_njit

__all__ = ["CLEAR", "SINCE", "STEP_U", "STEP_V", "STEP_W", "STEP_X", "TAYLOR_STATE", "begin_step"]

SINCE, STEP_X, STEP_V, STEP_W, STEP_U, CLEAR = range(STATE, STATE + 6)
"""Time from the last event to the begin of the step, the state there, and how far into it is known to be clear."""

TAYLOR_STATE = STATE + 6
"""Length of a state."""


@fused_njit
def begin_step(state, since, x, v, w, u):
    """Let a step begin at a time since the last event."""
    state[SINCE], state[CLEAR] = since, 0.0
    state[STEP_X], state[STEP_V], state[STEP_W], state[STEP_U] = x, v, w, u
