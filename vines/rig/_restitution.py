"""Mean restitution, its dependence on speed, and its scatter freed from measurement noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize_scalar

__all__ = ["Restitution", "restitution"]

Floats = npt.NDArray[np.float64]


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


def restitution(r: Floats, u: Floats, speed: Floats) -> Restitution:
    """Estimate mean, exponent and scatter of the restitution by maximum likelihood.

    Parameters
    ----------
    r, u : ndarray, shape (n,)
        Restitution of each impact and the standard uncertainty of the measurement.
    speed : ndarray, shape (n,)
        |w'| before impact [m/s].

    Examples
    --------
    >>> rng = np.random.default_rng(4)
    >>> u = np.full(4000, 0.01)
    >>> found = restitution(0.65 + 0.02 * rng.normal(size=4000) + u * rng.normal(size=4000), u, np.ones(4000))
    >>> round(found.r, 2), round(found.sigma_r, 3)
    (0.65, 0.02)
    """
    x = np.log(speed / speed.mean())
    spread = float(np.std(x))
    columns = np.stack([np.ones_like(x), x]) if spread > 0.05 and len(r) > 20 else np.ones((1, len(r)))

    def fit(log_sigma: float) -> tuple[float, Floats, Floats]:
        variance = np.exp(2 * log_sigma) + u**2
        weighted = columns / variance
        normal = weighted @ columns.T
        linear = np.linalg.solve(normal, weighted @ r)
        left = r - linear @ columns
        # The determinant of the normal matrix makes it restricted likelihood: no bias from the fitted mean.
        cost = 0.5 * float(np.sum(np.log(variance) + left**2 / variance)) + 0.5 * float(np.linalg.slogdet(normal)[1])
        return cost, linear, normal

    best: Any = minimize_scalar(lambda v: fit(v)[0], bounds=(np.log(1e-5), np.log(0.5)), method="bounded")
    at = float(best.x)
    _, linear, normal = fit(at)
    bend = (fit(at + 0.05)[0] - 2 * fit(at)[0] + fit(at - 0.05)[0]) / 0.05**2
    sigma = float(np.exp(at))
    exponent, u_exponent = 0.0, float("inf")
    if len(linear) > 1:
        exponent = float(linear[1] / linear[0])
        u_exponent = float(np.sqrt(np.linalg.inv(normal)[1, 1]) / abs(linear[0]))
    u_sigma = sigma / np.sqrt(bend) if bend > 0 else sigma
    return Restitution(float(np.mean(r)), exponent, u_exponent, sigma, float(u_sigma), float(speed.mean()), len(r))
