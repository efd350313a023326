"""Brent's method for the zero of a function between two points, step for step as scipy.optimize.root_scalar has it.

It gives the same bits. Loading scipy.optimize takes half a second of processor time, in every process that computes
anything of an orbit; a zero takes ten values of the function.
"""

from __future__ import annotations

import math
from collections.abc import Callable

__all__ = ["bracketed_root"]

_STEPS = 100


def bracketed_root(function: Callable[[float], float], a: float, b: float, *, xtol: float, rtol: float) -> float:
    """Return where a function vanishes between two points at which its signs differ, or where it first is nan.

    Parameters
    ----------
    function : callable
        The function.
    a, b : float
        The two points.
    xtol, rtol : float
        Absolute and relative tolerance of the result.

    Raises
    ------
    ValueError
        If the signs do not differ.

    Examples
    --------
    >>> bracketed_root(lambda x: x * x - 2, 0.0, 2.0, xtol=1e-15, rtol=1e-14) ** 2
    2.0000000000000004
    """
    before, here = a, b
    f_before = float(function(before))
    if math.isnan(f_before):
        return before
    f_here = float(function(here))
    if f_before == 0:
        return before
    if f_here == 0 or math.isnan(f_here):
        return here
    if _negative(f_before) == _negative(f_here):
        raise ValueError(f"f({a}) = {f_before} and f({b}) = {f_here} must have different signs")
    across = f_across = step_before = step = 0.0
    for _ in range(_STEPS):
        if f_before != 0 and f_here != 0 and _negative(f_before) != _negative(f_here):
            across, f_across = before, f_before
            step_before = step = here - before
        if abs(f_across) < abs(f_here):
            before, here, across = here, across, here
            f_before, f_here, f_across = f_here, f_across, f_here
        least = (xtol + rtol * abs(here)) / 2
        half = (across - here) / 2
        if f_here == 0 or abs(half) < least:
            return here
        step_before, step = _next_step(
            (before, f_before), (here, f_here), (across, f_across), step_before, step, half, least
        )
        before, f_before = here, f_here
        here += step if abs(step) > least else math.copysign(least, half if half > 0 else -1.0)
        f_here = float(function(here))
        if math.isnan(f_here):
            return here
    return here


def _next_step(
    before: tuple[float, float],
    here: tuple[float, float],
    across: tuple[float, float],
    step_before: float,
    step: float,
    half: float,
    least: float,
) -> tuple[float, float]:
    """Return the last step and the next: by a line or a parabola if that converges, else to the middle."""
    (x0, f0), (x1, f1), (x2, f2) = before, here, across
    if abs(step_before) > least and abs(f1) < abs(f0):
        if x0 == x2:
            trial = -f1 * (x1 - x0) / (f1 - f0)
        else:
            slope_0, slope_2 = (f0 - f1) / (x0 - x1), (f2 - f1) / (x2 - x1)
            curved = slope_2 * slope_0 * (f2 - f0)
            trial = -f1 * (f2 * slope_2 - f0 * slope_0) / curved if curved else math.inf
        if 2 * abs(trial) < min(abs(step_before), 3 * abs(half) - least):
            return step, trial
    return half, half


def _negative(value: float) -> bool:
    return math.copysign(1.0, value) < 0
