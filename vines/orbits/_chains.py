"""The closing equations of an orbit of any system, ball by ball: each ball flies from one of its impacts to its next.

Given the times of the impacts the frame is linear in the kicks that it gets, and the law of impact determines these.
What remains at each impact is that its ball leaves as the law says. Nothing is divided by the mass of a ball, so that
the same equations hold for balls without mass and for a frame that is driven (docs/orbits.md, "Any system").
"""

from __future__ import annotations

import cmath

from vines.dynamics.kernels import Constants
from vines.kernels import by_type, integer_vector, linked_njit, new_cube, new_matrix, new_vector, njit, zero_matrix
from vines.orbits._elimination import eliminate

__all__ = ["ball_of", "chain_closing", "gravity", "links", "response", "response_of", "steady", "steady_of"]


@njit
def steady_of(o, Omega, t):
    """Return what `steady` does, for the constants of an oscillator."""
    turned = complex(o.qr, o.qi) * cmath.exp(complex(0.0, Omega * t))
    return turned.real, -Omega * turned.imag, -Omega * Omega * turned.real


@njit
def response_of(o, duration, tau):
    """Return what `response` does, for the constants of an oscillator."""
    s = complex(-o.half, o.gamma)
    kernel = cmath.exp(s * tau) / (1.0 - cmath.exp(s * duration))
    return kernel.imag / o.gamma, (s * kernel).imag / o.gamma, (s * s * kernel).imag / o.gamma


@by_type(Constants)
@njit
def steady(c, t):
    """Return position, velocity and acceleration of the frame that meets no ball, for a forcing of phase Omega t."""
    return steady_of(c.free, c.Omega, t)


@by_type(Constants)
@njit
def response(c, duration, tau):
    """Return what a unit kick of the frame, repeated each `duration`, has made of it tau later, and its derivatives."""
    return response_of(c.free, duration, tau)


@by_type(Constants)
@njit
def ball_of(c, number):
    """Return pass1, pass2, keep2 of the law of impact of a ball, from 1 on, and half the length of its cavity."""
    return c.law.pass1, c.law.pass2, c.law.keep2, 1.0


@by_type(Constants)
@njit
def gravity(c):
    """Return the acceleration with which free balls fall to the ends L."""
    return 0.0


@linked_njit
def links(side):
    """Return for each impact the place of the next one of the same ball, its own where it is the only one."""
    N = side.size
    after = integer_vector(N)
    for j in range(N):
        after[j] = j
        for step in range(1, N + 1):
            k = (j + step) % N
            if abs(side[k]) == abs(side[j]):
                after[j] = k
                break
    return after


@linked_njit
def chain_closing(c, duration, side, t):
    """Return the closing equations at given impact times; see `closing_kernel`.

    The defect of an impact is by how much its ball leaves faster than the law says; `side` is the wall times the number
    of the ball, and row j of the states holds x1, v1 and position and velocity of the ball that hits.
    """
    N = t.size
    G = gravity(c)
    after = links(side)
    forced = new_matrix(3, N)
    g = new_cube(3, N, N)
    for j in range(N):
        forced[0, j], forced[1, j], forced[2, j] = steady(c, t[j])
        for k in range(N):
            tau = t[j] - t[k] if j > k else t[j] - t[k] + duration
            g[0, j, k], g[1, j, k], g[2, j, k] = response(c, duration, tau)

    # Flights: how fast the ball of impact j leaves, and how fast it comes to its next, as rows over the kicks.
    dt = new_vector(N)
    ball = new_matrix(N, N)
    ball_0 = new_vector(N)
    before = integer_vector(N)
    for j in range(N):
        n = after[j]
        before[n] = j
        dt[j] = t[n] - t[j] if n > j else t[n] - t[j] + duration
        beta = ball_of(c, abs(side[j]))[3]
        wall = (1 if side[n] > 0 else -1) - (1 if side[j] > 0 else -1)
        ball_0[j] = (forced[0, n] - forced[0, j] - beta * wall) / dt[j] + 0.5 * G * dt[j]
        for k in range(N):
            ball[j, k] = (g[0, n, k] - g[0, j, k]) / dt[j]

    law = new_matrix(N, N)
    again = new_matrix(N, N)
    kicks = new_matrix(N, 1)
    for j in range(N):
        b = before[j]
        e = ball_of(c, abs(side[j]))[0]
        kicks[j, 0] = -e * (forced[1, j] - (ball_0[b] - G * dt[b]))
        for k in range(N):
            law[j, k] = e * (g[1, j, k] - ball[b, k])
        law[j, j] += 1.0
        for k in range(N):
            again[j, k] = law[j, k]
    defect = new_vector(N)
    slope = new_matrix(N, N)
    states = new_matrix(N, 4)
    if not eliminate(law, kicks)[0]:
        return False, defect, slope, states
    w = new_vector(N)
    for j in range(N):
        x, v, w[j] = forced[0, j], forced[1, j], ball_0[j]
        for k in range(N):
            x += g[0, j, k] * kicks[k, 0]
            v += g[1, j, k] * kicks[k, 0]
            w[j] += ball[j, k] * kicks[k, 0]
        beta = ball_of(c, abs(side[j]))[3]
        states[j, 0], states[j, 1], states[j, 2] = x, v, x - (beta if side[j] > 0 else -beta)

    # Derivatives in the times with the kicks held, then through the kicks.
    dx = zero_matrix(N, N)
    dv = zero_matrix(N, N)
    for j in range(N):
        dx[j, j], dv[j, j] = forced[1, j], forced[2, j]
        for k in range(N):
            if k != j:
                dx[j, j] += kicks[k, 0] * g[1, j, k]
                dv[j, j] += kicks[k, 0] * g[2, j, k]
                dx[j, k] = -kicks[k, 0] * g[1, j, k]
                dv[j, k] = -kicks[k, 0] * g[2, j, k]
    leaves = zero_matrix(N, N)
    comes = zero_matrix(N, N)
    for j in range(N):
        n = after[j]
        if n != j:
            longer = -(states[n, 2] - states[j, 2]) / (dt[j] * dt[j]) + 0.5 * G
            for k in range(N):
                leaves[j, k] = (dx[n, k] - dx[j, k]) / dt[j]
            leaves[j, n] += longer
            leaves[j, j] -= longer
        for k in range(N):
            comes[n, k] = leaves[j, k]
        if n != j:
            comes[n, n] -= G
            comes[n, j] += G
    moved = new_matrix(N, N)
    through = new_matrix(N, N)
    for j in range(N):
        b = before[j]
        e, gain, keep, _ = ball_of(c, abs(side[j]))
        states[j, 3] = w[b] - G * dt[b]
        defect[j] = w[j] - gain * states[j, 1] - keep * states[j, 3]
        for k in range(N):
            moved[j, k] = -e * (dv[j, k] - comes[j, k])
            slope[j, k] = leaves[j, k] - gain * dv[j, k] - keep * comes[j, k]
            through[j, k] = ball[j, k] - gain * g[1, j, k] - keep * ball[b, k]
    eliminate(again, moved)
    for j in range(N):
        for k in range(N):
            for i in range(N):
                slope[j, k] += through[j, i] * moved[i, k]
    return True, defect, slope, states
