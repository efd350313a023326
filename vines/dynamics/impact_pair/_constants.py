"""The numbers that the kernels need for the impact pair: a driven capsule with a ball that does not act on it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import constants_at
from vines.dynamics._impact_law import ImpactLaw, impact_law_kernel
from vines.kernels import linked_njit, njit

__all__ = ["Capsule", "PairConstants", "PairTable", "pair_constants"]


class Capsule(NamedTuple):
    """A frame that is driven: x1 = B sin(theta), whatever meets it. A motion of it is (x1, v1)."""

    B: float


class PairConstants(NamedTuple):
    """As `Constants`, of the impact pair: theta is the time, so that Omega = 1, and the capsule's mass is infinite.

    ``mu`` is that of the law of impact, 0: the capsule keeps its velocity; energies are per unit of the ball's mass.
    ``correction`` is that of the energy which a merge leaves out where the push changes while the ball still hops.
    """

    mu: float
    Omega: float
    r: float
    lam: float
    B: float
    G: float
    period: float
    window: float
    near: float
    correction: float
    law: ImpactLaw
    free: Capsule
    stuck: Capsule


class PairTable(NamedTuple):
    """Parameters B, G, r of many runs, one a row."""

    values: npt.NDArray[np.float64]


@linked_njit
def pair_constants(B, G, r):
    """Return the `PairConstants` at bare parameter values."""
    cube = 1.0 - r * r * r
    return PairConstants(
        0.0,
        1.0,
        r,
        0.0,
        B,
        G,
        2.0 * math.pi,
        2.0,
        4e-3,
        2.0 / 3.0 / cube if cube > 0.0 else math.inf,
        impact_law_kernel(0.0, r),
        Capsule(B),
        Capsule(B),
    )


@constants_at.register(PairTable)
@njit
def _constants_at(table, k):
    return pair_constants(table.values[k, 0], table.values[k, 1], table.values[k, 2])
