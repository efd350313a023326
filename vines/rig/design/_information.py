"""What measurements to come would tell: linear, with normal errors (Chaloner and Verdinelli 1995, Bayesian designs)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.errors import ParameterError

__all__ = ["Gain", "gain", "informed"]

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Gain:
    """What a design changes.

    Attributes
    ----------
    bits : float
        Expected information about the parameters of interest: half the logarithm to base 2 of the ratio of the
        determinants of their covariances (D-optimality).
    before, after : ndarray, shape (n,)
        Standard uncertainties of all parameters.
    """

    bits: float
    before: Floats
    after: Floats


def informed(covariance: Floats, slopes: Floats, noise: Floats, count: float = 1.0) -> Floats:
    """Return the covariance of parameters after measurements.

    Parameters
    ----------
    covariance : ndarray, shape (n, n)
        Before. Errors that all measurements share, such as calibrations, are parameters too: more of the same does not
        average them out.
    slopes : ndarray, shape (m, n)
        Derivatives of the m numbers of one measurement.
    noise : ndarray, shape (m, m)
        Covariance of their errors, which are new in every measurement.
    count : float
        How many measurements.

    Returns
    -------
    ndarray, shape (n, n)
        (P^-1 + count H^T R^-1 H)^-1, by the form that needs no inverse of P.

    Raises
    ------
    ParameterError
        If shapes do not fit or `count` is negative.

    Examples
    --------
    A length known to 2, measured four times to 2: both together tell it to 2/sqrt(5).

    >>> one = np.eye(1)
    >>> float(informed(4 * one, one, 4 * one, 4)[0, 0])
    0.8
    """
    n, m = len(covariance), len(slopes)
    if covariance.shape != (n, n) or slopes.shape != (m, n) or noise.shape != (m, m):
        raise ParameterError(
            f"shapes are {covariance.shape}, {slopes.shape}, {noise.shape}; allowed are (n, n), (m, n), (m, m)"
        )
    if count < 0:
        raise ParameterError(f"count is {count:g}, allowed is 0 and more")
    if count == 0 or m == 0:
        return covariance.copy()
    shared = slopes @ covariance
    taken = shared.T @ np.linalg.solve(shared @ slopes.T + noise / count, shared)
    found = covariance - taken
    return 0.5 * (found + found.T)


def gain(
    covariance: Floats,
    measurements: list[tuple[Floats, Floats]],
    interest: npt.NDArray[np.intp],
    count: float = 1.0,
) -> Gain:
    """Return what measurements would tell about the parameters of interest.

    Parameters
    ----------
    covariance : ndarray, shape (n, n)
    measurements : list of (slopes, noise)
        Of each kind of measurement, as for `informed`; all are made.
    interest : ndarray of int
        Places of the parameters that are asked for; the others are a nuisance.
    count : float
        How many of each.
    """
    after = covariance
    for slopes, noise in measurements:
        after = informed(after, slopes, noise, count)
    block = np.ix_(interest, interest)
    sizes = [float(np.linalg.slogdet(_scaled(one[block], covariance[block]))[1]) for one in (covariance, after)]
    deviation = [np.sqrt(np.maximum(np.diag(one), 0.0)) for one in (covariance, after)]
    return Gain(0.5 * (sizes[0] - sizes[1]) / float(np.log(2.0)), deviation[0], deviation[1])


def _scaled(one: Floats, by: Floats) -> Floats:
    """Return a covariance in units of the deviations of another, so that determinants do not depend on units."""
    size = np.sqrt(np.diag(by))
    return one / np.outer(size, size)
