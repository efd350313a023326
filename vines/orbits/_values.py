"""The numbers that the closing equations need, from the constants or from bare parameter values inside a kernel.

Derivatives in a parameter and curves in two of them evaluate the equations at many values; building `Params` and
`Constants` for each would cost more than the equations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import oscillator
from vines.dynamics._impact_law import impact_law_kernel
from vines.kernels import njit
from vines.model import AMPLITUDE, DAMPING, FREQUENCY, MASS, RESTITUTION, Params

__all__ = ["Essentials", "essentials", "essentials_of", "values_of"]


class Essentials(NamedTuple):
    """What closing equations use: the law of impact, the forcing, and the free oscillator with its steady response.

    ``ratio`` and ``pass1`` are those of `vines.dynamics._impact_law.ImpactLaw`, the others those of
    `vines.dynamics._constants.Constants` and its oscillator.
    """

    ratio: float
    pass1: float
    Omega: float
    half: float
    gamma: float
    qr: float
    qi: float


def values_of(p: Params) -> npt.NDArray[np.float64]:
    """Return mu, A, Omega, r, lam, shape (5,)."""
    return np.array(list(p.as_dict().values()))


@njit
def essentials(values):
    """Return the `Essentials` at parameter values mu, A, Omega, r, lam; not finite where the model does not exist."""
    mu, A, Omega = values[MASS], values[AMPLITUDE], values[FREQUENCY]
    r, lam = values[RESTITUTION], values[DAMPING]
    free = oscillator(1.0, A, Omega, lam)
    law = impact_law_kernel(mu, r)
    return Essentials(law.ratio, law.pass1, Omega, free.half, free.gamma, free.qr, free.qi)


@njit
def essentials_of(c):
    """Return the `Essentials` that are part of `vines.dynamics._constants.Constants`."""
    return Essentials(c.law.ratio, c.law.pass1, c.Omega, c.free.half, c.free.gamma, c.free.qr, c.free.qi)
