"""All turning points of a flight, found for certain: what makes admissibility a certificate and not a sample.

Between two consecutive zeros of w' the gap is monotone, so that the extremes of w over a flight are its ends
and its turning points. The zeros are enclosed by bisection with Taylor bounds on w' (docs/orbits.md,
"Admissibility"): an interval is left only when w' provably has no zero in it, or exactly one, which is then
computed.
"""

from __future__ import annotations

from vines.dynamics.kernels import derivatives, fourth_bound, free_ball, pull, speed_terms, turn
from vines.kernels import copy_values, linked_njit, new_vector, njit

__all__ = ["turning_points_kernel"]

_DEEPEST = 80
"""Intervals on the stack at most; each bisection adds one, and intervals below _SHORTEST are not bisected."""

_SHORTEST = 1e-9
"""Where w' and w'' may both vanish within so short an interval, w changes by less than rounding in it."""

_ULP = 4e-16


@njit
def _rate(c, motion, drift, tau):
    """Return u = w', u' and u'' at tau."""
    now = turn(c.free, c.Omega, *motion, tau)
    _, v, a, j, _ = derivatives(c.free, c.Omega, *now)
    return v - free_ball(c, drift, tau)[1], pull(c, a), j


@njit
def _root(c, motion, drift, a, b, ua):
    """Return the zero of u in [a, b], where u is monotone, has the sign of ua at a and the other one at b."""
    tau = 0.5 * (a + b)
    for _ in range(100):
        u, du, _ = _rate(c, motion, drift, tau)
        if (u > 0.0) == (ua > 0.0):
            a = tau
        else:
            b = tau
        moved = tau - u / du if du != 0.0 else 0.5 * (a + b)
        if not a <= moved <= b:
            moved = 0.5 * (a + b)
        if abs(moved - tau) <= _ULP * (1.0 + tau) or b - a <= _ULP * (1.0 + tau):
            return moved
        tau = moved
    return tau


@linked_njit
def turning_points_kernel(c, motion, drift, duration):
    """Return the times in (0, duration) at which the gap to a ball that starts with velocity `drift` turns, in order.

    Parameters
    ----------
    c : vines.dynamics._constants.Constants
    motion : tuple of float
        As `flight` gives it at the start of the flight.
    drift : float
    duration : float
    """
    found = new_vector(16)
    count = 0
    left = new_vector(_DEEPEST + 2)
    right = new_vector(_DEEPEST + 2)
    left[0], right[0] = 0.0, duration
    depth = 1
    slack = 1e-15 * (speed_terms(c, *motion) + abs(drift))
    while depth > 0:
        depth -= 1
        a, b = left[depth], right[depth]
        h = 0.5 * (b - a)
        now = turn(c.free, c.Omega, *motion, a)
        _, va, _, _, _ = derivatives(c.free, c.Omega, *now)
        bound = fourth_bound(c, *now, 2.0 * h)
        u, du, ddu = _rate(c, motion, drift, a + h)
        if abs(u) > slack + h * (abs(du) + h * (0.5 * abs(ddu) + h * bound / 6.0)):
            continue
        if abs(du) > h * (abs(ddu) + 0.5 * h * bound):
            ua = va - free_ball(c, drift, a)[1]
            ub, _, _ = _rate(c, motion, drift, b)
            if ua * ub < 0.0 or (ua == 0.0 and a > 0.0):
                if count == found.size:
                    grown = new_vector(2 * count)
                    copy_values(grown, found)
                    found = grown
                found[count] = _root(c, motion, drift, a, b, ua) if ua != 0.0 else a
                count += 1
        elif h > _SHORTEST and depth < _DEEPEST:
            left[depth], right[depth] = a + h, b
            left[depth + 1], right[depth + 1] = a, a + h
            depth += 2
    out = new_vector(count)
    copy_values(out, found[:count])
    return out
