"""One step of the series: coefficients by recurrences, how far they reach, and the polynomial they are.

``x1'' = F - lam x1' - x1 - mu f`` and ``w'' = x1'' - f`` with ``f = k1 w + k3 w³ + l2 w'``. The square and the cube of
w are Cauchy products of their series; the force of the base is known in closed form. That is the first field; other
fields bring equations of their own for the type of their constants, in the same room.
"""

from __future__ import annotations

import math

from vines.dynamics._sincos import sincos
from vines.dynamics.taylor._constants import LENGTH, ORDER, ROOM, Field
from vines.kernels import by_type, doubles_at, fused_njit, loop_njit, njit

__all__ = [
    "DIRECTIONS",
    "DISTURBED",
    "SQUARE",
    "W",
    "X",
    "at",
    "bounds",
    "coefficients",
    "cube",
    "derivatives_at",
    "expand",
    "expand_disturbances",
    "rate",
    "reach",
    "slopes",
    "times_square",
]

X, W, SQUARE, DISTURBED = 0, LENGTH, 2 * LENGTH, 3 * LENGTH
"""Where the series of x1, w and w² stand in the room, and those of disturbances of x1 and w, one after the other."""

DIRECTIONS = 4

SHORTEST = 1e-8
"""Shortest step, in units of the longest."""


@fused_njit
def coefficients(f):
    """Return the room for the series of a field."""
    return doubles_at(f.room, ROOM)


@fused_njit
def cube(a, first, k):
    """Return coefficient k of the cube of a series, whose square is kept in SQUARE up to k."""
    even = 0.0
    odd = 0.0
    i = 0
    j = k
    while i + 1 < j - 1:
        even += a[first + i] * a[first + j]
        odd += a[first + i + 1] * a[first + j - 1]
        i += 2
        j -= 2
    while i < j:
        even += a[first + i] * a[first + j]
        i += 1
        j -= 1
    square = 2.0 * (even + odd)
    if i == j:
        square += a[first + i] * a[first + i]
    a[SQUARE + k] = square
    even = 0.0
    odd = 0.0
    for i in range(0, k, 2):
        even += a[SQUARE + i] * a[first + k - i]
        odd += a[SQUARE + i + 1] * a[first + k - i - 1]
    if k % 2 == 0:
        even += a[SQUARE + k] * a[first]
    return even + odd


@by_type(Field)
@loop_njit
def expand(f, x, v, w, u, phase):
    """Fill the room with the series of x1 and w from a state, and return how long the step may be.

    Parameters
    ----------
    f : Field
    x, v, w, u, phase : float
        x1, x1', w, w' and the phase of the forcing.
    """
    a = coefficients(f)
    mu, lam, k1, k3, l2 = f.mu, f.lam, f.k1, f.k3, f.l2
    a[X], a[X + 1], a[W], a[W + 1] = x, v, w, u
    sine, cosine = sincos(phase)
    force = f.A * (sine + lam * f.Omega * cosine)
    later = f.A * f.Omega * (cosine - lam * f.Omega * sine)
    turn = f.Omega * f.Omega
    for k in range(f.order - 1):
        spring = k1 * a[W + k] + k3 * cube(a, W, k) + l2 * (k + 1) * a[W + k + 1]
        own = force - lam * (k + 1) * a[X + k + 1] - a[X + k] - mu * spring
        share = 1.0 / ((k + 1.0) * (k + 2.0))
        a[X + k + 2] = share * own
        a[W + k + 2] = share * (own - spring)
        force, later = later, -share * turn * force
    return reach(a, f.order, W, max(abs(x), abs(v), abs(w), abs(u), f.A), f.longest)


@njit
def reach(a, order, other, size, longest):
    """Return how far a step may go: terms fall by e^-2, so that e^-40 of `size` is left out (Jorba and Zou, 2005).

    Series of twice the order go as far, and leave out e^-80. Nan where there is no step that is worth it. It looks at
    the series of x1 and at the one that begins at `other`.
    """
    last = max(abs(a[X + order]), abs(a[other + order]))
    before = max(abs(a[X + order - 1]), abs(a[other + order - 1]))
    step = math.inf
    if last > 0.0:
        step = math.log(size / last) / order
    if before > 0.0:
        step = min(step, math.log(size / before) / (order - 1))
    step = math.exp(step - 2.0 - 0.7 / (ORDER - 1))
    # Motion that is lost in overflow, or a million times as fast as the forcing, goes no step.
    return min(longest, step) if step > SHORTEST * longest else math.nan


