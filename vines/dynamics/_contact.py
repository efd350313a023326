"""The next contact of a free flight with either wall: never missed, never invented (docs/dynamics.md)."""

from __future__ import annotations

from vines.dynamics._constants import Constants
from vines.dynamics._flight import derivatives, fifth, forced_fifth, free_ball, modulus, pull, sixth, turn
from vines.dynamics._steps import certain_ways, leaving_step, only_root, step_ahead, step_back, taylor_root
from vines.kernels import by_type, fused_njit

__all__ = [
    "BEYOND",
    "CONTACT",
    "FEW_ULP",
    "FORCE",
    "GAP",
    "MAX_STEPS",
    "NO_CONTACT",
    "SPEED",
    "STEP_CAP",
    "close_in",
    "contact_within",
    "first_step",
    "leave_wall",
    "next_contact",
]

CONTACT = 1
NO_CONTACT = 0
STEP_CAP = -1

FEW_ULP = 8.0 * 2.220446049250313e-16
MAX_STEPS = 1_000_000
"""Certified steps within one call; a flight takes about three, so reaching this means something is wrong."""

GAP, FORCE, SPEED = 0, 1, 2

BEYOND = 1.125
"""How much farther than the estimated contact the interval reaches that is shown to hold exactly one."""


@fused_njit
def first_step(c, o, beta, motion, v2, wall, released):
    """Return the certified step from the wall just left, where the gap is 0 exactly.

    After a release w' = w'' = 0 exactly, too.
    """
    _, v, a, j, k = derivatives(o, c.Omega, *motion)
    a = pull(c, a)
    re, im = fifth(o, *motion)
    bound = modulus(re, im) + forced_fifth(c, *motion) * c.window
    return leave_wall(beta, wall * (v2 - v), wall * a, wall * j, wall * k, bound, c.window, released)


@fused_njit
def leave_wall(beta, pace, second, third, fourth, bound, window, released):
    """Return the certified step from a wall that is left at `pace`, with further derivatives of the gap towards it.

    `bound` is that of the fifth derivative over `window`.
    """
    speed = 0.0 if released else max(pace, 0.0)
    bend = 0.0 if released else second
    own = step_back(0.0, speed, bend, third, fourth, bound, window)
    if own < 0.25 * window:
        own = max(own, leaving_step(speed, bend, third, max(fourth, 0.0) + 0.2 * window * bound, window))
    span = min(window, 3.0 * beta / pace) if pace > 0.0 else window
    if pace >= 0.0:
        return min(own, step_ahead(2.0 * beta, pace, -second, -third, -fourth, bound, span))
    return min(own, step_back(2.0 * beta, -pace, -second, -third, -fourth, bound, span))


@fused_njit
def close_in(c, o, what, beta, motion, x2, v2, side, tau, step, reach):
    """Return (tau, x1, v1, x1'', x1''', x1'''') at the only root in [tau, tau + reach], estimated at tau + step.

    It is that of the gap to the wall `side` of a cavity of half length beta (GAP), of the force between it and a ball
    riding on it (FORCE), or of the velocity v1, which has the sign `side` (SPEED).
    """
    low = tau
    high = tau + reach
    x = v = a = j = k = 0.0
    for _ in range(80):
        tau += step
        now = turn(o, c.Omega, *motion, tau)
        x, v, a, j, k = derivatives(o, c.Omega, *now)
        d5, _ = fifth(o, *now)
        if what == GAP:
            way, speed = free_ball(c, v2, tau)
            gap = beta - side * (x - (x2 + way))
            slope = side * (v - speed)
            d6 = sixth(o, *now)
            step, correction = taylor_root(gap, slope, side * pull(c, a), side * j, side * k, side * d5, side * d6)
        elif what == FORCE:
            gap = side * pull(c, a)
            slope = -side * j
            step, correction = taylor_root(gap, slope, -side * k, -side * d5, 0.0, 0.0, 0.0)
        else:
            gap = side * v
            slope = -side * a
            step, correction = taylor_root(gap, slope, -side * j, -side * k, -side * d5, 0.0, 0.0)
        if gap > 0.0:
            low = max(low, tau)
        else:
            high = min(high, tau)
        if abs(step) <= c.near and slope > 0.0 and abs(correction) <= 1e-5 * abs(step) + 1e-14:
            x += step * (v + step * (0.5 * a + step * ((1 / 6) * j + step * ((1 / 24) * k + step * ((1 / 120) * d5)))))
            v += step * (a + step * (0.5 * j + step * ((1 / 6) * k + step * ((1 / 24) * d5))))
            a += step * (j + step * (0.5 * k + step * ((1 / 6) * d5)))
            j += step * (k + step * (0.5 * d5))
            return max(tau + step, 0.0), x, v, a, j, k + step * d5
        if not (slope > 0.0 and low <= tau + step <= high):
            step = 0.5 * (low + high) - tau
            if abs(step) <= FEW_ULP * high:
                break
    return tau, x, v, a, j, k


