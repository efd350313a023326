"""Where the state of a run, the rows of its events and the totals of a window hold what belongs to each mode.

All begin as those of one ball do. Rows are as wide, and have the same columns behind them, as those of as many numbered
balls: the only ball has the number 1.
"""

from __future__ import annotations

from vines.dynamics._advance import ROW, STATE
from vines.dynamics._totals import TOTALS

__all__ = [
    "BALL", "BEFORE", "DAMPER", "EACH", "MODAL", "R_MODAL", "SPEED_SQUARE", "STRAIN_SQUARE", "row_width", "state_size",
    "totals_size",
]  # fmt: skip

MODAL = STATE
"""Amplitude and velocity of the first mode in a state; those of the next stand two places later."""

BALL, BEFORE = ROW, ROW + 2
"""Columns: number of the ball, 1; MODE before the event. The one between is 0: nothing hits together with it."""

R_MODAL = ROW + 3
"""Amplitude and velocity of the first mode just after the event; those of the next follow two columns later."""

SPEED_SQUARE, STRAIN_SQUARE, DAMPER = range(TOTALS, TOTALS + 3)
"""Totals of the first mode: integrals of its squared velocity, and of its squared frequency times squared distance from
the base's share, and what its damper takes; those of the next mode begin EACH later."""

EACH = 3


def state_size(modes: int) -> int:
    """Return the length of a state."""
    return MODAL + 2 * modes


def row_width(modes: int) -> int:
    """Return the length of a row."""
    return R_MODAL + 2 * modes


def totals_size(modes: int) -> int:
    """Return the length of the totals of a window."""
    return TOTALS + EACH * modes
