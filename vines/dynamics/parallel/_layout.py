"""Where the state of a run and the rows of its events hold what belongs to each ball.

Both begin as those of one ball do. In a row MODE is the number of the set of balls that ride on a wall, bit i for ball
i, with the sign of the wall: they all ride on the same one. RUN of an impact is the set of the balls that are struck at
once, with a sign in all rows of theirs but the first, and 0 for one alone.
"""

from __future__ import annotations

from vines.dynamics._advance import ROW, STATE

__all__ = [
    "BALL", "BALLS", "BEFORE", "B_BETA", "B_DECIDE", "B_FOUND", "B_MODE", "B_RELEASED", "B_RUN", "B_RUN_SIDE",
    "B_STEP", "B_V2", "B_WALL", "B_X2", "EACH", "R_V2", "R_X2", "S_IN_TURN", "S_NEXT", "S_TIES", "TIES", "at",
    "row_width", "state_size",
]  # fmt: skip

from vines.kernels import fused_njit

S_TIES = STATE
"""Ties so far: instants at which several balls hit together."""

S_NEXT = STATE + 1
"""The ball that came to a wall first after the last event, had nothing bent its way: where the search begins."""

S_IN_TURN = STATE + 2
"""Whether balls that arrive together are struck one after the other, in the order of their numbers, not at once."""

BALLS = STATE + 3
B_X2, B_V2, B_MODE, B_WALL, B_RELEASED, B_DECIDE, B_RUN, B_RUN_SIDE, B_STEP, B_FOUND, B_BETA = range(11)
"""Of each ball: position, velocity, the wall it rides on, the wall just left, whether it was let go there, whether it
may stick from now on, impacts of the present chatter and their wall; room of the search for contacts; half the length
of its cavity, which stands here too because the element of a tuple is picked by a chain of branches."""

EACH = 11

BALL, TIES, BEFORE = ROW, ROW + 1, ROW + 2
"""Columns: number of the ball, from 1 on; balls that hit together with it, 0 for one alone; MODE before the event."""

R_X2, R_V2 = ROW + 3, ROW + 4
"""Position and velocity of ball 1 just after the event; those of ball i + 1 follow two columns later."""


@fused_njit
def at(i, what):
    """Return the place in a state of what belongs to ball i, counted from 0."""
    return BALLS + EACH * i + what


def state_size(balls: int) -> int:
    """Return the length of a state."""
    return BALLS + EACH * balls


def row_width(balls: int) -> int:
    """Return the length of a row."""
    return ROW + 3 + 2 * balls
