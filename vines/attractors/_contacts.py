"""The contacts of a run, a complete chatter being one, and how well they repeat after p forcing periods."""

from __future__ import annotations

import numpy as np

from vines.dynamics._advance import IMPACT, KIND, RUN, SIDE, STICK, TIME, V1, V2, X1
from vines.kernels import integer_vector, linked_njit, njit

__all__ = ["contacts", "repetition"]


@linked_njit
def contacts(rows, n, start):
    """Return the rows that count as contacts after `start`: impacts, but of a complete chatter only the first.

    A run of impacts on one wall that goes on at the end may be a chatter not yet complete, and one that began before
    `start` may have its first impact there: neither gives more than it is sure of.
    """
    keep = integer_vector(n)
    count = 0
    for i in range(1, n):
        kind = rows[i, KIND]
        if kind == IMPACT and rows[i, TIME] > start:
            keep[count] = i
            count += 1
        elif kind == STICK:
            run = int(rows[i, RUN])
            while count > 0 and run > 0 and keep[count - 1] >= i - run:
                count -= 1
            if run > 0 and i - run > 0 and rows[i - run, TIME] > start:
                keep[count] = i - run
                count += 1
    while count > 1 and _same_run(rows, keep[count - 2], keep[count - 1]):
        count -= 1
    return keep[:count]


@njit
def _same_run(rows, i, j):
    """Say whether rows i and j are neighbouring impacts on the same wall, with no other event between."""
    return j == i + 1 and rows[i, SIDE] == rows[j, SIDE]


@linked_njit
def repetition(rows, kept, span, scale, blocks):
    """Compare the contacts with those one `span` of time later.

    Parameters
    ----------
    kept : ndarray of int
        Rows that are contacts.
    span : float
        p forcing periods.
    scale : float
        Size of velocities; differences of x1, v1, v2 are divided by it, those of time are taken as they are.
    blocks : ndarray
        Receives the largest difference in each whole repetition, from the first to the last.

    Returns
    -------
    (lag, filled)
        Contacts in the span and blocks filled; (0, 0) if the sides do not repeat or there is not one whole repetition.
    """
    n = kept.shape[0]
    if n < 2:
        return 0, 0
    target = rows[kept[0], TIME] + span
    lag = 1
    for i in range(1, n):
        if abs(rows[kept[i], TIME] - target) <= abs(rows[kept[lag], TIME] - target):
            lag = i
    pairs = n - lag
    filled = min(pairs // lag, blocks.shape[0])
    if filled < 1:
        return 0, 0
    # Counted from the end, so that the last block is the newest.
    for b in range(filled):
        worst = 0.0
        for k in range(lag):
            i = kept[pairs - 1 - (filled - 1 - b) * lag - k]
            j = kept[n - 1 - (filled - 1 - b) * lag - k]
            if rows[i, SIDE] != rows[j, SIDE]:
                return 0, 0
            difference = abs(rows[j, TIME] - rows[i, TIME] - span)
            difference = max(difference, abs(rows[j, V1] - rows[i, V1]) / scale)
            difference = max(difference, abs(rows[j, V2] - rows[i, V2]) / scale)
            difference = max(difference, abs(rows[j, X1] - rows[i, X1]) / scale)
            worst = max(worst, difference)
        blocks[b] = worst
    return lag, filled


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
        if rows[i, SIDE] != -rows[j, SIDE]:
            return np.inf
        worst = max(worst, abs(rows[j, TIME] - rows[i, TIME] - 0.5 * span))
        worst = max(worst, abs(rows[j, V1] + rows[i, V1]) / scale)
        worst = max(worst, abs(rows[j, V2] + rows[i, V2]) / scale)
        worst = max(worst, abs(rows[j, X1] + rows[i, X1]) / scale)
    return worst
