"""What a start state must be."""

from __future__ import annotations

from vines.bounds import check_number
from vines.errors import StateError

__all__ = ["LARGEST", "check_coordinate", "check_gap", "check_numbers", "check_start"]

LARGEST = 1e6
"""Largest coordinate of a start, in half lengths of the cavity: a gap is then known to 1e-10."""

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
        check_number(name, value, unit=" at the start")


def check_coordinate(name: str, value: float) -> None:
    """Raise `StateError` unless a coordinate of a start is a number that leaves the cavity its digits."""
    check_number(name, value, least=-LARGEST, most=LARGEST, unit=" at the start")


def check_gap(w: float) -> None:
    """Raise `StateError` unless a ball with this gap is inside its cavity."""
    if abs(w) > 1.0 + SLACK:
        raise StateError(f"the gap w = x1 - x2 is {w:g} at the start; allowed is |w| <= 1: the ball is in the cavity")
