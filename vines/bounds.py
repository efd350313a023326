"""How long a point may take: what nobody computes by mistake, and a signal is not heard inside a kernel in Python."""

from __future__ import annotations

import os

from vines.errors import StateError

__all__ = ["MOST_PERIODS", "check_periods"]

MOST_PERIODS = 10_000_000
"""Forcing periods of one point: they take a minute, and a sweep has hundreds of points."""
_ALLOWED_BY = "VINES_LONG_POINTS"
"""Variable of the environment that allows more; no option, since it changes no result and belongs to no key."""


def check_periods(name: str, periods: float) -> None:
    """Refuse a point of years.

    Parameters
    ----------
    name : str
        What the periods are for.
    periods : float
        Forcing periods of one point.

    Raises
    ------
    StateError
        If there are more than `MOST_PERIODS`, and the environment does not allow it.

    Examples
    --------
    >>> check_periods("settle", 400)
    >>> check_periods("settle", 1e14)
    Traceback (most recent call last):
        ...
    vines.errors.StateError: settle is 1e+14, allowed is settle <= 10000000 periods a point; \
VINES_LONG_POINTS=1 in the environment allows more
    """
    if periods > MOST_PERIODS and not os.environ.get(_ALLOWED_BY):
        raise StateError(
            f"{name} is {periods}, allowed is {name} <= {MOST_PERIODS} periods a point; "
            f"{_ALLOWED_BY}=1 in the environment allows more"
        )
