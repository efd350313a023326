"""The numbers that the kernels need for a ball in a cavity with a mass on a cubic spring beside it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import constants_at, constants_kernel
from vines.dynamics._impact_law import ImpactLaw
from vines.dynamics.taylor._constants import LONGEST, ROOM
from vines.kernels import njit

__all__ = ["HybridConstants", "HybridTable", "SpringField", "hybrid_constants"]


class SpringField(NamedTuple):
    """What the equations of motion take: parameters, order and longest step of the series, address of their room."""

    mu_n: float
    A: float
    Omega: float
    lam: float
    k1: float
    k3: float
    l2: float
    order: int
    longest: float
    room: int


class _Fields(NamedTuple):
    mu: float
    A: float
    Omega: float
    r: float
    lam: float
    period: float
    correction: float
    law: ImpactLaw
    field: SpringField


class HybridConstants(_Fields):
    """As `Constants`; the doubles in which a kernel holds series live as long as they do, being an attribute."""

    space: npt.NDArray[np.float64]


class HybridTable(NamedTuple):
    """The constants of one run, where kernels for many runs take a table."""

    constants: HybridConstants


def hybrid_constants(
    mu: float, A: float, Omega: float, r: float, lam: float, mu_n: float, k1: float, k3: float, l2: float, order: int
) -> HybridConstants:
    """Return the `HybridConstants` at bare parameter values.

    Parameters
    ----------
    order : int
        Order of the series, 8 to 40: tests run at twice the usual one.
    """
    one = constants_kernel(mu, A, Omega, r, lam)
    space = np.zeros(ROOM)
    field = SpringField(mu_n, A, Omega, lam, k1, k3, l2, order, LONGEST * one.window, space.ctypes.data)
    found = HybridConstants(mu, A, Omega, r, lam, one.period, one.correction, one.law, field)
    found.space = space
    return found


@constants_at.register(HybridTable)
@njit
def _constants_at(table, k):
    return table.constants
