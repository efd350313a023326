"""Standard uncertainties: block bootstrap over forcing periods, and what calibrations leave (GUM Type A and B)."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from vines.rig._recording import Uncertain

__all__ = ["combined", "error_ratio", "mean_over_periods", "period_weights"]

Floats = npt.NDArray[np.float64]


def period_weights(periods: int, *, draws: int = 400, seed: int = 0) -> Floats:
    """Return how often each period occurs in each draw of a circular block bootstrap, shape (draws, periods).

    Blocks of about sqrt(periods) neighbours keep what one period leaves to the next (Politis & Romano 1992).

    Examples
    --------
    >>> period_weights(100, draws=3).sum(axis=1)
    array([100., 100., 100.])
    """
    length = max(1, math.isqrt(periods))
    blocks = -(-periods // length)
    first = np.random.default_rng(seed).integers(0, periods, size=(draws, blocks))
    index = (first[:, :, None] + np.arange(length)).reshape(draws, -1)[:, :periods] % periods
    weights = np.zeros((draws, periods))
    np.add.at(weights, (np.arange(draws)[:, None], index), 1.0)
    return weights


def mean_over_periods(
    values: Floats, period: npt.NDArray[np.int64], weights: Floats, size: Floats | None = None
) -> Uncertain:
    """Return the mean of values that belong to periods, with the bootstrap's standard uncertainty.

    Parameters
    ----------
    values : ndarray, shape (n,)
    period : ndarray of int, shape (n,)
        Period of each, from 0.
    weights : ndarray, shape (draws, periods)
        From `period_weights`.
    size : ndarray, shape (n,), optional
        By which each value counts; all alike if left out.
    """
    count = weights.shape[1]
    size = np.ones(len(values)) if size is None else size
    sums, counts = np.bincount(period, values * size, count), np.bincount(period, size, count)
    total = weights @ counts
    means = (weights @ sums)[total > 0] / total[total > 0]
    blocks = max(2, count // max(1, math.isqrt(count)))
    return Uncertain(float(np.average(values, weights=size)), float(np.std(means)) * math.sqrt(blocks / (blocks - 1)))


def combined(value: float, *parts: float) -> Uncertain:
    """Return a value with the root of the sum of squares of its uncertainties.

    Examples
    --------
    >>> combined(1.0, 0.3, 0.4)
    Uncertain(value=1.0, u=0.5)
    """
    return Uncertain(float(value), math.sqrt(math.fsum(part * part for part in parts)))


def error_ratio(measured: Uncertain, model: Uncertain) -> float:
    """Return E_n = |measured - model|/(2 sqrt(u_measured^2 + u_model^2)); at most 1 means agreement.

    Examples
    --------
    >>> error_ratio(Uncertain(1.0, 0.03), Uncertain(1.1, 0.04))
    1.0
    """
    spread = 2 * math.hypot(measured.u, model.u)
    gap = abs(measured.value - model.value)
    return round(gap / spread, 12) if spread > 0 else (0.0 if gap == 0 else math.inf)
