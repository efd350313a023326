"""The numbers that the kernels need for a ball in an oscillator whose spring hardens with the cube of its way."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vines.dynamics._constants import constants_kernel
from vines.dynamics.taylor import TaylorConstants
from vines.dynamics.taylor.kernels import LONGEST, ROOM

__all__ = ["DuffingField", "duffing_constants"]


class DuffingField(NamedTuple):
    """What the equations take: ``x1'' = inverse (F - lam x1' - x1 - alpha x1³)`` and ``w'' = free x1''``.

    In flight `inverse` and `free` are 1. While the ball rides the mass is 1 + mu, `inverse` its inverse, and `free` 0.
    """

    A: float
    Omega: float
    lam: float
    alpha: float
    inverse: float
    free: float
    order: int
    longest: float
    room: int


def duffing_constants(
    mu: float, A: float, Omega: float, r: float, lam: float, alpha: float, order: int
) -> TaylorConstants:
    """Return the constants at bare parameter values, with series of an order from 8 to 40."""
    one = constants_kernel(mu, A, Omega, r, lam)
    space = np.zeros(ROOM)
    shared = order, LONGEST * one.window, space.ctypes.data
    found = TaylorConstants(
        mu, A, Omega, r, lam, 1.0, one.Omega5, one.period, one.window, one.near, one.correction, one.law,
        DuffingField(A, Omega, lam, alpha, 1.0 / (1.0 + mu), 0.0, *shared),
        DuffingField(A, Omega, lam, alpha, 1.0, 1.0, *shared),
    )  # fmt: skip
    found.space = space
    return found
