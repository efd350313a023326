"""Where a channel is clipped: at the end of its range, or flat at its largest or least value."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["clipped_samples", "flat_ends"]

_FULL = 0.9999
_FLAT = 3
_NEXT = 0.2
"""Samples one step below a flat top over those on it. A rounded parabola has sqrt(2) - 1 = .41 and more; one cut off
n steps below its top has sqrt(1 + 1/n) - 1, which is less from n = 2.3 on."""
_LEVELS = 65536
_FEW_LEVELS = 16
"""A channel that has so few levels, such as a digital line, stays at its ends and is not clipped."""


def clipped_samples(values: npt.NDArray[np.float64], limit: float) -> npt.NDArray[np.bool_]:
    """Return which samples are at the end of the range, or flat at the largest or least value.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Samples without NaN.
    limit : float
        Largest value that can be recorded, in their unit. Flat ends below a twentieth of it are not looked for.
    """
    return (np.abs(values) >= _FULL * limit) | flat_ends(values, 0.05 * limit)


def flat_ends(values: npt.NDArray[np.float64], least: float = 0.0) -> npt.NDArray[np.bool_]:
    """Return which samples lie in stretches of three and more at an end of the values that quantising can't explain.

    The top of a sine that was recorded with few bits is flat, too, but the signal stays long on the step below it.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Samples without NaN.
    least : float
        Ends of less magnitude are not looked at.

    Examples
    --------
    >>> sine = np.sin(np.arange(4000) / 100.0)
    >>> int(flat_ends(np.round(sine * 127)).sum()), int(flat_ends(np.round(np.clip(sine, -1, 0.9) * 127)).sum())
    (0, 651)
    """
    lost = np.zeros(len(values), bool)
    step = 0.0
    for sign in (1.0, -1.0):
        end = float(values.max() if sign > 0 else values.min())
        if abs(end) < least or len(values) < _FLAT or values.max() == values.min():
            continue
        edges = np.flatnonzero(np.diff(np.concatenate([[0], values == end, [0]])))
        first, past = edges[::2], edges[1::2]
        long = past - first >= _FLAT
        if not long.any():
            continue
        step = step or _step(values)
        if not step:
            return lost
        first, past = first[long], past[long]
        if _next(values, first, past, end, 1.5 * step) < _NEXT * float((past - first).sum()):
            for k, m in zip(first.tolist(), past.tolist(), strict=True):
                lost[k:m] = True
    return lost


def _step(values: npt.NDArray[np.float64]) -> float:
    """Return the step of the converter, the least difference of two values; 0 where there are few levels only."""
    levels = np.unique(values[:: max(1, len(values) // _LEVELS)])
    if len(levels) <= _FEW_LEVELS:
        levels = np.unique(values)
    if len(levels) <= _FEW_LEVELS:
        return 0.0
    steps = np.diff(levels)
    # Values that were scaled differ by rounding where they are one level.
    return float(steps[steps > 1e-9 * (levels[-1] - levels[0])].min())


def _next(
    values: npt.NDArray[np.float64], first: npt.NDArray[np.intp], past: npt.NDArray[np.intp], end: float, width: float
) -> int:
    """Return how many samples beside the stretches are within so much of the end, without a break."""
    near = np.abs(values - end) < width
    # Where the nearest sample that is not near lies, before and behind each.
    places = np.arange(len(values))
    before = np.maximum.accumulate(np.where(near, -1, places))
    behind = np.minimum.accumulate(np.where(near, len(values), places)[::-1])[::-1]
    return int((first - 1 - before[first]).sum() + (behind[past - 1] - past).sum())
