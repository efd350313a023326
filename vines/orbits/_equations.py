"""The closing equations of an orbit of any word, with the unknown state eliminated linearly (docs/orbits.md).

Given the times of the impacts everything else is linear in the kicks d_j that the oscillator gets from the ball: the
impact law determines them, and that the ball's momentum jumps by the opposite of each kick is what remains: N
equations in the N times.
"""

from __future__ import annotations

import cmath
import math

from vines.dynamics.kernels import Constants
from vines.kernels import by_type, linked_njit, max_abs, new_cube, new_matrix, new_vector, njit, zero_matrix
from vines.orbits._elimination import eliminate
from vines.orbits._values import Essentials, essentials_of

__all__ = ["closing_kernel", "closing_unit", "newton_kernel", "prepared"]

_EPS = 2.220446049250313e-16


@by_type(Constants)
@njit
def prepared(c):
    """Return what the closing equations take of the constants."""
    return essentials_of(c)


@by_type(Constants)
@njit
def closing_unit(c):
    """Return the unit of the defects, and the size of the terms of which they are sums, in that unit."""
    return c.law.ratio, 1.0 + math.hypot(c.free.qr, c.free.qi)


@by_type(Essentials)
@linked_njit
def closing_kernel(c, duration, side, t):
    """Return the closing equations at given impact times, and what was eliminated on the way.

    Parameters
    ----------
    c : vines.orbits._values.Essentials
    duration : float
        Period pT.
    side : (N,) int array
        The walls; where there are several balls, each times the number of the ball.
    t : (N,) float array
        Impact times, increasing within one period.

    Returns
    -------
    regular : bool
        Whether the elimination went through.
    defect : (N,) float array
        ratio (v2⁺_j - v2_j) + d_j, zero on an orbit.
    slope : (N, N) float array
        Its derivatives in the times.
    states : (N, 4) float array
        x1, v1, x2, v2 just before each impact.
    """
    N = t.size
    gamma = c.gamma
    s = complex(-c.half, gamma)
    weight = 1.0 / (1.0 - cmath.exp(s * duration))
    q = complex(c.qr, c.qi)

    # g, g', g'' of t_j - t_k modulo the period; on the diagonal g(0), and g' just before the kick.
    g = new_cube(3, N, N)
    forced = new_matrix(3, N)
    for j in range(N):
        turned = q * cmath.exp(complex(0.0, c.Omega * t[j]))
        forced[0, j] = turned.real
        forced[1, j] = -c.Omega * turned.imag
        forced[2, j] = -c.Omega * c.Omega * turned.real
        for k in range(N):
            tau = t[j] - t[k] if j > k else t[j] - t[k] + duration
            kernel = weight * cmath.exp(s * tau)
            g[0, j, k] = kernel.imag / gamma
            g[1, j, k] = (s * kernel).imag / gamma
            g[2, j, k] = (s * s * kernel).imag / gamma

    # Ball: v2⁺_j = (x1_{j+1} - side_{j+1} - x1_j + side_j)/dt_j as rows over the kicks, plus a constant.
    dt = new_vector(N)
    ball = new_matrix(N, N)
    ball_0 = new_vector(N)
    for j in range(N):
        n = (j + 1) % N
        dt[j] = t[n] - t[j] if n > j else t[n] - t[j] + duration
        ball_0[j] = (forced[0, n] - side[n] - forced[0, j] + side[j]) / dt[j]
        for k in range(N):
            ball[j, k] = (g[0, n, k] - g[0, j, k]) / dt[j]

    # Impact law d_j + e (v1_j - v2_j) = 0 with v2_j = v2⁺_{j-1}, solved for the kicks.
    e = c.pass1
    law = new_matrix(N, N)
    kicks = new_matrix(N, 1)
    # Elimination overwrites what it is given, and the derivatives of the kicks need the same matrix.
    again = new_matrix(N, N)
    for j in range(N):
        b = j - 1 if j > 0 else N - 1
        kicks[j, 0] = -e * (forced[1, j] - ball_0[b])
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
        states[j, 0], states[j, 1], states[j, 2] = x, v, x - side[j]

    # Derivatives in the times with the kicks held, then the kicks' own.
    dx = zero_matrix(N, N)
    dv = zero_matrix(N, N)
    for j in range(N):
        dx[j, j] = forced[1, j]
        dv[j, j] = forced[2, j]
        for k in range(N):
            if k != j:
                dx[j, j] += kicks[k, 0] * g[1, j, k]
                dv[j, j] += kicks[k, 0] * g[2, j, k]
                dx[j, k] = -kicks[k, 0] * g[1, j, k]
                dv[j, k] = -kicks[k, 0] * g[2, j, k]
    dw = new_matrix(N, N)
    for j in range(N):
        n = (j + 1) % N
        for k in range(N):
            dw[j, k] = (dx[n, k] - dx[j, k]) / dt[j]
        dw[j, n] -= w[j] / dt[j]
        dw[j, j] += w[j] / dt[j]
    moved = new_matrix(N, N)
    momentum = new_matrix(N, N)
    for j in range(N):
        b = j - 1 if j > 0 else N - 1
        for k in range(N):
            moved[j, k] = -e * (dv[j, k] - dw[b, k])
            momentum[j, k] = c.ratio * (ball[j, k] - ball[b, k])
            slope[j, k] = c.ratio * (dw[j, k] - dw[b, k])
        momentum[j, j] += 1.0
        defect[j] = c.ratio * (w[j] - w[b]) + kicks[j, 0]
        states[j, 3] = w[b]
    eliminate(again, moved)
    for j in range(N):
        for k in range(N):
            for i in range(N):
                slope[j, k] += momentum[j, i] * moved[i, k]
    return True, defect, slope, states


