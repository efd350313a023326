"""The next contact of a free flight with either wall: never missed, never invented (docs/dynamics.md)."""

from __future__ import annotations

import math

from vines.dynamics._flight import derivatives, fourth_bound, turn
from vines.dynamics._jit import njit
from vines.dynamics._steps import leaving_step, quartic_root, safe_step

__all__ = ["CONTACT", "NO_CONTACT", "STEP_CAP", "first_step", "next_contact"]

CONTACT = 1
NO_CONTACT = 0
STEP_CAP = -1

FEW_ULP = 8.0 * 2.220446049250313e-16
MAX_STEPS = 1_000_000
"""Certified steps within one call; a flight takes about four, so reaching this means something is wrong."""


@njit
def _wall_step(gap, slope, second, third, bound, window):
    """Return the certified step towards one wall, the bound of the curvature taken over not much more than the step."""
    rising = max(third, 0.0) / 3.0
    fourth = bound / 12.0
    h = safe_step(gap, slope, second + window * (rising + fourth * window), window)
    if h >= window:
        return h
    shorter = min(1.5 * h, window)
    return max(h, safe_step(gap, slope, second + shorter * (rising + fourth * shorter), shorter))


@njit
def first_step(c, zr, zi, qr, qi, v2, wall, released):
    """Return the certified step from the wall just left, where the gap is 0 exactly.

    After a release w' = w'' = 0 exactly, too.
    """
    _, v, a, j, k = derivatives(c.free, c.Omega, zr, zi, qr, qi)
    bound = fourth_bound(c, zr, zi, qr, qi, k, c.window)
    speed = 0.0 if released else max(wall * (v2 - v), 0.0)
    second = 0.0 if released else wall * a
    own = leaving_step(speed, second, wall * j, bound, c.window)
    other = _wall_step(2.0, -wall * (v - v2), -wall * a, -wall * j, bound, c.window)
    return min(own, other)


@njit
def _polish(c, zr, zi, qr, qi, x2, v2, side, tau, reach):
    """Return (tau, x1, v1) at the only contact with `side` in [tau, tau + reach]."""
    low = tau
    high = tau + reach
    o = c.free
    x = v = 0.0
    for _ in range(80):
        zrt, zit, qrt, qit = turn(o, c.Omega, zr, zi, qr, qi, tau)
        x, v, a, j, k = derivatives(o, c.Omega, zrt, zit, qrt, qit)
        gap = 1.0 - side * (x - (x2 + v2 * tau))
        if gap > 0.0:
            low = max(low, tau)
        else:
            high = min(high, tau)
        slope = side * (v - v2)
        step = quartic_root(gap, slope, side * a, side * j, side * k) if slope > 0.0 else math.nan
        if abs(step) <= c.near:
            x += step * (v + step * (0.5 * a + step * (j / 6.0 + step * k / 24.0)))
            v += step * (a + step * (0.5 * j + step * k / 6.0))
            return max(tau + step, 0.0), x, v
        if not low <= tau + step <= high:
            step = 0.5 * (low + high) - tau
            if abs(step) <= FEW_ULP * high:
                break
        tau += step
    return tau, x, v


@njit
def next_contact(c, zr, zi, qr, qi, x2, v2, wall, released, tau, stop):
    """Search for the first contact after tau, where the flight is known to be clear until tau.

    Parameters
    ----------
    zr, zi, qr, qi : float
        Phasors of the oscillator at the start of the flight.
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
    o = c.free
    if tau == 0.0 and wall != 0:
        h = first_step(c, zr, zi, qr, qi, v2, wall, released)
        if h > stop:
            return NO_CONTACT, 0.0, 0, 0.0, 0.0
        tau = h
    window = c.window
    for _ in range(MAX_STEPS):
        zrt, zit, qrt, qit = turn(o, c.Omega, zr, zi, qr, qi, tau)
        x, v, a, j, k = derivatives(o, c.Omega, zrt, zit, qrt, qit)
        bound = fourth_bound(c, zrt, zit, qrt, qit, k, window)
        w = x - (x2 + v2 * tau)
        speed = v - v2
        side = 1 if speed > 0.0 else -1
        gap = max(1.0 - side * w, 0.0)
        slope = abs(speed)
        if 2.0 * gap <= slope * window:
            reach = 2.0 * gap / slope if slope > 0.0 else 0.0
            bend = abs(a) + reach * (abs(j) + 0.5 * bound * reach)
            if slope * slope > 2.0 * bend * gap:
                found, x, v = _polish(c, zr, zi, qr, qi, x2, v2, side, tau, reach)
                if found > stop:
                    return NO_CONTACT, tau, 0, 0.0, 0.0
                return CONTACT, found, side, x, v
        ahead = _wall_step(gap, slope, side * a, side * j, bound, window)
        behind = _wall_step(max(1.0 + side * w, 0.0), -slope, -side * a, -side * j, bound, window)
        h = min(ahead, behind)
        if h <= FEW_ULP * tau:
            if tau > stop:
                return NO_CONTACT, tau, 0, 0.0, 0.0
            return CONTACT, tau, (side if ahead <= behind else -side), x, v
        if tau + h > stop:
            return NO_CONTACT, tau, 0, 0.0, 0.0
        tau += h
    return STEP_CAP, tau, 0, 0.0, 0.0
