"""A mass that sticks to a barrier: both move as one oscillator, in closed form, until the spring would pull it off.

While it sticks x1'' = x2'' is that of the loaded oscillator, and the barrier presses with mu (side x1'' - k1 - k3).
A frame that has no closed form rides by its own series, by the type of what stands for the loaded oscillator.
"""

from __future__ import annotations

from typing import NamedTuple

from vines.dynamics._constants import Oscillator
from vines.dynamics._flight import derivatives, forced_fifth, free_ball, modulus, phasors, pull, turn
from vines.dynamics._sticking import release_within
from vines.kernels import by_type, fused_njit, loop_njit, njit

__all__ = ["held", "release", "ride"]


class Held(NamedTuple):
    """What the search for a release takes of the constants, and the acceleration at which the barrier lets go."""

    Omega: float
    Omega5: float
    window: float
    near: float
    limit: float


free_ball.register(Held)(free_ball.first)


@pull.register(Held)
@fused_njit
def _pull(c, a):
    return a - c.limit


@forced_fifth.register(Held)
@fused_njit
def _forced_fifth(c, ur, ui, gr, gi):
    return modulus(gr, gi) * c.Omega5


@fused_njit
def held(c, limit):
    """Return the `Held` of some constants."""
    return Held(c.Omega, c.Omega5, c.window, c.near, limit)


@by_type(Oscillator)
@loop_njit
def release(o, c, side, x, v, phase, clear, stop):
    """Search for the release after `clear`; see `vines.dynamics._sticking.next_release`."""
    f = c.field
    ends = held(c, side * (f.k1 + f.k3))
    return release_within(ends, o, side, phasors(o, c.Omega, x, v, phase), clear, stop)


@by_type(Oscillator)
@njit
def ride(o, Omega, x, v, phase, tau):
    """Return x1 and x1' of the loaded oscillator a time tau after a state."""
    here, speed, _, _, _ = derivatives(o, Omega, *turn(o, Omega, *phasors(o, Omega, x, v, phase), tau))
    return here, speed
