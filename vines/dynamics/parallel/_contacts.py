"""The next contact of any flying ball: one look at the frame serves all balls, the least certified step is taken."""

from __future__ import annotations

import math

from vines.dynamics._advance import S_MODE
from vines.dynamics._contact import BEYOND, CONTACT, FEW_ULP, GAP, MAX_STEPS, NO_CONTACT, STEP_CAP, close_in, first_step
from vines.dynamics._flight import derivatives, fifth, forced_fifth, free_ball, modulus, pull, sixth, turn
from vines.dynamics._steps import certain_ways, only_root, taylor_root
from vines.dynamics.parallel._layout import B_BETA, B_FOUND, B_MODE, B_RELEASED, B_STEP, B_V2, B_WALL, B_X2, S_NEXT, at
from vines.kernels import fused_njit, linked_njit

__all__ = ["first_hits"]

TOGETHER = 8.0 * 2.220446049250313e-16
"""Contacts that are nearer to each other in time than this, relative to the time of flight, are one instant."""

AFTER = 1.0 + 2.0**-10
"""How much farther than the first estimated contact the others have to be clear: estimates are far better than that."""

APART = 1e-8
"""A gap, relative to the sizes of which it is the difference, that leaves no doubt that a contact comes later."""


@fused_njit
def _look(c, beta, x, v, a, j, k, d5, d6, bound, x2, v2, tau):
    """Return (estimate, step, wall): the only root ahead, or inf and how far the ball is certain to meet no wall.

    `wall` is that which the root or the end of the step is nearer to.
    """
    way, speed = free_ball(c, v2, tau)
    w = x - (x2 + way)
    pace = abs(v - speed)
    side = 1 if v > speed else -1
    d2, d3, d4 = side * a, side * j, side * k
    gap = max(beta - side * w, 0.0)
    h, _ = taylor_root(gap, pace, d2, d3, d4, side * d5, side * d6)
    reach = BEYOND * h
    if reach <= c.window and only_root(gap, pace, d2, d3, d4, bound, reach):
        return h, math.inf, side
    forth, back = certain_ways(gap, max(beta + side * w, 0.0), pace, d2, d3, d4, bound, c.window)
    return math.inf, min(forth, back), (side if forth <= back else -side)


@fused_njit
def _certain(c, beta, x, v, a, j, k, bound, x2, v2, tau):
    """Return how far a ball is certain to meet no wall, whatever was estimated."""
    way, speed = free_ball(c, v2, tau)
    w = x - (x2 + way)
    pace = abs(v - speed)
    side = 1 if v > speed else -1
    gap, behind = max(beta - side * w, 0.0), max(beta + side * w, 0.0)
    return min(certain_ways(gap, behind, pace, side * a, side * j, side * k, bound, c.window))


@fused_njit
def _bends(a, j, k, bound, span):
    """Return what `_is_clear` asks of the frame: what its derivatives add to the way of any ball over a time `span`.

    They are parts of the coefficients 2 to 5 of a Bernstein polynomial of degree 5, and how far the last is uncertain.
    """
    second = 0.5 * span * span
    c2 = second * a
    c3 = (1 / 3) * second * span * j
    c4 = (1 / 6) * second * second * k
    return (
        0.1 * c2,
        0.3 * c2 + 0.1 * c3,
        0.6 * c2 + 0.4 * c3 + 0.2 * c4,
        c2 + c3 + c4,
        (1 / 30) * second * second * span * bound,
    )


@fused_njit
def _is_clear(c, beta, x, v, bends, x2, v2, tau, span):
    """Say whether a ball is certain to meet no wall for a time `span`: a polynomial lies between its coefficients."""
    way, speed = free_ball(c, v2, tau)
    w = x - (x2 + way)
    step = 0.2 * span * (v - speed)
    b2, b3, b4, b5, rest = bends
    first = max(abs(w), abs(w + step))
    middle = max(abs(w + 2.0 * step + b2), abs(w + 3.0 * step + b3))
    last = max(abs(w + 4.0 * step + b4), abs(w + 5.0 * step + b5) + rest)
    return max(first, middle, last) < beta


@fused_njit
def _close_in(c, o, motion, state, i, tau):
    """Return (tau, x1, v1) of the contact of ball i that its look has estimated; the time is left at B_FOUND."""
    x2, v2, side = state[at(i, B_X2)], state[at(i, B_V2)], int(state[at(i, B_STEP)])
    estimate = state[at(i, B_FOUND)]
    found, x, v, _, _, _ = close_in(
        c, o, GAP, state[at(i, B_BETA)], motion, x2, v2, side, tau, estimate, BEYOND * estimate
    )
    state[at(i, B_FOUND)] = found
    return found, x, v


