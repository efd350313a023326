"""Thinning of a fast signal so that its shocks stay in sight."""

from __future__ import annotations

import numpy as np

__all__ = ["extremes"]


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
