"""Random numbers as a function of (seed, stream, counter): no state, so no order of drawing can matter."""

from __future__ import annotations

import math

import numpy as np

from vines.dynamics._sincos import sincos
from vines.kernels import loop_njit, njit

__all__ = ["fill_normals", "normal", "uniform"]

LN2_HIGH, LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
ROOT_HALF = 0x3FE6A09E667F3BCD
"""Bits of the double next to the root of 1/2."""


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
    # As a signed integer, which processors turn into a double at once.
    return (float(np.int64(z >> np.uint64(11))) + 0.5) * (1.0 / 9007199254740992.0)


@njit
def normal(seed, stream, counter):
    """Return a standard normal number, by Box and Muller from two uniform ones."""
    u = uniform(seed, stream, 2 * counter)
    v = uniform(seed, stream, 2 * counter + 1)
    return math.sqrt(-2.0 * math.log(u)) * math.cos(2.0 * math.pi * v)


@loop_njit
def fill_normals(seed, stream, first, step, out):
    """Fill `out` with the normal numbers `first`, `first + step`, …, to rounding those of `normal`.

    No call is in the loop, so that it becomes one over vectors, several times faster; the logarithm is that of fdlibm
    (Sun Microsystems, freely usable).
    """
    bits = out.view(np.int64)
    for i in range(out.shape[0]):
        counter = 2 * (first + i * step)
        u = uniform(seed, stream, counter)
        v = uniform(seed, stream, counter + 1)
        # u = 2^power (1 + f), 1 + f between the roots of 1/2 and of 2; its bits by way of the room for the result.
        out[i] = u
        power = (bits[i] - ROOT_HALF) >> 52
        bits[i] -= power << 52
        f = out[i] - 1.0
        s = f / (2.0 + f)
        z = s * s
        rest = z * (
            6.666666666666735130e-01
            + z
            * (
                3.999999999940941908e-01
                + z
                * (
                    2.857142874366239149e-01
                    + z
                    * (
                        2.222219843214978396e-01
                        + z * (1.818357216161805012e-01 + z * (1.531383769920937332e-01 + z * 1.479819860511658591e-01))
                    )
                )
            )
        )
        half = 0.5 * f * f
        log = power * LN2_HIGH - ((half - (s * (half + rest) + power * LN2_LOW)) - f)
        _, cosine = sincos(2.0 * math.pi * v)
        out[i] = math.sqrt(-2.0 * log) * cosine
