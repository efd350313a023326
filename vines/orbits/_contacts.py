"""The contacts of a run, a complete chatter being one."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import rows as col
from vines.kernels import integer_vector, linked_njit, njit

__all__ = ["STUCK", "completes", "contacts", "mark", "slowest_followed"]

STUCK = 64
"""Added to the size of a `mark` where the contact is a complete chatter."""

_RESOLVED = 1e-4
"""Speed of an impact beside which one before it counts as slow: the last ones of a chatter are in order to rounding."""


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

    Of several balls one that is kicked off its wall by another and comes to ride there again goes on with its contact.
    """
    keep = integer_vector(n)
    count = 0
    sticks = False
    for i in range(1, n):
        kind = rows[i, col.KIND]
        if kind in (col.IMPACT, col.STOP) and rows[i, col.TIME] > start:
            keep[count] = i
            count += 1
        elif kind == col.STICK and rows.shape[1] > col.ROW:
            count = _without_chatter(rows, keep, count, i)
            sticks = True
        elif kind == col.STICK:
            run = int(rows[i, col.RUN])
            first = _begins(rows, i, run)
            while count > 0 and run > 0 and keep[count - 1] >= first:
                count -= 1
            if run > 0 and first > 0 and rows[first, col.TIME] > start:
                keep[count] = first
                count += 1
    while count > 1 and _same_run(rows, keep[count - 2], keep[count - 1]):
        count -= 1
    if sticks:
        count = _without_what_goes_on(rows, n, keep, count)
    return keep[:count]


@njit
def _without_chatter(rows, keep, count, i):
    """Take the impacts of a chatter but the first from the contacts so far, where those of other balls lie between.

    If the ball had come to ride already and was kicked off, the first one goes, too.
    """
    run = int(rows[i, col.RUN])
    left = run - 1
    for j in range(i - 1, 0, -1):
        if rows[j, col.ROW] == rows[i, col.ROW] and _ends(rows, j, rows[i, col.SIDE]):
            left = run if _rode(rows, j, rows[i, col.SIDE]) else left
            break
    own = 0
    for k in range(count - 1, -1, -1):
        if own == run:
            break
        if rows[keep[k], col.ROW] == rows[i, col.ROW]:
            own += 1
            if own <= left:
                for m in range(k, count - 1):
                    keep[m] = keep[m + 1]
                count -= 1
    return count


@njit
def _begins(rows, i, run):
    """Return the row at which the chatter of so many events before row i begins.

    Flights may be begun afresh in it, and a ball with friction may turn more than once between two impacts, which
    count once.
    """
    turned = False
    while run > 0 and i > 0:
        i -= 1
        kind = rows[i, col.KIND]
        if kind == col.START or (kind == col.SLIDE and turned):
            continue
        turned = kind == col.SLIDE
        run -= 1
    return i


@njit
def _same_run(rows, i, j):
    """Say whether rows i and j are neighbouring impacts on the same wall, with no other event than turns between."""
    for k in range(i + 1, j):
        if rows[k, col.KIND] != col.SLIDE and rows[k, col.KIND] != col.START:
            return False
    return mark(rows, i) == mark(rows, j) != 0


@njit
def _ends(rows, j, side):
    """Say whether what a ball does on a wall begins behind a row: a merge, a release but no kick, another wall."""
    kind = rows[j, col.KIND]
    let_go = kind == col.RELEASE and rows[j, col.V1] == rows[j, col.V2]
    return kind == col.STICK or let_go or (kind == col.IMPACT and rows[j, col.SIDE] != side)


@njit
def _rode(rows, j, side):
    """Say whether a ball came to ride on a wall at a row."""
    return rows[j, col.KIND] == col.STICK and rows[j, col.SIDE] == side


@njit
def _without_what_goes_on(rows, n, keep, count):
    """Leave out contacts at the end that may belong to a chatter that goes on, and those after them."""
    for ball in range(1, (rows.shape[1] - col.ROW - 3) // 2 + 1):
        first, own, side, merged = 0, 0, 0.0, False
        for j in range(n - 1, 0, -1):
            kind = rows[j, col.KIND]
            if rows[j, col.ROW] != ball or kind in (col.START, col.END):
                continue
            if own == 0:
                side = rows[j, col.SIDE]
            if _ends(rows, j, side):
                merged = _rode(rows, j, side)
                break
            if kind == col.IMPACT:
                first, own = j, own + 1
        if own > 0 and (merged or own > 1):
            while count > 0 and (keep[count - 1] > first or (merged and keep[count - 1] == first)):
                count -= 1
    return count


def slowest_followed(hits: npt.NDArray[np.float64]) -> float:
    """Return the least speed of an impact of a chatter that a faster one follows, inf if there is none."""
    fastest, slowest = 0.0, math.inf
    for speed in np.abs(hits[::-1, col.V1] - hits[::-1, col.V2]).tolist():
        if speed < fastest and fastest > _RESOLVED:
            slowest = min(slowest, speed)
        fastest = max(fastest, speed)
    return slowest
