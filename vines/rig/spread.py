"""The scatter of measurements of which some are far off."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["spread_about"]

_NORMAL = 1.4826022185056018
"""Standard deviation of a normal distribution over its median absolute deviation, 1 over the quantile of 3/4."""


def spread_about(middle: float, values: npt.NDArray[np.float64]) -> float:
    """Return the standard deviation about a middle by the median of the distances, which sparse outliers do not reach.

    Parameters
    ----------
    middle : float
        What the values scatter about.
    values : ndarray, shape (n,)
        At least one.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> values = np.append(rng.normal(2.0, 0.1, 1000), [50.0, -30.0])
    >>> round(spread_about(2.0, values), 2)
    0.1
    """
    return _NORMAL * float(np.median(np.abs(values - middle)))
