"""Levels of detail: of a long run, what a screen can show of the whole, and every state of a few stretches.

A curve is drawn in columns of pixels: of the states in one, only the least and the greatest are seen. So a long run is
cut into bins of as many states each, of which those stay where a curve has its least or its greatest value. Every
peak stays what it was. Around the first, the last and one chosen time all states stay, so that the motion is smooth.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

__all__ = ["Rows", "chosen_rows", "peaks"]

_STRETCH = 6_000
"""States of each of the stretches that are drawn in full."""


@dataclass(frozen=True)
class Rows:
    """Which states of a run are drawn.

    Attributes
    ----------
    chosen : numpy.ndarray of int64, shape (n,)
        Their places, in order.
    stretches : tuple of (int, int)
        First place and the one past the last, of each stretch in which no state is left out.
    count : int
        How many states there are.
    """

    chosen: np.ndarray
    stretches: tuple[tuple[int, int], ...]
    count: int

    @property
    def thinned(self) -> bool:
        """Whether states are left out."""
        return len(self.chosen) < self.count

    def parts(self) -> list[slice]:
        """Return the stretches as slices of the chosen states."""
        return [slice(*np.searchsorted(self.chosen, each).tolist()) for each in self.stretches]


def chosen_rows(t: np.ndarray, curves: Iterable[np.ndarray], at: float | None = None, *, most: int) -> Rows:
    """Choose the states of a run that are drawn.

    Parameters
    ----------
    t : numpy.ndarray, shape (n,)
        Times of the states, not falling.
    curves : iterable of numpy.ndarray, shape (n,)
        The curves whose peaks stay.
    at : float, optional
        A time around which all states stay, beside the first and the last; the middle if left out.
    most : int
        About how many states stay; all of them if there are no more.

    Returns
    -------
    Rows
        Those of a thinned run hold the first and the last state, all of the stretches, and of each bin the least and
        the greatest of each curve.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 100_000)
    >>> spike = np.where(np.arange(100_000) == 71_234, 9.0, np.sin(40.0 * t))
    >>> rows = chosen_rows(t, [spike], most=60_000)
    >>> rows.thinned, 71_234 in rows.chosen
    (True, True)
    """
    count = len(t)
    if count <= most:
        return Rows(np.arange(count), ((0, count),), count)
    length = min(_STRETCH, most // 6)
    middle = count // 2 if at is None else int(np.searchsorted(t, at))
    begin = min(max(middle - length // 2, 0), count - length)
    stretches = _joined([(0, length), (begin, begin + length), (count - length, count)])
    full = [np.arange(*each) for each in stretches]
    rest = most - sum(map(len, full))
    return Rows(np.unique(np.concatenate([*full, peaks(list(curves), rest)])), stretches, count)


def peaks(curves: list[np.ndarray], most: int) -> np.ndarray:
    """Return the places of the least and the greatest value of each curve in each of as many bins as `most` allows.

    Parameters
    ----------
    curves : list of numpy.ndarray, shape (n,)
        At least one, n > 0; what is not finite is passed over.
    most : int
        Bound of the number of places.

    Returns
    -------
    numpy.ndarray of int64, shape (m,)
        Places in order, without repetition; m ≤ most, but at least two a curve.
    """
    count = len(curves[0])
    bins = max(1, min(count, most // (2 * len(curves))))
    size = -(-count // bins)
    whole = count // size
    found: list[np.ndarray] = []
    for values in curves:
        for least, worst in ((np.argmin, np.inf), (np.argmax, -np.inf)):
            finite = np.where(np.isfinite(values), values, worst)
            body = finite[: whole * size].reshape(whole, size)
            found.append(least(body, axis=1) + np.arange(whole) * size)
            if whole * size < count:
                found.append(np.atleast_1d(whole * size + least(finite[whole * size :])))
    return np.unique(np.concatenate(found))


def _joined(stretches: list[tuple[int, int]]) -> tuple[tuple[int, int], ...]:
    """Return stretches in order, those that meet as one.

    Examples
    --------
    >>> _joined([(0, 10), (5, 15), (20, 30)])
    ((0, 15), (20, 30))
    """
    joined = [stretches[0]]
    for begin, end in sorted(stretches)[1:]:
        if begin <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        else:
            joined.append((begin, end))
    return tuple(joined)