@linked_njit
def _first_of(c, o, motion, state, soonest, tau, best, x, v):
    """Return the first contact of all balls with a root ahead, where one of them hits at `best`, the frame at x, v.

    A ball's gap only falls until its root, so that it has not hit as long as there is one: no other root is closed in
    but those that come with it or before it.
    """
    n = c.balls
    for i in range(n):
        if i == soonest or state[at(i, B_MODE)] != 0.0 or state[at(i, B_FOUND)] == math.inf:
            continue
        way, _ = free_ball(c, state[at(i, B_V2)], best)
        gap = state[at(i, B_BETA)] - state[at(i, B_STEP)] * (x - (state[at(i, B_X2)] + way))
        if gap > APART * (state[at(i, B_BETA)] + abs(x)):
            state[at(i, B_FOUND)] = math.inf
            continue
        found, own_x, own_v = _close_in(c, o, motion, state, i, tau)
        if found < best:
            best, x, v = found, own_x, own_v
    hits = 0
    for i in range(n):
        if state[at(i, B_MODE)] == 0.0 and state[at(i, B_FOUND)] <= best + TOGETHER * best:
            hits |= 1 << i
    return CONTACT, best, hits, x, v


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
    n = c.balls
    if state[S_MODE] != 0.0 and not _any_flies(n, state):
        return NO_CONTACT, stop, 0, 0.0, 0.0
    forced = forced_fifth(c, *motion) * c.window
    first = int(state[S_NEXT])
    for _ in range(MAX_STEPS):
        now = turn(o, c.Omega, *motion, tau)
        x, v, a, j, k = derivatives(o, c.Omega, *now)
        d5, i5 = fifth(o, *now)
        d6 = sixth(o, *now)
        bound = modulus(d5, i5) + forced
        nearest = least = math.inf
        hits = rooted = soonest = 0
        a = pull(c, a)
        reach = math.inf
        bends = (0.0, 0.0, 0.0, 0.0, 0.0)
        for turn_of in range(n):
            # The ball that probably comes to a wall first shortens the time for which the others have to be clear.
            i = first if turn_of == 0 else turn_of - (turn_of <= first)
            if state[at(i, B_MODE)] != 0.0:
                continue
            x2, v2, wall = state[at(i, B_X2)], state[at(i, B_V2)], state[at(i, B_WALL)]
            state[at(i, B_FOUND)] = math.inf
            if tau == 0.0 and wall != 0.0:
                released = state[at(i, B_RELEASED)] != 0.0
                least = min(least, first_step(c, o, state[at(i, B_BETA)], motion, v2, int(wall), released))
                continue
            span = min(least, AFTER * nearest)
            if span <= c.window:
                if span != reach:
                    reach = span
                    bends = _bends(a, j, k, bound, span)
                if _is_clear(c, state[at(i, B_BETA)], x, v, bends, x2, v2, tau, span):
                    least = span
                    continue
            estimate, h, side = _look(c, state[at(i, B_BETA)], x, v, a, j, k, d5, d6, bound, x2, v2, tau)
            state[at(i, B_STEP)] = side
            state[at(i, B_FOUND)] = estimate
            if estimate < math.inf:
                rooted += 1
            if estimate < nearest:
                nearest, soonest = estimate, i
            if not h > FEW_ULP * tau:
                hits |= 1 << i
            least = min(least, h)
        if nearest <= least and hits == 0 and nearest < math.inf:
            best, best_x, best_v = _close_in(c, o, motion, state, soonest, tau)
            if best <= tau + least:
                if best > stop:
                    return NO_CONTACT, tau, 0, 0.0, 0.0
                if rooted == 1:
                    return CONTACT, best, 1 << soonest, best_x, best_v
                return _first_of(c, o, motion, state, soonest, tau, best, best_x, best_v)
        if rooted > 0:
            # An estimate is not certain to be no later than the contact, so that nothing is stepped by it.
            for i in range(n):
                if state[at(i, B_MODE)] == 0.0 and state[at(i, B_FOUND)] < math.inf:
                    x2, v2, beta = state[at(i, B_X2)], state[at(i, B_V2)], state[at(i, B_BETA)]
                    h = _certain(c, beta, x, v, a, j, k, bound, x2, v2, tau)
                    if not h > FEW_ULP * tau:
                        hits |= 1 << i
                    least = min(least, h)
        if hits != 0:
            return (CONTACT, tau, hits, x, v) if tau <= stop else (NO_CONTACT, tau, 0, 0.0, 0.0)
        if tau + least > stop:
            return NO_CONTACT, tau, 0, 0.0, 0.0
        tau += least
    return STEP_CAP, tau, 0, 0.0, 0.0
