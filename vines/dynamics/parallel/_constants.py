"""The numbers that the kernels need for balls in parallel cavities; how many there are is known when they compile."""

from __future__ import annotations

from typing import NamedTuple

from vines.dynamics._constants import Oscillator, constants_at, constants_kernel, oscillator
from vines.dynamics._impact_law import ImpactLaw, impact_law
from vines.kernels import linked_njit, njit

__all__ = ["Frame", "ParallelConstants", "ParallelTable", "frame_with", "parallel_constants", "riding"]


class Frame(NamedTuple):
    """The oscillator with the balls that ride on it: ``x1 = Re u - sag``, sag their weight over the stiffness."""

    own: Oscillator
    sag: float


class ParallelConstants(NamedTuple):
    """As `Constants`, with a tuple where there is one number for each ball."""

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
    mu: tuple[float, ...]
    beta: tuple[float, ...]
    r: tuple[float, ...]
    correction: tuple[float, ...]
    law: tuple[ImpactLaw, ...]


class ParallelTable(NamedTuple):
    """The constants of one run, where kernels for many runs take a table."""

    constants: ParallelConstants


def parallel_constants(A: float, Omega: float, lam: float, G: float, *balls: float) -> ParallelConstants:
    """Return the `ParallelConstants` at bare parameter values; `balls` is all mu, then all beta, then all r."""
    n = len(balls) // 3
    mu, beta, r = balls[:n], balls[n : 2 * n], balls[2 * n :]
    each = [constants_kernel(mass, A, Omega, restitution, lam) for mass, restitution in zip(mu, r, strict=True)]
    one = each[0]
    return ParallelConstants(
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
        mu,
        beta,
        r,
        tuple(c.correction for c in each),
        tuple(impact_law(mass, restitution) for mass, restitution in zip(mu, r, strict=True)),
    )


@constants_at.register(ParallelTable)
@njit
def _constants_at(table, k):
    return table.constants


@njit
def riding(c, modes):
    """Return the mass of the balls that ride on a wall, from the number of their set, bit i for ball i."""
    left = int(abs(modes))
    mass = 0.0
    for i in range(len(c.mu)):
        if left & (1 << i):
            mass += c.mu[i]
    return mass


@linked_njit
def frame_with(c, modes):
    """Return the `Frame` with the balls that ride on it."""
    if modes == 0.0:
        return c.free
    mass = riding(c, modes)
    return Frame(oscillator(1.0 + mass, c.A, c.Omega, c.lam), mass * c.G)
