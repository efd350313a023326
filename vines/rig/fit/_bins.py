"""Means over short blocks of samples: all that the fits need of a channel, at some kilohertz."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.recording import Sampled

__all__ = ["BIN_RATE", "Bins", "bins_of", "sinhc"]

Floats = npt.NDArray[np.float64]

BIN_RATE = 3200.0
"""About so many means a second: the oscillator moves at some ten hertz, an impact lasts a tenth of a millisecond."""


@dataclass(frozen=True, slots=True, eq=False)
class Bins:
    """Means over blocks of equal length.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Middle of each block [s].
    mean : ndarray, shape (n,)
        Mean of its samples.
    width : float
        Length of a block [s].
    smooth : float
        Standard deviation of a Gaussian that the signal was smoothed with before [s].
    """

    t: Floats
    mean: Floats
    width: float
    smooth: float = 0.0

    def response(self, s: complex) -> complex:
        """Return the mean over a block of exp(s t), smoothed, where its middle is t = 0."""
        return sinhc(0.5 * s * self.width) * complex(np.exp(0.5 * (s * self.smooth) ** 2))

    def without(self, times: Floats, reach: float) -> Bins:
        """Return the blocks with middles farther than `reach` from all times."""
        if not len(times):
            return self
        place = np.searchsorted(np.sort(times), self.t)
        times = np.concatenate([[-np.inf], np.sort(times), [np.inf]])
        far = np.minimum(self.t - times[place], times[place + 1] - self.t) > reach
        return replace(self, t=self.t[far], mean=self.mean[far])


def bins_of(channel: Sampled, rate: float = BIN_RATE) -> Bins:
    """Return block means of a channel; blocks with an invalid sample are left out.

    The mean of exp(s t) over a block is its value in the middle times :func:`sinhc` (s width/2), so that fits of
    exponentials lose nothing by it.

    Raises
    ------
    RigError
        If fewer than 16 blocks are left.

    Examples
    --------
    >>> import numpy as np
    >>> flat = Sampled("laser", "lo_disp", 6400.0, 0.0, np.arange(64.0), np.ones(64, bool))
    >>> bins_of(flat).mean[:3]
    array([0.5, 2.5, 4.5])
    """
    size = max(1, round(channel.rate / rate))
    n = len(channel.values) // size
    mean = channel.values[: n * size].reshape(n, size).mean(axis=1)
    t = channel.start + ((size - 1) / 2 + size * np.arange(n)) / channel.rate
    if not channel.valid.all():
        good = channel.valid[: n * size].reshape(n, size).all(axis=1)
        t, mean = t[good], mean[good]
    if len(t) < 16:
        raise RigError(f"channel {channel.name!r} has {len(t)} usable stretches of samples, a fit needs at least 16")
    return Bins(np.asarray(t, dtype=np.float64), mean, size / channel.rate)


def sinhc(z: complex) -> complex:
    """Return sinh(z)/z.

    Examples
    --------
    >>> sinhc(0), round(abs(sinhc(0.1j)), 9)
    ((1+0j), 0.998334166)
    """
    return complex(np.sinh(z) / z) if abs(z) > 1e-6 else complex(1 + z * z / 6)
