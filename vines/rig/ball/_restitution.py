"""Restitution as a law of the speed, and its scatter freed from measurement noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize_scalar

from vines.rig.uncertainty import robust_deviation

__all__ = ["Restitution", "restitution"]

Floats = npt.NDArray[np.float64]

_VARIED = 0.05
"""Least standard deviation of log speed at which an exponent is sought."""

_TOLD = 2.0
"""Least standard deviation of log speed, relative to the noise, at which the scatter is freed from the speed's part."""

_UNEVEN = 2e-3
"""Standard uncertainty of the restitution of slow impacts against that of fast ones, by the sensor's linearity."""


@dataclass(frozen=True, slots=True)
class Restitution:
    """The law r_k = r (|w'_k|/speed)^exponent + sigma_r g_k, measured with noise.

    Attributes
    ----------
    r : float
        At the mean speed.
    exponent, u_exponent : float
        Of the power of the speed before impact; 0 ± inf where the speeds hardly differ.
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

    def at(self, speed: Floats) -> Floats:
        """Return the restitution without scatter at speeds [m/s], at most 1."""
        return np.minimum(self.r * (speed / self.speed) ** self.exponent, 1.0)


def restitution(r: Floats, u: Floats, speed: Floats, side: Floats) -> Restitution:
    """Fit the law of the restitution and its scatter by restricted maximum likelihood.

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
    >>> speed, side = np.exp(rng.normal(size=4000)), np.where(np.arange(4000) % 2, 1.0, -1.0)
    >>> u = 0.01 / speed
    >>> noisy = 0.65 * (speed / speed.mean()) ** -0.1 + 0.02 * rng.normal(size=4000) + u * rng.normal(size=4000)
    >>> found = restitution(noisy, u, speed, side)
    >>> round(found.r, 2), round(found.exponent, 2), round(found.sigma_r, 3)
    (0.65, -0.1, 0.02)
    """
    x = np.log(speed / speed.mean())
    spread = float(np.std(x))
    varied = spread > _VARIED and len(r) > 20
    # Of speeds that differ by less than they are measured to, a dependence would be that of their noise.
    told = len(r) > 20 and spread > _TOLD * float(np.sqrt(np.mean(u**2)) / abs(np.mean(r)))
    mean, exponent = float(np.median(r)), 0.0
    sigma = robust_deviation(r - mean) + 1e-3
    u_exponent, bend = float("inf"), 0.0
    for _ in range(4):
        # Gauss-Newton in the mean and the exponent, at the scatter found so far.
        law = mean * np.exp(exponent * x)
        line = np.stack([law / mean, law * x])[: 2 if varied else 1]
        weighted = line / (sigma**2 + u**2)
        covariance = np.linalg.inv(weighted @ line.T)
        change = covariance @ (weighted @ (r - law))
        mean += float(change[0])
        if varied:
            exponent += float(change[1])
            u_exponent = float(np.hypot(np.sqrt(covariance[1, 1]), _UNEVEN / spread / abs(mean)))
        law = mean * np.exp(exponent * x)
        sigma, bend = _scatter(r, u, [law, side, *([law * x, law * x**2, side * x] if told else [])])
    u_sigma = sigma / np.sqrt(bend) if bend > 0 else sigma
    return Restitution(mean, exponent, u_exponent, sigma, float(u_sigma), float(speed.mean()), len(r))


def _scatter(r: Floats, u: Floats, columns: list[Floats]) -> tuple[float, float]:
    """Return the standard deviation that is left beside some columns and noise, and the curvature in its logarithm."""
    # Orthonormal, so that columns that say the same count once.
    left, sizes, _ = np.linalg.svd(np.stack(columns, axis=1), full_matrices=False)
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
    return float(np.exp(at)), bend