@by_type(Constants)
@fused_njit
def next_contact(c, motion, x2, v2, wall, released, tau, stop):
    """Search for the first contact after tau, where the flight is known to be clear until tau.

    Parameters
    ----------
    motion : tuple of float
        u and G of the oscillator at the start of the flight.
    x2, v2 : float
        Ball at the start of the flight.
    wall : int
        Wall just left (the search then starts at tau = 0), or 0.
    released : bool
        Whether it was left by the end of sticking, with w' = w'' = 0.
    tau, stop : float
        Where to start, and where to give up, in time since the start of the flight.

    Returns
    -------
    (code, tau, side, x1, v1)
        With code NO_CONTACT or STEP_CAP, tau is the last time known to be clear that a later search can start from.
    """
    return contact_within(c, motion, x2, v2, wall, released, tau, stop)


@fused_njit
def contact_within(c, motion, x2, v2, wall, released, tau, stop):
    """Return the same where the force does not jump before `stop`."""
    o = c.free
    window = c.window
    forced = forced_fifth(c, *motion) * window
    if tau == 0.0 and wall != 0:
        h = first_step(c, o, 1.0, motion, v2, wall, released)
        if h > stop:
            return NO_CONTACT, 0.0, 0, 0.0, 0.0
        tau = h
    for _ in range(MAX_STEPS):
        now = turn(o, c.Omega, *motion, tau)
        x, v, a, j, k = derivatives(o, c.Omega, *now)
        d5, i5 = fifth(o, *now)
        bound = modulus(d5, i5) + forced
        way, speed = free_ball(c, v2, tau)
        w = x - (x2 + way)
        pace = abs(v - speed)
        side = 1 if v > speed else -1
        d2, d3, d4 = side * pull(c, a), side * j, side * k
        gap = max(1.0 - side * w, 0.0)
        d6 = sixth(o, *now)
        h, _ = taylor_root(gap, pace, d2, d3, d4, side * d5, side * d6)
        reach = BEYOND * h
        if reach <= window and only_root(gap, pace, d2, d3, d4, bound, reach):
            found, x, v, _, _, _ = close_in(c, o, GAP, 1.0, motion, x2, v2, side, tau, h, reach)
            if found > stop:
                return NO_CONTACT, tau, 0, 0.0, 0.0
            return CONTACT, found, side, x, v
        behind = max(1.0 + side * w, 0.0)
        forth, back = certain_ways(gap, behind, pace, d2, d3, d4, bound, window)
        h = min(forth, back)
        if not h > FEW_ULP * tau:
            if tau > stop:
                return NO_CONTACT, tau, 0, 0.0, 0.0
            return CONTACT, tau, (side if forth <= back else -side), x, v
        if tau + h > stop:
            return NO_CONTACT, tau, 0, 0.0, 0.0
        tau += h
    return STEP_CAP, tau, 0, 0.0, 0.0
