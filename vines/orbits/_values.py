"""The numbers that the closing equations need, from bare parameter values inside a kernel.

Derivatives in a parameter and curves in two of them evaluate the equations at many values; building `Params` and
`Constants` for each would cost more than the equations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import Oscillator, oscillator
from vines.kernels import njit
from vines.model import Params

__all__ = ["Essentials", "essentials", "values_of"]


class Essentials(NamedTuple):
    """The part of `vines.dynamics._constants.Constants` that closing equations and flights use."""

    mu: float
    Omega: float
    pass2: float
    free: Oscillator


def values_of(p: Params) -> npt.NDArray[np.float64]:
    """Return mu, A, Omega, r, lam, shape (5,)."""
    return np.array([p.mu, p.A, p.Omega, p.r, p.lam])


@njit
def essentials(values):
    """Return the `Essentials` at parameter values mu, A, Omega, r, lam; not finite where the model does not exist."""
    mu, A, Omega, r, lam = values[0], values[1], values[2], values[3], values[4]
    free = oscillator(1.0, A, Omega, lam)
    return Essentials(mu, Omega, (1.0 + r) / (1.0 + mu), free)
