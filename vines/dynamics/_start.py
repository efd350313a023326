"""What a start state must be."""

from __future__ import annotations

import math

from vines.errors import StateError

__all__ = ["check_gap", "check_numbers", "check_start"]

SLACK = 1e-12
"""A gap larger than 1 by no more than this is rounding of a start on the wall."""


def check_start(**values: float) -> None:
    """Raise unless all values are finite numbers and the ball is inside the cavity.

    Parameters
    ----------
    **values : float
        x1, v1, x2, v2 and any other numbers of the start, by name.

    Raises
    ------
    StateError
        If a value is not a finite number, or if the gap is larger than 1.

    Examples
    --------
    >>> check_start(x1=0.0, v1=0.0, x2=1.5, v2=0.1)
    Traceback (most recent call last):
    vines.errors.StateError: the gap w = x1 - x2 is -1.5 at the start; allowed is |w| <= 1: the ball is in the cavity
    """
    check_numbers(**values)
    check_gap(values["x1"] - values["x2"])


def check_numbers(**values: float) -> None:
    """Raise `StateError` unless all values are finite numbers."""
    for name, value in values.items():
        if isinstance(value, bool) or not hasattr(value, "__float__") or not math.isfinite(value):
            raise StateError(f"{name} is {value!r} at the start; give a finite number")


def check_gap(w: float) -> None:
    """Raise `StateError` unless a ball with this gap is inside its cavity."""
    if abs(w) > 1.0 + SLACK:
        raise StateError(f"the gap w = x1 - x2 is {w:g} at the start; allowed is |w| <= 1: the ball is in the cavity")
