"""Standard uncertainties: block bootstrap over forcing periods, and what calibrations leave (GUM Type A and B)."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from scipy.special import stdtrit

from vines.rig.recording import Uncertain

__all__ = [
    "block_length",
    "block_variance",
    "combined",
    "error_ratio",
    "mean_over_periods",
    "robust_deviation",
    "standard_error",
]

Floats = npt.NDArray[np.float64]

_NORMAL = 1.959964
"""Half width of a 95 % interval of a normal distribution."""


def block_length(series: Floats) -> int:
    """Return a length of blocks for an interval about the mean of a series.

    Parameters
    ----------
    series : ndarray, shape (n,)

    Notes
    -----
    Twice the length at which the circular block bootstrap estimates the variance best (Politis and White 2004, with the
    correction of Patton, Politis and White 2009): blocks of that length leave out part of what neighbours share, which
    harms an interval more than the noise of longer blocks does. At most a quarter of the series.

    Examples
    --------
    >>> noise = np.random.default_rng(1).normal(size=500)
    >>> block_length(np.convolve(noise, np.ones(8))) > 2 * block_length(noise)
    True
    """
    n = len(series)
    away = series - series.mean()
    runs = max(5, math.ceil(math.log10(n)))
    most = math.ceil(math.sqrt(n)) + runs
    spectrum = np.fft.rfft(away, 2 * n)
    shared = np.fft.irfft(np.abs(spectrum) ** 2)[: most + runs + 1] / n
    if not shared[0] > 1e-24 * float(np.max(np.abs(series))) ** 2:
        return 1
    quiet = np.abs(shared[1:]) < 2 * math.sqrt(math.log10(n) / n) * shared[0]
    last = next((k for k in range(most) if quiet[k : k + runs].all()), most)
    lags = np.arange(1, min(2 * max(last, 1), most, n - 1) + 1)
    # The flat-top window of Politis and Romano.
    window = np.minimum(1.0, 2 * (1 - lags / lags[-1])) if len(lags) > 1 else np.ones(1)
    bias = 2 * float(np.sum(window * lags * shared[lags]))
    variance = float(shared[0] + 2 * np.sum(window * shared[lags]))
    best = (1.5 * (bias / variance) ** 2 * n) ** (1 / 3) if variance > 0 else math.inf
    return max(1, min(2 * math.ceil(min(best, n)), n // 4))


def block_variance(away: Floats, length: int) -> float:
    """Return the variance of the mean of a series by the circular block bootstrap, as of infinitely many draws.

    Parameters
    ----------
    away : ndarray, shape (n,)
        The series less its mean.
    length : int
        Of the blocks, less than n: n/l of them, each drawn from all circular ones.
    """
    n = len(away)
    total = np.concatenate([[0.0], np.cumsum(np.concatenate([away, away[:length]]))])
    blocks = total[length : length + n] - total[:n]
    return float(np.mean(blocks**2)) / (length * n * (1 - length / n))


def standard_error(series: Floats) -> float:
    """Return the standard uncertainty of the mean of a series by the circular block bootstrap.

    Parameters
    ----------
    series : ndarray, shape (n,)
        One value a period.

    Notes
    -----
    In closed form, see :func:`block_variance`. Where blocks are few it is widened by Student's factor, so that 1.96
    standard uncertainties are an interval of 95 % (the variance of overlapping blocks has about 1.5 n/l degrees of
    freedom).

    Examples
    --------
    >>> round(standard_error(np.random.default_rng(1).normal(size=10_000)), 3)
    0.01
    """
    n, length = len(series), block_length(series)
    variance = block_variance(series - series.mean(), length)
    return math.sqrt(variance) * float(stdtrit(max(1.5 * n / length, 2.0), 0.975)) / _NORMAL


def mean_over_periods(
    values: Floats, period: npt.NDArray[np.int64], periods: int, size: Floats | None = None
) -> Uncertain:
    """Return the mean of values that belong to periods, with the standard uncertainty of the block bootstrap.

    Parameters
    ----------
    values : ndarray, shape (n,)
    period : ndarray of int, shape (n,)
        Period of each, from 0.
    periods : int
        Their number.
    size : ndarray, shape (n,), optional
        By which each value counts; all alike if left out.
    """
    size = np.ones(len(values)) if size is None else size
    mean = float(np.average(values, weights=size))
    # A period adds so much to the sum beside what it would add at the mean.
    away = np.bincount(period, (values - mean) * size, periods).astype(np.float64)
    return Uncertain(mean, standard_error(away) * periods / float(np.sum(size)))


def robust_deviation(distances: Floats) -> float:
    """Return the standard deviation of normal values from distances to the middle, whatever a few wild ones are.

    Examples
    --------
    >>> round(robust_deviation(np.append(np.random.default_rng(1).normal(size=9999), 1e9)), 2)
    1.0
    """
    return float(np.median(np.abs(distances)) / 0.6745)


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
