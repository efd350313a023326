"""The numbers that the kernels need for balls in parallel cavities; one kernel serves any number of balls."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import Oscillator, constants_at, constants_kernel, oscillator
from vines.dynamics._impact_law import ImpactLaw
from vines.kernels import constant_at, fused_njit, linked_njit, njit

__all__ = [
    "BETA",
    "CORRECTION",
    "MU",
    "Frame",
    "ParallelConstants",
    "ParallelTable",
    "R",
    "frame_with",
    "law_of_ball",
    "of_ball",
    "parallel_constants",
    "riding",
]

MU, BETA, R, CORRECTION, KEEP1, PASS1, KEEP2, PASS2 = range(8)
"""What stands of each ball in the table of balls: its parameters, `Constants.correction` and the law of its impacts."""

NUMBERS = 8


class Frame(NamedTuple):
    """The oscillator with the balls that ride on it: ``x1 = Re u - sag``, sag their weight over the stiffness."""

    own: Oscillator
    sag: float


class _Fields(NamedTuple):
    A: float
    Omega: float
    lam: float
    G: float
    Omega4: float
    Omega5: float
    period: float
    window: float
    near: float
    free: Frame
    balls: int
    each: int


class ParallelConstants(_Fields):
    """As `Constants`; what there is once a ball stands in a table of `balls` rows, and `each` is its address.

    So a kernel is compiled once for all numbers of balls. The table lives as long as the constants do: it is an
    attribute of them, no field.
    """

    table: npt.NDArray[np.float64]


class ParallelTable(NamedTuple):
    """The constants of one run, where kernels for many runs take a table."""

    constants: ParallelConstants


def parallel_constants(A: float, Omega: float, lam: float, G: float, *balls: float) -> ParallelConstants:
    """Return the `ParallelConstants` at bare parameter values; `balls` is all mu, then all beta, then all r."""
    n = len(balls) // 3
    mu, beta, r = balls[:n], balls[n : 2 * n], balls[2 * n :]
    each = [constants_kernel(mass, A, Omega, restitution, lam) for mass, restitution in zip(mu, r, strict=True)]
    one = each[0]
    table = np.empty((n, NUMBERS))
    for row, c, length in zip(table, each, beta, strict=True):
        row[:] = c.mu, length, c.r, c.correction, c.law.keep1, c.law.pass1, c.law.keep2, c.law.pass2
    found = ParallelConstants(
        A,
        Omega,
        lam,
        G,
        one.Omega4,
        one.Omega5,
        one.period,
        one.window,
        one.near,
        Frame(one.free, 0.0),
        n,
        table.ctypes.data,
    )
    found.table = table
    return found


@constants_at.register(ParallelTable)
@njit
def _constants_at(table, k):
    return table.constants


@fused_njit
def of_ball(each, i, what):
    """Return a number of ball i, from 0 on, in the table of balls at an address."""
    return constant_at(each, NUMBERS * i + what)  # pyright: ignore[reportCallIssue]


@fused_njit
def law_of_ball(each, i):
    """Return the `ImpactLaw` of ball i, from 0 on."""
    first = NUMBERS * i
    return ImpactLaw(
        constant_at(each, first + KEEP1),  # pyright: ignore[reportCallIssue]
        constant_at(each, first + PASS1),
        constant_at(each, first + KEEP2),
        constant_at(each, first + PASS2),
        constant_at(each, first + MU),
    )


@njit
def riding(c, modes):
    """Return the mass of the balls that ride on a wall, from the number of their set, bit i for ball i."""
    left = int(abs(modes))
    mass = 0.0
    for i in range(c.balls):
        if left & (1 << i):
            mass += of_ball(c.each, i, MU)
    return mass


@linked_njit
def frame_with(c, modes):
    """Return the `Frame` with the balls that ride on it."""
    if modes == 0.0:
        return c.free
    mass = riding(c, modes)
    return Frame(oscillator(1.0 + mass, c.A, c.Omega, c.lam), mass * c.G)
