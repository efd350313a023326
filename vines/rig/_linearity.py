"""How far the displacement sensor is from linear, by the oscillator itself: in flight its motion is known in form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from vines.rig._bins import Bins
from vines.rig._motion import Motion

__all__ = ["bends", "straightened"]

Floats = npt.NDArray[np.float64]

_DEGREES = range(2, 8)
_U_BEND = 1e-4
"""Standard uncertainty of each term, relative to the largest displacement: sensors are linear to .02 to .1 %."""


def bends(bins: Bins, motion: Motion, u_omega0: float, u_lam: float) -> tuple[Floats, Floats]:
    """Return what a sensor that is not linear adds to its signal, and what errors of omega0 and lam look like.

    Parameters
    ----------
    bins : Bins
        Of the displacement.
    motion : Motion
        A first fit of it.
    u_omega0, u_lam : float
        Relative standard uncertainties of omega0 and lam, which must be free beside the sensor: they bend flights, too.

    Returns
    -------
    columns : ndarray, shape (8, n)
        Legendre polynomials 2 to 7 of the motion over its range [m], and the change of x1 by relative changes of omega0
        and lam [m].
    u : ndarray, shape (8,)
        Standard uncertainties of their sizes.
    """
    # Of the fitted motion: with the signal's own noise in them the terms would fit that noise.
    x1 = motion.at(bins.t)
    size = float(np.abs(x1).max())
    terms = size * np.polynomial.legendre.legvander(x1 / size, _DEGREES[-1]).T[_DEGREES[0] :]
    s = motion.s
    omega0, lam = abs(s), -2 * s.real / abs(s)
    # s = omega0 (-lam/2 + i sqrt(1 - lam^2/4))
    by_lam = omega0 * lam * complex(-0.5, -0.25 * lam / np.sqrt(1 - 0.25 * lam**2))
    flight = np.maximum(np.searchsorted(motion.starts, bins.t, side="right") - 1, 0)
    tau = bins.t - motion.starts[flight]
    free = tau * motion.z[flight] * np.exp(s * tau)
    columns = np.vstack([terms, (free * s).real, (free * by_lam).real])
    return np.asarray(columns, dtype=np.float64), np.array([_U_BEND] * len(_DEGREES) + [u_omega0, u_lam])


def straightened(bins: Bins, columns: Floats, sizes: Floats) -> Bins:
    """Return the signal without what the sensor added."""
    n = len(_DEGREES)
    return replace(bins, mean=bins.mean - sizes[:n] @ columns[:n])
