"""How well the contacts of a run repeat after p forcing periods."""

from __future__ import annotations

import numpy as np

from vines.dynamics.kernels import rows as col
from vines.kernels import linked_njit, njit
from vines.orbits.kernels import mark

__all__ = ["difference", "mirror_difference", "repetition"]

TOGETHER = 1e-9
"""Contacts that are nearer to each other in time than this, relative to a span, may change places by rounding."""


@linked_njit
def repetition(rows, kept, span):
    """Find how many contacts lie in one `span` of time, if their sides repeat after it.

    Nothing else is compared, so that a run without repetition is told with few looks at its rows.

    Parameters
    ----------
    kept : ndarray of int
        Rows that are contacts.
    span : float
        p forcing periods.

    Returns
    -------
    (lag, filled)
        Contacts in the span and whole repetitions that can be compared with the one before; (0, 0) if the sides do not
        repeat or there is not one.
    """
    n = kept.shape[0]
    if n < 2:
        return 0, 0
    target = rows[kept[0], col.TIME] + span
    # The contact nearest to the target, the later one of two.
    low, lag = 1, n - 1
    while low < lag:
        middle = (low + lag) // 2
        if rows[kept[middle], col.TIME] < target:
            low = middle + 1
        else:
            lag = middle
    if lag > 1 and target - rows[kept[lag - 1], col.TIME] < abs(rows[kept[lag], col.TIME] - target):
        lag -= 1
    filled = _filled(rows, kept, lag)
    if filled == 0 and rows.shape[1] > col.ROW:
        # Balls that hit together have contacts at one time, of which rounding says which is nearest.
        there = rows[kept[lag], col.TIME]
        for other in range(1, n):
            if other != lag and abs(rows[kept[other], col.TIME] - there) < TOGETHER * span:
                filled = _filled(rows, kept, other)
                if filled > 0:
                    return other, filled
    return (lag, filled) if filled > 0 else (0, 0)


@njit
def _filled(rows, kept, lag):
    """Return how many repetitions of so many contacts there are whose sides are those of the one before, else 0."""
    pairs = kept.shape[0] - lag
    filled = pairs // lag
    for i in range(pairs - filled * lag, pairs):
        if mark(rows, kept[i]) != mark(rows, kept[i + lag]):
            return 0
    return filled


@linked_njit
def difference(rows, kept, lag, span, scale, age):
    """Return the largest difference of the contacts of one repetition to those one `span` of time before.

    Parameters
    ----------
    lag : int
        Contacts in the span, as `repetition` gives it.
    scale : float
        Size of velocities; differences of x1, v1, v2 are divided by it, those of time are taken as they are.
    age : int
        Which repetition: 0 the newest, which ends with the last contact, 1 the one before it, and so on.
    """
    worst = 0.0
    end = kept.shape[0] - age * lag
    for k in range(end - lag, end):
        i, j = kept[k - lag], kept[k]
        worst = max(
            worst,
            abs(rows[j, col.TIME] - rows[i, col.TIME] - span),
            abs(rows[j, col.V1] - rows[i, col.V1]) / scale,
            abs(rows[j, col.V2] - rows[i, col.V2]) / scale,
            abs(rows[j, col.X1] - rows[i, col.X1]) / scale,
        )
    return worst


@linked_njit
def mirror_difference(rows, kept, lag, span, scale):
    """Return how far the last repetition is from its own mirror image (x, t) -> (-x, t + half the span)."""
    if lag % 2 == 1 or kept.shape[0] < lag + lag // 2:
        return np.inf
    half = lag // 2
    n = kept.shape[0]
    worst = 0.0
    for k in range(lag):
        i = kept[n - 1 - k - half]
        j = kept[n - 1 - k]
        if mark(rows, i) != -mark(rows, j):
            return np.inf
        worst = max(worst, abs(rows[j, col.TIME] - rows[i, col.TIME] - 0.5 * span))
        worst = max(worst, abs(rows[j, col.V1] + rows[i, col.V1]) / scale)
        worst = max(worst, abs(rows[j, col.V2] + rows[i, col.V2]) / scale)
        worst = max(worst, abs(rows[j, col.X1] + rows[i, col.X1]) / scale)
    return worst
