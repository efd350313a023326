"""The numbers that the kernels need for a mass on a cubic spring in the oscillator, between barriers or without."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import constants_at, constants_kernel
from vines.dynamics._impact_law import ImpactLaw
from vines.kernels import njit

__all__ = ["LENGTH", "LONGEST", "ORDER", "ROOM", "Field", "TaylorConstants", "TaylorTable", "taylor_constants"]

ORDER = 20
"""Order for which the length of a step is chosen."""

LENGTH = 41
"""Most coefficients of a series."""

ROOM = 11 * LENGTH
"""Doubles that there is room for: series of x1, w and w², and of four disturbances of x1 and of w."""

LONGEST = 1.0
"""Longest step, in windows of the kernels: a motion at rest has no scale of its own."""


class Field(NamedTuple):
    """What the equations of flight take: parameters, order and longest step of the series, address of their room."""

    mu: float
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
    walls: float
    Omega5: float
    period: float
    window: float
    near: float
    correction: float
    law: ImpactLaw
    stuck: Any
    field: Any


class TaylorConstants(_Fields):
    """As `Constants`, with the equations of flight in `field`, and in `stuck` what frame and mass are that stick.

    Kernels ask for the types of both: a `Field` and an `Oscillator`, whose spring acts on the mass with
    ``k1 w + k3 w³ + l2 w'``, and back on the oscillator, or what another room brings.

    The doubles in which a kernel holds series live as long as the constants do, being an attribute of them.
    """

    space: npt.NDArray[np.float64]


class TaylorTable(NamedTuple):
    """The constants of one run, where kernels for many runs take a table."""

    constants: TaylorConstants


def taylor_constants(
    mu: float, A: float, Omega: float, r: float, lam: float, k1: float, k3: float, l2: float, walls: float,
    order: int,
) -> TaylorConstants:  # fmt: skip
    """Return the `TaylorConstants` at bare parameter values.

    Parameters
    ----------
    order : int
        Order of the series, 8 to 40: tests run at twice the usual one.
    """
    one = constants_kernel(mu, A, Omega, r, lam)
    space = np.zeros(ROOM)
    field = Field(mu, A, Omega, lam, k1, k3, l2, order, LONGEST * one.window, space.ctypes.data)
    found = TaylorConstants(
        mu, A, Omega, r, lam, walls, one.Omega5, one.period, one.window, one.near, one.correction, one.law, one.stuck,
        field,
    )  # fmt: skip
    found.space = space
    return found


@constants_at.register(TaylorTable)
@njit
def _constants_at(table, k):
    return table.constants
