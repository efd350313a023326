"""How far the displacement sensor is from linear, by the oscillator itself: in flight its motion is known in form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from vines.rig.fit._bins import Bins
from vines.rig.fit._fitter import Fitter
from vines.rig.fit._motion import Motion
from vines.rig.fit._slide import Push
from vines.rig.fit._train import Train

__all__ = ["straight"]

Floats = npt.NDArray[np.float64]

_DEGREES = range(2, 8)
_U_BEND = 5e-4
"""Standard uncertainty of each term, relative to the largest displacement: sensors are linear to .02 to .1 %."""


_EXPLAINS = 0.998
"""Most that is left of the residual, without noise taken off, where the sensor's linearity is believed."""

_HARMONICS = 1e-5
"""Standard uncertainty of the forced harmonics by the base's own, relative to the motion."""


def straight(fitter: Fitter, train: Train, pushed: Push | None = None) -> Fitter:
    """Return the fitter with the displacement less what its sensor adds, if that explains a part of what is left.

    Parameters
    ----------
    fitter : Fitter
        Of a displacement.
    train : Train
        Impacts; false ones do no harm.
    pushed : Push, optional
        What the ball's friction adds.

    Notes
    -----
    Harmonics that the base does not have are the sensor's then: without that, they and jumps that repeat would say the
    same. A sensor that is off by .07 % can take two thirds off the jumps of a train of soft impacts at one phase.
    """
    fit = fitter.fit(train, 0, pushed)
    columns, sizes = _bends(fitter.bins, fit.motion, *fitter.u_natural)
    strict = fitter
    if fitter.model.forced is not None:
        c, u_c = fitter.model.forced
        known = 0.03 * np.abs(c) + _HARMONICS * float(np.abs(fitter.bins.mean).max())
        strict = replace(fitter, model=replace(fitter.model, forced=(c, np.minimum(u_c, known))))
    bent = strict.fit(train, 0, pushed, (columns, sizes))
    if bent.residual > _EXPLAINS * fit.residual:
        return fitter
    n = len(_DEGREES)
    return strict.on(replace(fitter.bins, mean=fitter.bins.mean - bent.extra[:n] @ columns[:n]))


def _bends(bins: Bins, motion: Motion, u_omega0: float, u_lam: float) -> tuple[Floats, Floats]:
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
