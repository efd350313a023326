"""The numbers that the closing equations need, from the constants or from bare parameter values inside a kernel.

Derivatives in a parameter and curves in two of them evaluate the equations at many values; building `Params` and
`Constants` for each would cost more than the equations.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import impact_law_kernel, oscillator
from vines.kernels import njit
from vines.model import AMPLITUDE, DAMPING, FREQUENCY, MASS, RESTITUTION, Params, Word

__all__ = ["Essentials", "essentials", "essentials_of", "frequency_of", "marks_of", "unit_of", "values_of"]


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


def frequency_of(p: Any) -> float:
    """Return the frequency of the forcing of any system."""
    return float(getattr(p, "Omega", 1.0))


def marks_of(word: Word) -> npt.NDArray[np.int64]:
    """Return the wall of each impact of a word, times the number of the ball where balls have numbers."""
    return np.array([side * max(ball, 1) for side, ball in zip(word.sides, word.balls, strict=True)], dtype=np.int64)


def unit_of(p: Any) -> float:
    """Return the unit of the defects of the closing equations: with it they are velocities of a ball."""
    return p.mu if isinstance(p, Params) else 1.0


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
