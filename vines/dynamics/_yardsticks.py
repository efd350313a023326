"""The two responses that give a measure its meaning: the oscillator with no ball, and with the ball locked in."""

from __future__ import annotations

from typing import Any

from vines.domains import Parameters, stated
from vines.dynamics._room import room_of

__all__ = ["ball_locked", "no_ball"]


@stated(p=Parameters())
def no_ball(p: Any) -> float:
    """Return the steady amplitude of x1 when there is no ball.

    The oscillator x1'' + lam x1' + x1 = A sin + lam Omega A cos (paper, eq. (8)) answers with
    A sqrt(1 + lam² Omega²)/sqrt((1 - Omega²)² + lam² Omega²). A Duffing frame (`systems.Duffing`) answers in several
    ways at some frequencies: the largest |x1| of the largest stable response is returned.

    Examples
    --------
    >>> from vines.model import Params
    >>> print(f"{no_ball(Params(mu=0.01, A=0.02)):.6f}")
    1.667069
    """
    return room_of(p).amplitude(p, 1.0)


@stated(p=Parameters())
def ball_locked(p: Any) -> float:
    """Return the steady amplitude of x1 when all balls are fixed to the oscillator, whose mass is then 1 + mu.

    Examples
    --------
    >>> from vines.model import Params
    >>> print(f"{ball_locked(Params(mu=0.01, A=0.02)):.6f}")
    1.280589
    """
    return room_of(p).amplitude(p, 1.0 + room_of(p).mass(p))
