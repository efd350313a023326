"""The contacts of a run, a complete chatter being one, and how well they repeat after p forcing periods."""

from __future__ import annotations

import numpy as np

from vines.dynamics.kernels import rows as col
from vines.kernels import integer_vector, linked_njit, njit

__all__ = ["STUCK", "completes", "contacts", "difference", "mark", "mirror_difference", "repetition"]

STUCK = 64
"""Added to the size of a `mark` where the contact is a complete chatter."""


@njit
def mark(rows, i):
    """Return the wall of a contact, times the number of the ball where there are several; 0 of a stop."""
    if rows[i, col.KIND] == col.STOP:
        return 0
    side = 1 if rows[i, col.SIDE] > 0.0 else -1
    return side * int(rows[i, col.ROW]) if rows.shape[1] > col.ROW else side


@njit
def completes(rows, n, i):
    """Say whether the impacts of a ball on a wall that begin with row i end in sticking."""
    balls = rows.shape[1] > col.ROW
    for j in range(i + 1, n):
        if balls and rows[j, col.ROW] != rows[i, col.ROW]:
            continue
        if rows[j, col.KIND] == col.STICK:
            return True
        if rows[j, col.KIND] in (col.IMPACT, col.STOP) and mark(rows, j) != mark(rows, i):
            return False
    return False


@linked_njit
def contacts(rows, n, start):
    """Return the rows that count as contacts after `start`: stops and impacts, of a complete chatter the first alone.

    A run of impacts on one wall that goes on at the end may be a chatter not yet complete, and one that began before
    `start` may have its first impact there: neither gives more than it is sure of.
    """
    keep = integer_vector(n)
    count = 0
    for i in range(1, n):
        kind = rows[i, col.KIND]
        if kind in (col.IMPACT, col.STOP) and rows[i, col.TIME] > start:
            keep[count] = i
            count += 1
        elif kind == col.STICK and rows.shape[1] > col.ROW:
            count = _without_chatter(rows, keep, count, i)
        elif kind == col.STICK:
            run = int(rows[i, col.RUN])
            while count > 0 and run > 0 and keep[count - 1] >= i - run:
                count -= 1
            if run > 0 and i - run > 0 and rows[i - run, col.TIME] > start:
                keep[count] = i - run
                count += 1
    while count > 1 and _same_run(rows, keep[count - 2], keep[count - 1]):
        count -= 1
    return keep[:count]


@njit
def _without_chatter(rows, keep, count, i):
    """Take the impacts of a chatter but the first from the contacts so far, where those of other balls lie between."""
    run = int(rows[i, col.RUN])
    own = 0
    for k in range(count - 1, -1, -1):
        if own == run:
            break
        if rows[keep[k], col.ROW] == rows[i, col.ROW]:
            own += 1
            if own < run:
                for m in range(k, count - 1):
                    keep[m] = keep[m + 1]
                count -= 1
    return count


@njit
def _same_run(rows, i, j):
    """Say whether rows i and j are neighbouring impacts on the same wall, with no other event between."""
    near = j == i + 1 or (j == i + 2 and rows[i + 1, col.KIND] == col.SLIDE)
    return near and mark(rows, i) == mark(rows, j) != 0


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
    pairs = n - lag
    filled = pairs // lag
    for i in range(pairs - filled * lag, pairs):
        if mark(rows, kept[i]) != mark(rows, kept[i + lag]):
            return 0, 0
    return (lag, filled) if filled > 0 else (0, 0)


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
