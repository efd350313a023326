"""Thinning of a fast signal so that its shocks stay in sight."""

from __future__ import annotations

import numpy as np

__all__ = ["Thinner", "extremes"]


def extremes(values: np.ndarray, group: int) -> np.ndarray:
    """Return the places of the samples that stand for groups: of each the one farthest from the mean of its group.

    Parameters
    ----------
    values : numpy.ndarray, shape (n,)
        Samples.
    group : int
        How many make a group; the last ones, that are fewer, are left out.

    Examples
    --------
    >>> extremes(np.array([0.0, 0.0, 5.0, 0.0, 1.0, 0.0, 0.0]), 3)
    array([2, 4])
    """
    if group <= 1:
        return np.arange(len(values))
    count = len(values) // group
    if not count:
        return np.arange(0)
    cut = values[: count * group].reshape(count, group)
    away = np.abs(cut - cut.mean(axis=1, keepdims=True))
    return np.arange(count) * group + away.argmax(axis=1)


class Thinner:
    """Thins a signal that comes in pieces as :func:`extremes` does one that is there as a whole.

    Parameters
    ----------
    group : int
        How many samples make a group.

    Examples
    --------
    >>> thinner = Thinner(3)
    >>> [thinner.add(k, np.array([float(k), 0.0]))[0].tolist() for k in (0, 2, 4)]
    [[], [2], [4]]
    """

    def __init__(self, group: int):
        self._group = max(1, group)
        self._first, self._rest = 0, np.empty(0)

    def add(self, first: int, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Add samples, given the number of the first; return numbers and values of those that are kept."""
        if first != self._first + len(self._rest):
            self._first, self._rest = first, np.empty(0)
        joined = np.concatenate([self._rest, values])
        kept = extremes(joined, self._group)
        begin, whole = self._first, len(joined) // self._group * self._group
        self._first, self._rest = begin + whole, joined[whole:].copy()
        return begin + kept, joined[kept]
