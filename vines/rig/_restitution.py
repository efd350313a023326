"""Mean restitution, its dependence on speed, and its scatter freed from measurement noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize_scalar

__all__ = ["Restitution", "restitution"]

Floats = npt.NDArray[np.float64]

_VARIED = 0.05
"""Least standard deviation of log speed at which an exponent is sought."""

_UNEVEN = 3e-3
"""Standard uncertainty of the restitution of slow impacts against that of fast ones, by the sensor's linearity."""


@dataclass(frozen=True, slots=True)
class Restitution:
    """r_k = r (|w'_k|/speed)^exponent + sigma_r g_k + noise of the measurement.

    Attributes
    ----------
    r : float
        Mean of the impacts.
    exponent, u_exponent : float
        Of the power of the speed before impact; 0 ± inf where the speeds differ by less than a tenth.
    sigma_r, u_sigma_r : float
        Standard deviation of the scatter, with the noise of each r_k taken off.
    speed : float
        Mean of |w'| before impact [m/s].
    n : int
        Impacts used.
    """

    r: float
    exponent: float
    u_exponent: float
    sigma_r: float
    u_sigma_r: float
    speed: float
    n: int


def restitution(r: Floats, u: Floats, speed: Floats, side: Floats) -> Restitution:
    """Estimate mean, exponent and scatter of the restitution by maximum likelihood.

    Parameters
    ----------
    r, u : ndarray, shape (n,)
        Restitution of each impact and the standard uncertainty of the measurement.
    speed : ndarray, shape (n,)
        |w'| before impact [m/s].
    side : ndarray, shape (n,)
        +1 L, -1 R.

    Notes
    -----
    For the scatter, r may depend on side and speed in any smooth way: what a sensor that is not quite linear does to
    slow and fast impacts, left and right ones, is no scatter. The exponent takes r to depend on speed alone, and its
    uncertainty allows for a difference of `_UNEVEN` over the range of speeds.

    Examples
    --------
    >>> rng = np.random.default_rng(4)
    >>> u, side = np.full(4000, 0.01), np.where(np.arange(4000) % 2, 1.0, -1.0)
    >>> found = restitution(0.65 + 0.02 * rng.normal(size=4000) + u * rng.normal(size=4000), u, np.ones(4000), side)
    >>> round(found.r, 2), round(found.sigma_r, 3)
    (0.65, 0.02)
    """
    x = np.log(speed / speed.mean())
    spread = float(np.std(x))
    varied = spread > _VARIED and len(r) > 20
    line = np.stack([np.ones_like(x), x]) if varied else np.ones((1, len(r)))
    columns = np.vstack([line, *([x**2] if varied else []), *([side] if abs(np.mean(side)) < 1 else [])])
    # Orthonormal, so that columns that say the same count once.
    left, sizes, _ = np.linalg.svd(columns.T, full_matrices=False)
    basis = left[:, sizes > 1e-6 * sizes[0]].T

    def cost(log_sigma: float) -> float:
        variance = np.exp(2 * log_sigma) + u**2
        weighted = basis / variance
        normal = weighted @ basis.T
        rest = r - np.linalg.solve(normal, weighted @ r) @ basis
        # The determinant of the normal matrix makes it restricted likelihood: no bias from the fitted means.
        return 0.5 * float(np.sum(np.log(variance) + rest**2 / variance)) + 0.5 * float(np.linalg.slogdet(normal)[1])

    best: Any = minimize_scalar(cost, bounds=(np.log(1e-5), np.log(0.5)), method="bounded")
    at = float(best.x)
    bend = (cost(at + 0.05) - 2 * cost(at) + cost(at - 0.05)) / 0.05**2
    sigma = float(np.exp(at))
    u_sigma = sigma / np.sqrt(bend) if bend > 0 else sigma
    exponent, u_exponent = 0.0, float("inf")
    if varied:
        weighted = line / (sigma**2 + u**2)
        normal = weighted @ line.T
        mean, slope = np.linalg.solve(normal, weighted @ r)
        exponent = float(slope / mean)
        u_exponent = float(np.hypot(np.sqrt(np.linalg.inv(normal)[1, 1]), _UNEVEN / spread) / abs(mean))
    return Restitution(float(np.mean(r)), exponent, u_exponent, sigma, float(u_sigma), float(speed.mean()), len(r))
