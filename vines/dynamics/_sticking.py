"""Sticking: the ball rides on a wall until the contact force would have to pull (docs/dynamics.md)."""

from __future__ import annotations

import math

from vines.dynamics._constants import Constants
from vines.dynamics._contact import BEYOND, CONTACT, FEW_ULP, FORCE, MAX_STEPS, NO_CONTACT, STEP_CAP, close_in
from vines.dynamics._flight import derivatives, fifth, forced_fifth, modulus, pull, terms, turn
from vines.dynamics._steps import leaving_step, only_root, safe_step, taylor_root
from vines.kernels import by_type, fused_njit, loop_njit

__all__ = ["UNRESOLVED", "ends_chatter", "holds_for", "merges", "next_release", "release_within"]

OMITTED = 1e-16
"""Largest change of the common velocity that a merge may leave out."""

UNRESOLVED = 8.0 * 2.220446049250313e-16
"""Height of a flight over its wall, relative to the size of the terms, below which doubles cannot resolve it."""


@fused_njit
def merges(c, o, r, correction, side, speed, motion, x2):
    """Say whether a ball leaving `side` at `speed` >= 0 is to be taken as stuck from now on.

    It is, if the rest of its chatter changes the common velocity by less than OMITTED while the push keeps its sign,
    or if its flight is too low for double precision; with no speed at all the sign of the push decides.
    """
    _, _, a, j, k = derivatives(o, c.Omega, *motion)
    height = UNRESOLVED * (terms(o, *motion) + abs(x2))
    return ends_chatter(r, correction, speed, side * pull(c, a), side * j, abs(k), height, holds_for(c, *motion))


@fused_njit
def ends_chatter(r, correction, speed, push, jerk, snap, height, holds):
    """Say the same from how the wall is pushed against the ball: relative acceleration and its first two derivatives.

    `height` is what doubles resolve of a flight's height, `holds` how long the push does not jump.
    """
    if speed == 0.0:
        return push > 0.0 or (push == 0.0 and jerk >= 0.0)
    if push <= 0.0:
        return False
    cube = speed * speed * speed
    # The hop comes back after speed/push or, where the push grows, after sqrt(2 speed/jerk) at the latest.
    unresolved = speed * speed < height * push or (jerk > 0.0 and 2.0 * cube < height * height * jerk)
    if not (unresolved or correction * cube < OMITTED * push * push):
        return False
    if unresolved and (jerk >= 0.0 or r >= 1.0):
        return True
    rest = 2.0 * speed / (push * (1.0 - r))
    return rest <= holds and jerk * rest > -0.25 * push and snap * rest * rest < 0.25 * push


@by_type(Constants)
@fused_njit
def holds_for(c, ur, ui, gr, gi):
    """Return for how long the force does not jump."""
    return math.inf


@by_type(Constants)
@loop_njit
def next_release(c, side, motion, tau, stop):
    """Search for the first release after tau; arguments and result as for `next_contact`, with the loaded oscillator.

    Returns
    -------
    (code, tau, x1, v1)
    """
    return release_within(c, c.stuck, side, motion, tau, stop)


@fused_njit
def release_within(c, o, side, motion, tau, stop):
    """Return the same where the force does not jump before `stop`."""
    window = c.window
    forced = forced_fifth(c, *motion) * window
    for _ in range(MAX_STEPS):
        now = turn(o, c.Omega, *motion, tau)
        x, v, a, j, k = derivatives(o, c.Omega, *now)
        bound = modulus(*fifth(o, *now)) + forced
        # The contact force is (1 + mu) side w'' of a ball that were free; its sign is all that matters here.
        force = side * pull(c, a)
        slope = -side * j
        bend = -side * k
        if force < 0.0 or (force == 0.0 and slope > 0.0):
            return (CONTACT, tau, x, v) if tau <= stop else (NO_CONTACT, tau, 0.0, 0.0)
        if slope > 0.0:
            h, _ = taylor_root(force, slope, bend, 0.0, 0.0, 0.0, 0.0)
            reach = BEYOND * h
            # One order lower than in flight: the third derivative of the force is only bounded.
            if reach <= window and only_root(force, slope, bend, -bound, 0.0, 0.0, reach):
                found, x, v, _, _, _ = close_in(c, o, FORCE, 1.0, motion, 0.0, 0.0, side, tau, h, reach)
                return (CONTACT, found, x, v) if found <= stop else (NO_CONTACT, tau, 0.0, 0.0)
        if force == 0.0:
            h = leaving_step(-slope, bend, bound, 0.0, window)
        else:
            h = safe_step(force, slope, bend + bound * window / 3.0, window)
            shorter = min(1.5 * h, window)
            h = max(h, safe_step(force, slope, bend + bound * shorter / 3.0, shorter))
        if h <= FEW_ULP * tau:
            return (CONTACT, tau, x, v) if tau <= stop else (NO_CONTACT, tau, 0.0, 0.0)
        if tau + h > stop:
            return NO_CONTACT, tau, 0.0, 0.0
        tau += h
    return STEP_CAP, tau, 0.0, 0.0
