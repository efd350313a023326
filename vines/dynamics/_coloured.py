"""The exact transition of an oscillator under an Ornstein-Uhlenbeck force, and held forces that make the same of it."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

__all__ = ["held_halves", "transition"]

Floats = npt.NDArray[np.float64]

_SHORT = 0.25
"""Longest share of the shortest time of a motion that is not doubled."""


def transition(lam: float, step: float, time: float) -> tuple[Floats, Floats]:
    """Return how (x/step^2, v/step, force) goes on over a step: the mean's matrix and the covariance that is added.

    The force is stationary with variance 1 and covariance exp(-|t|/time), x'' + lam x' + x = force. In these units no
    entry is small, however short the step.

    Examples
    --------
    >>> mean, added = transition(0.01, 0.2, 3.0)
    >>> bool(abs(added[2, 2] + mean[2, 2] ** 2 - 1) < 1e-15)
    True
    """
    from scipy.linalg import expm

    drift = np.array([[0.0, 1.0, 0.0], [-step * step, -lam * step, 1.0], [0.0, 0.0, -step / time]])
    push = np.zeros((3, 3))
    push[2, 2] = 2.0 * step / time
    doublings = max(0, math.ceil(math.log2(max(float(np.abs(drift).max()), 1.0) / _SHORT)))
    share = 0.5**doublings
    # Van Loan (1978): the covariance from one exponential; over longer times it is added up, which loses no digits.
    block = expm(np.block([[-drift, push], [np.zeros((3, 3)), drift.T]]) * share)
    mean = block[3:, 3:].T
    added = mean @ block[:3, 3:]
    for _ in range(doublings):
        added = added + mean @ added @ mean.T
        mean = mean @ mean
    return np.asarray(mean, dtype=np.float64), np.asarray(0.5 * (added + added.T), dtype=np.float64)


def held_halves(lam: float, step: float, time: float) -> tuple[float, ...]:
    """Return what two held forces, one for each half of a step, are, so that the step ends as under the coloured force.

    Given the coloured force at both ends, y0 and y1, they are ``a = p11 y0 + p12 y1 + l11 g`` and
    ``b = p21 y0 + p22 y1 + l21 g + l22 h`` with normal g, h: position and velocity then have the exact joint law.

    Parameters
    ----------
    lam : float
        Damping of the oscillator.
    step : float
        Length of the step.
    time : float
        Correlation time; the variance is 1.

    Returns
    -------
    tuple of float
        p11, p12, p21, p22, l11, l21, l22.

    Examples
    --------
    >>> p11, p12, p21, p22, *_ = held_halves(0.01, 0.1, 1e5)
    >>> abs(p11 + p12 - 1) < 1e-5, abs(p21 + p22 - 1) < 1e-5
    (True, True)
    """
    mean, added = transition(lam, step, time)
    gain = added[:2, 2] / added[2, 2]
    ends = np.stack([mean[:2, 2] - gain * mean[2, 2], gain], axis=1)
    rest = added[:2, :2] - np.outer(gain, added[2, :2])
    half = _of_held(lam, step)
    back = np.linalg.inv(half)
    shares, factor = back @ ends, np.linalg.cholesky(back @ rest @ back.T)
    return (*shares.ravel().tolist(), float(factor[0, 0]), float(factor[1, 0]), float(factor[1, 1]))


def _of_held(lam: float, step: float) -> Floats:
    """Return what forces of size 1 in the first and in the second half of a step add to (x/step^2, v/step)."""
    from scipy.linalg import expm

    drift = np.array([[0.0, 1.0, 0.0], [-step * step, -lam * step, 1.0], [0.0, 0.0, 0.0]])
    flow = expm(0.5 * drift)
    second = flow[:2, 2]
    return np.asarray(np.stack([flow[:2, :2] @ second, second], axis=1), dtype=np.float64)
