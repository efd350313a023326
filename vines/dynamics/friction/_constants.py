"""The numbers that the kernels need for a ball that slides with friction."""

from __future__ import annotations

from typing import NamedTuple

from vines.dynamics._constants import Oscillator, constants_at, constants_kernel
from vines.dynamics._impact_law import ImpactLaw
from vines.kernels import njit

__all__ = [
    "FrictionConstants",
    "FrictionFrame",
    "FrictionTable",
    "HoldConstants",
    "Rate",
    "RateConstants",
    "SlidGap",
    "SlidGapConstants",
    "friction_constants",
]


class FrictionFrame(NamedTuple):
    """The oscillator with a ball that slides in it, or rides on it: ``rides`` is 1 then.

    A motion is (u, G, sense, way, v2) as seven reals: x1 = Re u - load sense, with u and G those of `own`; the ball has
    come as far as `way` and has the velocity v2, with the acceleration f sense - pull. `sense` is the sign of w', 1 of
    a ball that rides.
    """

    own: Oscillator
    rides: float
    load: float
    f: float
    pull: float


class SlidGap(NamedTuple):
    """The same frame as seen from the ball: its position is that of the oscillator less the way of the ball."""

    frame: FrictionFrame


class Rate(NamedTuple):
    """The same frame where the acceleration stands for w': what searches for the end of a push finds w' = 0."""

    frame: FrictionFrame


class SlidGapConstants(NamedTuple):
    """What a search for contacts needs, in the frame of the ball, which rests."""

    Omega: float
    Omega5: float
    window: float
    near: float
    free: SlidGap


class RateConstants(NamedTuple):
    """What a search for w' = 0 needs."""

    Omega: float
    Omega4: float
    window: float
    near: float
    free: Rate


class HoldConstants(NamedTuple):
    """What a search for the end of a ride needs: where x1'' + offset changes its sign."""

    Omega: float
    Omega5: float
    window: float
    near: float
    offset: float


class FrictionConstants(NamedTuple):
    """As `Constants`, of a ball that slides with ``friction``, without drag.

    ``gap`` is what is seen from the ball, ``rate`` finds where it stops sliding, ``low`` and ``high`` where the frame
    pulls it from its place.
    """

    mu: float
    A: float
    Omega: float
    r: float
    lam: float
    friction: float
    G: float
    delta: float
    Omega5: float
    period: float
    window: float
    near: float
    correction: float
    law: ImpactLaw
    free: FrictionFrame
    stuck: FrictionFrame
    gap: SlidGapConstants
    rate: RateConstants
    low: HoldConstants
    high: HoldConstants


class FrictionTable(NamedTuple):
    """The constants of one run, where kernels for many runs take a table."""

    constants: FrictionConstants


@constants_at.register(FrictionTable)
@njit
def _constants_at(table, k):
    return table.constants


def friction_constants(
    mu: float, A: float, Omega: float, r: float, lam: float, f: float, G: float
) -> FrictionConstants:
    """Return the `FrictionConstants` at bare parameter values."""
    c = constants_kernel(mu, A, Omega, r, lam)
    free = FrictionFrame(c.free, 0.0, mu * f, f, G)
    search = (Omega, c.Omega5, c.window, c.near)
    return FrictionConstants(
        mu,
        A,
        Omega,
        r,
        lam,
        f,
        G,
        0.0,
        c.Omega5,
        c.period,
        c.window,
        c.near,
        c.correction,
        c.law,
        free,
        FrictionFrame(c.stuck, 1.0, mu * G, 0.0, 0.0),
        SlidGapConstants(*search, SlidGap(free)),
        RateConstants(Omega, c.Omega4, c.window, c.near, Rate(free)),
        HoldConstants(*search, G + f),
        HoldConstants(*search, G - f),
    )
