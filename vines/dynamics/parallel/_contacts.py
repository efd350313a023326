"""The next contact of any flying ball: one look at the frame serves all balls, the least certified step is taken."""

from __future__ import annotations

import math

from vines.dynamics._contact import BEYOND, CONTACT, FEW_ULP, GAP, MAX_STEPS, NO_CONTACT, STEP_CAP, close_in, first_step
from vines.dynamics._flight import derivatives, fifth, forced_fifth, free_ball, modulus, pull, sixth, turn
from vines.dynamics._steps import certain_ways, only_root, taylor_root
from vines.dynamics.parallel._layout import B_FOUND, B_MODE, B_RELEASED, B_STEP, B_V2, B_WALL, B_X2, at
from vines.kernels import fused_njit

__all__ = ["first_hits"]

TOGETHER = 8.0 * 2.220446049250313e-16
"""Contacts that are nearer to each other in time than this, relative to the time of flight, are one instant."""


@fused_njit
def _look(c, beta, x, v, a, j, k, d5, d6, bound, x2, v2, tau):
    """Return (estimate, step, wall): the only root ahead, or inf and how far the ball is certain to meet no wall.

    `wall` is that which the root or the end of the step is nearer to.
    """
    window = c.window
    way, speed = free_ball(c, v2, tau)
    w = x - (x2 + way)
    pace = abs(v - speed)
    side = 1 if v > speed else -1
    d2, d3, d4 = side * a, side * j, side * k
    gap = max(beta - side * w, 0.0)
    h, _ = taylor_root(gap, pace, d2, d3, d4, side * d5, side * d6)
    reach = BEYOND * h
    if reach <= window and only_root(gap, pace, d2, d3, d4, bound, reach):
        return h, math.inf, side
    behind = max(beta + side * w, 0.0)
    forth, back = certain_ways(gap, behind, pace, d2, d3, d4, bound, window)
    h = min(forth, back)
    return math.inf, h, (side if forth <= back else -side)


@fused_njit
def _most_urgent(c, state, x, v, tau):
    """Return the ball that would meet a wall first if nothing changed its velocity."""
    first, gap, pace = 0, 1.0, 0.0
    for i in range(len(c.mu)):
        way, speed = free_ball(c, state[at(i, B_V2)], tau)
        w, rate = x - (state[at(i, B_X2)] + way), v - speed
        own = c.beta[i] - w if rate > 0.0 else c.beta[i] + w
        # Compared without dividing by the rates.
        if own * pace < gap * abs(rate) and state[at(i, B_MODE)] == 0.0:
            first, gap, pace = i, own, abs(rate)
    return first


@fused_njit
def _is_clear(c, beta, x, v, a, j, k, bound, x2, v2, tau, span):
    """Say whether a ball is certain to meet no wall for a while, all terms of its way taken by their size."""
    way, speed = free_ball(c, v2, tau)
    bend = 0.5 * abs(a) + span * ((1 / 6) * abs(j) + span * ((1 / 24) * abs(k) + span * ((1 / 120) * bound)))
    w = x - (x2 + way)
    return max(abs(w), abs(w + span * (v - speed))) + span * span * bend < beta


@fused_njit
def _any_flies(n, state):
    flying = 0
    for i in range(n):
        flying += state[at(i, B_MODE)] == 0.0
    return flying > 0


@fused_njit
def first_hits(c, o, motion, state, tau, stop):
    """Search for the first contact of any free ball after tau; see `next_contact`.

    Returns
    -------
    (code, tau, hits, x1, v1)
        The set of the balls that hit, bit i for ball i; the wall of each is left in the state, at B_STEP.
    """
    n = len(c.mu)
    if not _any_flies(n, state):
        return NO_CONTACT, stop, 0, 0.0, 0.0
    forced = forced_fifth(c, *motion) * c.window
    for _ in range(MAX_STEPS):
        now = turn(o, c.Omega, *motion, tau)
        x, v, a, j, k = derivatives(o, c.Omega, *now)
        d5, i5 = fifth(o, *now)
        d6 = sixth(o, *now)
        bound = modulus(d5, i5) + forced
        nearest = least = math.inf
        hits = rooted = only = 0
        a = pull(c, a)
        first = _most_urgent(c, state, x, v, tau)
        for turn_of in range(n):
            # The ball that comes to a wall first shortens the time for which the others have to be clear.
            i = first if turn_of == 0 else turn_of - (turn_of <= first)
            if state[at(i, B_MODE)] != 0.0:
                continue
            x2, v2, wall = state[at(i, B_X2)], state[at(i, B_V2)], state[at(i, B_WALL)]
            state[at(i, B_FOUND)] = math.inf
            if tau == 0.0 and wall != 0.0:
                released = state[at(i, B_RELEASED)] != 0.0
                least = min(least, first_step(c, o, c.beta[i], motion, v2, int(wall), released))
                continue
            span = min(least, BEYOND * nearest)
            if span <= c.window and _is_clear(c, c.beta[i], x, v, a, j, k, bound, x2, v2, tau, span):
                continue
            estimate, h, side = _look(c, c.beta[i], x, v, a, j, k, d5, d6, bound, x2, v2, tau)
            state[at(i, B_STEP)] = side
            state[at(i, B_FOUND)] = estimate
            if estimate < math.inf:
                rooted += 1
                only = i
            nearest = min(nearest, estimate)
            if not h > FEW_ULP * tau:
                hits |= 1 << i
            least = min(least, h)
        if hits != 0:
            return (CONTACT, tau, hits, x, v) if tau <= stop else (NO_CONTACT, tau, 0, 0.0, 0.0)
        if nearest <= least and nearest < math.inf:
            best, best_x, best_v = math.inf, 0.0, 0.0
            low, high = (0, n) if rooted > 1 else (only, only + 1)
            for i in range(low, high):
                estimate = state[at(i, B_FOUND)]
                if state[at(i, B_MODE)] == 0.0 and estimate <= BEYOND * nearest:
                    x2, v2, side = state[at(i, B_X2)], state[at(i, B_V2)], int(state[at(i, B_STEP)])
                    found, fx, fv, _, _, _ = close_in(
                        c, o, GAP, c.beta[i], motion, x2, v2, side, tau, estimate, BEYOND * estimate
                    )
                    state[at(i, B_FOUND)] = found
                    if found < best:
                        best, best_x, best_v = found, fx, fv
                else:
                    state[at(i, B_FOUND)] = math.inf
            if best <= tau + least:
                if best > stop:
                    return NO_CONTACT, tau, 0, 0.0, 0.0
                for i in range(low, high):
                    if state[at(i, B_MODE)] == 0.0 and state[at(i, B_FOUND)] <= best + TOGETHER * best:
                        hits |= 1 << i
                return CONTACT, best, hits, best_x, best_v
            least = min(least, 0.5 * nearest)
        least = min(least, nearest)
        if tau + least > stop:
            return NO_CONTACT, tau, 0, 0.0, 0.0
        tau += least
    return STEP_CAP, tau, 0, 0.0, 0.0
