"""Random numbers as a function of (seed, stream, counter): no state, so no order of drawing can matter."""

from __future__ import annotations

import math

import numpy as np

from vines.kernels import njit

__all__ = ["normal", "uniform"]


@njit
def _mix(z):
    """SplitMix64's finaliser (Steele, Lea & Flood 2014): every bit of the result depends on every bit given."""
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@njit
def uniform(seed, stream, counter):
    """Return a number in (0, 1), the same for the same three integers.

    Examples
    --------
    >>> uniform(1, 2, 3) == uniform(1, 2, 3), uniform(1, 2, 3) == uniform(1, 2, 4)
    (True, False)
    """
    golden = np.uint64(0x9E3779B97F4A7C15)
    z = _mix(np.uint64(seed) + golden)
    z = _mix(z ^ (np.uint64(stream) * golden + golden))
    z = _mix(z ^ (np.uint64(counter) * golden + golden))
    return (float(z >> np.uint64(11)) + 0.5) * (1.0 / 9007199254740992.0)


@njit
def normal(seed, stream, counter):
    """Return a standard normal number, by Box and Muller from two uniform ones."""
    u = uniform(seed, stream, 2 * counter)
    v = uniform(seed, stream, 2 * counter + 1)
    return math.sqrt(-2.0 * math.log(u)) * math.cos(2.0 * math.pi * v)
