"""Sticking: the ball rides on a wall until the contact force would have to pull (docs/dynamics.md)."""

from __future__ import annotations

import math

from vines.dynamics._contact import CONTACT, FEW_ULP, MAX_STEPS, NO_CONTACT, STEP_CAP
from vines.dynamics._flight import derivatives, turn
from vines.dynamics._jit import njit
from vines.dynamics._steps import leaving_step, quartic_root, safe_step

__all__ = ["merges", "next_release"]

OMITTED = 1e-16
"""Largest change of the common velocity that a merge may leave out."""

UNRESOLVED = 8.0 * 2.220446049250313e-16
"""Height of a flight over its wall, relative to the size of the terms, below which doubles cannot resolve it."""


@njit
def merges(c, side, speed, zr, zi, qr, qi, x2):
    """Say whether a ball leaving `side` at `speed` >= 0 is to be taken as stuck from now on.

    It is, if the rest of its chatter changes the common velocity by less than OMITTED while the push keeps its sign,
    or if its flight is too low for double precision; with no speed at all the sign of the push decides.
    """
    _, _, a, j, k = derivatives(c.free, c.Omega, zr, zi, qr, qi)
    push = side * a
    jerk = side * j
    if speed == 0.0:
        return push > 0.0 or (push == 0.0 and jerk >= 0.0)
    if push <= 0.0:
        return False
    size = 1.0 + abs(zr) + abs(zi) + abs(qr) + abs(qi) + abs(x2)
    back = speed / push
    if jerk > 0.0:
        back = min(back, math.sqrt(2.0 * speed / jerk))
    if speed * back < UNRESOLVED * size and jerk >= 0.0:
        return True
    if c.r >= 1.0:
        return speed * back < UNRESOLVED * size
    rest = 2.0 * speed / (push * (1.0 - c.r))
    steady = jerk * rest > -0.25 * push and abs(k) * rest * rest < 0.25 * push
    unresolved = speed * back < UNRESOLVED * size
    return steady and (unresolved or c.correction * speed * speed * speed < OMITTED * push * push)


@njit
def next_release(c, side, zr, zi, qr, qi, tau, stop):
    """Search for the first release after tau; arguments and result as for `next_contact`, with the loaded oscillator.

    Returns
    -------
    (code, tau, x1, v1)
    """
    o = c.stuck
    z = math.sqrt(zr * zr + zi * zi)
    q = math.sqrt(qr * qr + qi * qi)
    fifth = z * o.size**5 + q * c.Omega4 * c.Omega
    window = c.window
    for _ in range(MAX_STEPS):
        zrt, zit, qrt, qit = turn(o, c.Omega, zr, zi, qr, qi, tau)
        x, v, a, j, k = derivatives(o, c.Omega, zrt, zit, qrt, qit)
        # The contact force is (1 + mu) side x1''; its sign is all that matters here.
        force = side * a
        slope = -side * j
        bend = -side * k
        if force < 0.0 or (force == 0.0 and slope > 0.0):
            return (CONTACT, tau, x, v) if tau <= stop else (NO_CONTACT, tau, 0.0, 0.0)
        if slope > 0.0 and 2.0 * force <= slope * window:
            reach = 2.0 * force / slope
            if slope * slope > 2.0 * (abs(bend) + fifth * reach) * force:
                found, x, v = _polish_release(c, side, zr, zi, qr, qi, tau, reach)
                return (CONTACT, found, x, v) if found <= stop else (NO_CONTACT, tau, 0.0, 0.0)
        if force == 0.0:
            h = leaving_step(-slope, bend, fifth, 0.0, window)
        else:
            h = safe_step(force, slope, bend + fifth * window / 3.0, window)
            shorter = min(1.5 * h, window)
            h = max(h, safe_step(force, slope, bend + fifth * shorter / 3.0, shorter))
        if h <= FEW_ULP * tau:
            return (CONTACT, tau, x, v) if tau <= stop else (NO_CONTACT, tau, 0.0, 0.0)
        if tau + h > stop:
            return NO_CONTACT, tau, 0.0, 0.0
        tau += h
    return STEP_CAP, tau, 0.0, 0.0


@njit
def _polish_release(c, side, zr, zi, qr, qi, tau, reach):
    """Return (tau, x1, v1) at the only zero of the contact force in [tau, tau + reach]."""
    o = c.stuck
    low = tau
    high = tau + reach
    x = v = 0.0
    for _ in range(80):
        zrt, zit, qrt, qit = turn(o, c.Omega, zr, zi, qr, qi, tau)
        x, v, a, j, k = derivatives(o, c.Omega, zrt, zit, qrt, qit)
        force = side * a
        if force > 0.0:
            low = max(low, tau)
        else:
            high = min(high, tau)
        slope = -side * j
        step = quartic_root(force, slope, -side * k, 0.0, 0.0) if slope > 0.0 else math.nan
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