@linked_njit
def newton_kernel(c, duration, side, t, iterations):
    """Solve the closing equations by damped Newton steps.

    Parameters
    ----------
    c : vines.dynamics._constants.Constants
    duration, side, t
        As for `closing_kernel`; the times to start from.
    iterations : int
        Most steps.

    Returns
    -------
    converged : bool
    t : (N,) float array
        The times at the end, whether converged or not.
    defect : float
        Largest defect there.
    states : (N, 4) float array
    """
    N = t.size
    begin, t, trial = t, new_vector(N), new_vector(N)
    for j in range(N):
        t[j] = begin[j]
    essential = prepared(c)
    unit, terms = closing_unit(c)
    regular, defect, slope, states = closing_kernel(essential, duration, side, t)
    size = max_abs(defect) if regular else math.inf
    # The equations are sums of parts as large as the steady motion without the ball.
    rounding = 8.0 * _EPS * unit * terms
    for _ in range(iterations):
        step = new_matrix(N, 1)
        for j in range(N):
            step[j, 0] = defect[j]
        if not regular or not math.isfinite(size) or not eliminate(slope, step)[0]:
            return False, t, size, states
        # No flight time may shrink to less than a fifth of itself in one step.
        share, largest = 1.0, 0.0
        for j in range(N):
            largest = max(largest, abs(step[j, 0]))
            n = (j + 1) % N
            dt = t[n] - t[j] if n > j else t[n] - t[j] + duration
            change = step[j, 0] - step[n, 0]
            if change < -0.8 * dt / share:
                share = -0.8 * dt / change
        while True:
            for j in range(N):
                trial[j] = t[j] - share * step[j, 0]
            regular, defect, slope, states = closing_kernel(essential, duration, side, trial)
            better = max_abs(defect) if regular else math.inf
            if better < size or share * largest < 1e-12 * duration or share < 1e-3:
                break
            share *= 0.5
        # Next to a bifurcation the steps stay larger than that, but the defect can't fall below its rounding.
        stalled = better >= 0.5 * size and better <= rounding
        for j in range(N):
            t[j] = trial[j]
        size = better
        if share * largest < 1e-13 * duration or stalled:
            return math.isfinite(size) and size < 1e-9 * unit, t, size, states
    return False, t, size, states
