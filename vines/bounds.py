"""What numbers are allowed: of any function, and how long a point may take.

A point of years is nothing that anybody computes on purpose, and a signal is not heard inside a kernel in Python.
"""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Sequence
from typing import Any

from vines.errors import ParameterError, StateError, VinesError

__all__ = [
    "MOST_EVENTS",
    "MOST_PERIODS",
    "check_count",
    "check_hold",
    "check_number",
    "check_periods",
    "check_splitting",
    "shown",
]

MOST_PERIODS = 10_000_000
"""Forcing periods of one point: they take a minute, and a sweep has hundreds of points."""
MOST_EVENTS = 1_000_000_000
"""Largest cap on events in one forcing period: they take minutes."""
_ALLOWED_BY = "VINES_LONG_POINTS"
"""Variable of the environment that allows more; no option, since it changes no result and belongs to no key."""


def check_number(
    name: str,
    value: Any,
    *,
    least: float = -math.inf,
    above: float = -math.inf,
    most: float = math.inf,
    below: float = math.inf,
    unit: str = "",
    error: type[VinesError] = StateError,
) -> float:
    """Return a finite number in its range, or say in one line what is allowed.

    Parameters
    ----------
    name : str
        Whose value it is.
    value : object
        Anything that was given.
    least, above, most, below : float
        Allowed is least <= value <= most, above < value < below.
    unit : str
        What follows the value in the message, such as " periods".
    error : type
        What is raised.

    Raises
    ------
    VinesError
        Of the class `error`, if it is not a finite number or out of range.

    Examples
    --------
    >>> check_number("tolerance", 1e-10, above=0, most=1e-3)
    1e-10
    >>> check_number("tolerance", "a", above=0, most=1e-3)
    Traceback (most recent call last):
        ...
    vines.errors.StateError: tolerance is 'a'; give a finite number > 0 and <= 0.001
    """
    number = _number(value)
    if not (math.isfinite(number) and least <= number <= most and above < number < below):
        limits = [
            f"{sign} {limit:g}"
            for sign, limit in ((">", above), (">=", least), ("<", below), ("<=", most))
            if math.isfinite(limit)
        ]
        said = " and ".join(limits)
        raise error(f"{name} is {shown(value)}{unit}; give a finite number{' ' if said else ''}{said}")
    return number


def check_count(
    name: str, value: Any, *, least: int = 1, most: int | None = None, error: type[VinesError] = StateError
) -> int:
    """Return a whole number in its range, or say in one line what is allowed.

    Raises
    ------
    VinesError
        Of the class `error`, if it is not a whole number or out of range.

    Examples
    --------
    >>> check_count("max_impacts_per_period", float("inf"), most=1000)
    Traceback (most recent call last):
        ...
    vines.errors.StateError: max_impacts_per_period is inf; give an integer >= 1 and <= 1000
    """
    try:
        number = None if isinstance(value, bool) else operator.index(value)
    except TypeError:
        number = None
    if number is None or number < least or (most is not None and number > most):
        upper = f" and <= {most}" if most is not None else ""
        raise error(f"{name} is {shown(value)}; give an integer >= {least}{upper}")
    return number


def _number(value: Any) -> float:
    """Return a real number as a float, nan for anything that is none: text, bool, arrays, complex numbers."""
    if isinstance(value, bool | str | bytes | complex) or not hasattr(value, "__float__"):
        return math.nan
    if getattr(value, "ndim", 0):
        return math.nan
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return math.nan


def shown(value: Any) -> str:
    """Return a value as a message quotes it: in one line, and not pages of it."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:57]}..."


LONGEST_STEP = 0.5
"""Longest step of a coloured force, in units of 1/omega0: within it the force has two values."""


def check_hold(hold: int, Omega: float) -> None:
    """Refuse too few draws in a forcing period for a coloured force, of which two are a step.

    Raises
    ------
    ParameterError
        With the number that is enough.

    Examples
    --------
    >>> check_hold(8, 1.0)
    Traceback (most recent call last):
        ...
    vines.errors.ParameterError: hold is 8; with ou at Omega = 1 allowed is hold >= 26: two steps of the force may not \
last longer than 0.5, in units of 1/omega0
    """
    if 4.0 * math.pi / (Omega * hold) > LONGEST_STEP:
        raise ParameterError(
            f"hold is {hold}; with ou at Omega = {Omega:g} allowed is hold >= "
            f"{math.ceil(4.0 * math.pi / (Omega * LONGEST_STEP))}: two steps of the force may not last longer than "
            f"{LONGEST_STEP:g}, in units of 1/omega0"
        )


_NOT_SPLIT, _LEAST_SPLIT = ("phase_diffusion", "spread"), 16
"""What a splitting cannot do, and the fewest runs of it."""


def check_splitting(splitting: int, parts: Sequence[str], hold: int) -> None:
    """Refuse what a splitting cannot do; none has 0 runs.

    Raises
    ------
    ParameterError
        With what is allowed.

    Examples
    --------
    >>> check_splitting(8, ["noise"], 32)
    Traceback (most recent call last):
        ...
    vines.errors.ParameterError: splitting is 8, hold is 32; allowed is splitting >= 16 with an even hold
    """
    if splitting and (wrong := [name for name in parts if name in _NOT_SPLIT]):
        raise ParameterError(
            f"scatter has {', '.join(wrong)}, which splitting cannot do: it measures distances from one orbit, at one "
            "phase of the forcing; set splitting to 0"
        )
    if splitting and (splitting < _LEAST_SPLIT or hold % 2):
        raise ParameterError(
            f"splitting is {splitting}, hold is {hold}; allowed is splitting >= {_LEAST_SPLIT} with an even hold"
        )


def check_periods(name: str, periods: float, period: float = 2.0 * math.pi) -> None:
    """Refuse a point of years.

    Parameters
    ----------
    name : str
        What the periods are for.
    periods : float
        Forcing periods of one point.
    period : float
        The forcing period; one longer than that of the oscillator counts for as many as it holds.

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
    >>> check_periods("periods", 200, 2 * math.pi / 1e-6)
    Traceback (most recent call last):
        ...
    vines.errors.StateError: periods is 200, of 1e+06 periods of the oscillator each; allowed are 10000000 of these a \
point; VINES_LONG_POINTS=1 in the environment allows more
    """
    each = max(period / (2.0 * math.pi), 1.0)
    if periods * each <= MOST_PERIODS or os.environ.get(_ALLOWED_BY):
        return
    more = f"{_ALLOWED_BY}=1 in the environment allows more"
    if periods > MOST_PERIODS:
        raise StateError(f"{name} is {periods}, allowed is {name} <= {MOST_PERIODS} periods a point; {more}")
    raise StateError(
        f"{name} is {periods:g}, of {each:.3g} periods of the oscillator each; allowed are {MOST_PERIODS} of these a "
        f"point; {more}"
    )
