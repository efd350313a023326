"""The shortest time in which the ball can cross the cavity on a periodic orbit: a bound from the balance of energy."""

from __future__ import annotations

import math

import numpy as np

from vines.dynamics.kernels import constants
from vines.model import Params

__all__ = ["shortest_crossing"]


def shortest_crossing(p: Params, impacts: int, duration: float) -> float:
    """Return a time that no flight between opposite walls is shorter than, on any orbit of so many impacts; maybe 0.

    Parameters
    ----------
    p : Params
    impacts : int
        Over the period.
    duration : float
        The period pT.

    Notes
    -----
    docs/orbits.md, "All orbits of a word": the forcing does no more work than it does in the damper and in impacts, so
    that the sum of all w'^2 has a bound, and with it x1 and v1; 2 is the integral of w' over the crossing.

    Examples
    --------
    >>> p = Params(mu=0.01, A=0.022)
    >>> print(f"{shortest_crossing(p, 3, p.period):.3f}")
    0.394
    """
    c = constants(p)
    lost = (p.mu / (1.0 + p.mu)) * (1.0 - p.r**2) / 2.0
    if not (p.lam > 0.0 and lost > 0.0):
        return 0.0
    force = p.A * math.hypot(1.0, p.lam * p.Omega)
    squares = 0.5 * duration * force**2 / (4.0 * p.lam) / lost
    gamma = c.free.gamma
    s = complex(-c.free.half, gamma)
    kicks = c.law.pass1 * math.sqrt(impacts * squares) * abs(1.0 / (1.0 - np.exp(s * duration))) / gamma
    steady = math.hypot(c.free.qr, c.free.qi)
    x1, v1 = steady + kicks, p.Omega * steady + abs(s) * kicks
    # |w'| is at most its value at the arrival and what the acceleration of the oscillator makes of it on the way.
    fastest, gained = math.sqrt(squares), force + p.lam * v1 + x1
    return 4.0 / (fastest + math.sqrt(fastest**2 + 8.0 * gained))