@fused_njit
def at(a, first, order, s):
    """Return a polynomial at s, and its derivative."""
    value = a[first + order]
    slope = 0.0
    for k in range(order - 1, -1, -1):
        slope = slope * s + value
        value = value * s + a[first + k]
    return value, slope


@fused_njit
def derivatives_at(a, first, order, s):
    """Return a polynomial at s and its first six derivatives."""
    p0 = a[first + order]
    p1 = p2 = p3 = p4 = p5 = p6 = 0.0
    for k in range(order - 1, -1, -1):
        p6 = p6 * s + p5
        p5 = p5 * s + p4
        p4 = p4 * s + p3
        p3 = p3 * s + p2
        p2 = p2 * s + p1
        p1 = p1 * s + p0
        p0 = p0 * s + a[first + k]
    return p0, p1, 2.0 * p2, 6.0 * p3, 24.0 * p4, 120.0 * p5, 720.0 * p6


@fused_njit
def bounds(a, first, order, h):
    """Return bounds over [0, h] of a polynomial less its linear part, and of its third and fifth derivative."""
    bend = third = fifth = 0.0
    for k in range(order, 1, -1):
        size = abs(a[first + k])
        bend = bend * h + size
        if k > 2:
            third = third * h + (k * (k - 1.0) * (k - 2.0)) * size
        if k > 4:
            fifth = fifth * h + (k * (k - 1.0) * (k - 2.0)) * ((k - 3.0) * (k - 4.0)) * size
    return bend * h * h, third, fifth


@fused_njit
def rate(f, w, u):
    """Return the acceleration that the spring gives the mass."""
    return f.k1 * w + f.k3 * w * w * w + f.l2 * u


@by_type(Field)
@fused_njit
def slopes(f, x, v, w, u, phase):
    """Return x1'' and x2'' of a flight at a state."""
    sine, cosine = sincos(phase)
    spring = rate(f, w, u)
    return f.A * (sine + f.lam * f.Omega * cosine) - f.lam * v - x - f.mu * spring, spring


@fused_njit
def times_square(a, of, k):
    """Return coefficient k of a series times what is kept in SQUARE."""
    product = 0.0
    other = 0.0
    for i in range(0, k, 2):
        product += a[SQUARE + i] * a[of + k - i]
        other += a[SQUARE + i + 1] * a[of + k - i - 1]
    if k % 2 == 0:
        product += a[SQUARE + k] * a[of]
    return product + other


@by_type(Field)
@loop_njit
def expand_disturbances(f, h, Y):
    """Carry disturbances of (x1, x1', w, w'), the columns of Y, over h of the step that the room holds.

    They follow the same recurrences with ``(k1 + 3 k3 w²) δw + l2 δw'`` for the spring.
    """
    a = coefficients(f)
    order = f.order
    for j in range(Y.shape[1]):
        dx = DISTURBED + 2 * LENGTH * (j % DIRECTIONS)
        dw = dx + LENGTH
        a[dx], a[dx + 1], a[dw], a[dw + 1] = Y[0, j], Y[1, j], Y[2, j], Y[3, j]
        for k in range(order - 1):
            # As `times_square`, written out: the sum is rounded in the factor before it.
            product = 0.0
            other = 0.0
            for i in range(0, k, 2):
                product += a[SQUARE + i] * a[dw + k - i]
                other += a[SQUARE + i + 1] * a[dw + k - i - 1]
            if k % 2 == 0:
                product += a[SQUARE + k] * a[dw]
            spring = f.k1 * a[dw + k] + 3.0 * f.k3 * (product + other) + f.l2 * (k + 1) * a[dw + k + 1]
            own = -f.lam * (k + 1) * a[dx + k + 1] - a[dx + k] - f.mu * spring
            share = 1.0 / ((k + 1.0) * (k + 2.0))
            a[dx + k + 2] = share * own
            a[dw + k + 2] = share * (own - spring)
        Y[0, j], Y[1, j] = at(a, dx, order, h)
        Y[2, j], Y[3, j] = at(a, dw, order, h)
