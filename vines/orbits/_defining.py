"""Defining equations of bifurcations as kernels of bare parameter values: what is appended to the closing equations.

M is the Jacobian over the period, or H of the half period for a symmetric orbit. Determinants of M, and of its second
compound, whose eigenvalues are the products of pairs, are smooth where multipliers meet (docs/orbits.md, "Curves").
"""

from __future__ import annotations

import math

from vines.dynamics.kernels import (
    after_impact_kernel,
    derivatives,
    impact_law_kernel,
    jacobian_kernel,
    oscillator,
    phasors,
    turn,
)
from vines.kernels import identity, linked_njit, new_matrix, zero_matrix
from vines.model import AMPLITUDE, DAMPING, FREQUENCY, MASS, RESTITUTION, V1, V2, X1, X2
from vines.orbits._elimination import eliminate
from vines.orbits._turning import turning_points_kernel

__all__ = ["FLIP", "FOLD", "GRAZE", "STOP", "TORUS", "condition_kernel", "gap_kernel", "turnings_kernel"]

FOLD, FLIP, TORUS, GRAZE, STOP = range(5)
"""Codes of the defining equations: a multiplier +1, -1, a pair of product 1, a turning point on a wall, w' = 0."""


@linked_njit
def _product(left, right):
    """Return the product of two matrices of 4 by 4: BLAS takes a second to compile into a kernel."""
    out = zero_matrix(4, 4)
    for i in range(4):
        for j in range(4):
            for k in range(4):
                out[i, j] += left[i, k] * right[k, j]
    return out


@linked_njit
def _period_map(values, duration, side, t, states, half):
    """Return M, or H where `half`, of an orbit with these impacts."""
    mu, A, Omega = values[MASS], values[AMPLITUDE], values[FREQUENCY]
    r, lam = values[RESTITUTION], values[DAMPING]
    product = identity(4)
    for j in range(t.size // 2 if half else t.size):
        tau = t[j + 1] - t[j] if j + 1 < t.size else t[0] + duration - t[j]
        x1, v1, v2 = states[j, X1], states[j, V1], states[j, V2]
        J = jacobian_kernel(mu, A, Omega, r, lam, x1, v1, v2, Omega * t[j], tau)[0]
        product = _product(J, product)
    if half:
        for i in range(3):
            for k in range(4):
                product[i, k] = -product[i, k]
    return product


@linked_njit
def _determinant_of_one_and(M, sign):
    """Return det(I + sign M)."""
    n = M.shape[0]
    matrix = new_matrix(n, n)
    for i in range(n):
        for k in range(n):
            matrix[i, k] = sign * M[i, k] + (1.0 if i == k else 0.0)
    return eliminate(matrix, new_matrix(n, 0))[1]


@linked_njit
def _without_pair(M):
    """Return det(I - C), C the second compound of M: the product of 1 - m_i m_j over all pairs."""
    rows = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
    C = new_matrix(6, 6)
    for a in range(6):
        i, j = rows[a]
        for b in range(6):
            k, m = rows[b]
            C[a, b] = M[i, k] * M[j, m] - M[i, m] * M[j, k]
    return _determinant_of_one_and(C, -1.0)


@linked_njit
def gap_kernel(values, t, states, flight, tau):
    """Return w, w' and w'' at time tau of a flight."""
    Omega = values[FREQUENCY]
    free = oscillator(1.0, values[AMPLITUDE], Omega, values[DAMPING])
    x1, v1, x2, v2 = states[flight, X1], states[flight, V1], states[flight, X2], states[flight, V2]
    after, ball = after_impact_kernel(impact_law_kernel(values[MASS], values[RESTITUTION]), v1, v2)
    zr, zi, qr, qi = phasors(free, Omega, x1, after, (Omega * t[flight]) % (2.0 * math.pi))
    zr, zi, qr, qi = turn(free, Omega, zr, zi, qr, qi, tau)
    x, v, a, _, _ = derivatives(free, Omega, zr, zi, qr, qi)
    return x - x2 - ball * tau, v - ball, a


@linked_njit
def condition_kernel(kind, values, p, side, t, states, half, place, wall, tau):
    """Return the two numbers of which the first, and for GRAZE also the second, vanishes at the bifurcation.

    Parameters
    ----------
    kind : int
        FOLD, FLIP, TORUS, GRAZE or STOP.
    values : (5,) float array
    p : int
    side, t, states
        The impacts of the orbit.
    half : bool
        Whether multipliers are those of the half map.
    place : int
        The flight that turns at the wall (GRAZE), or the impact of no speed (STOP).
    wall : int
        The wall that is touched (GRAZE).
    tau : float
        Time since the start of the flight at which it turns (GRAZE).
    """
    if kind == GRAZE:
        w, speed, _ = gap_kernel(values, t, states, place, tau)
        return w - wall, speed
    if kind == STOP:
        return states[place, V1] - states[place, V2], 0.0
    M = _period_map(values, 2.0 * math.pi * p / values[FREQUENCY], side, t, states, half)
    squares = 0.0
    for i in range(4):
        for k in range(4):
            squares += M[i, k] * M[i, k]
    size = 1.0 + math.sqrt(squares)
    if kind == TORUS:
        return _without_pair(M) / (size * size), 0.0
    return _determinant_of_one_and(M, -1.0 if kind == FOLD else 1.0) / size, 0.0


@linked_njit
def turnings_kernel(c, duration, t, states):
    """Return all turning points of the gap, rows of flight, time since its start, wall it points at, clearance, w''.

    Parameters
    ----------
    c : vines.dynamics._constants.Constants
    duration : float
    t : (N,) float array
    states : (N, 4) float array
    """
    rows = []
    for j in range(t.size):
        tau = t[j + 1] - t[j] if j + 1 < t.size else t[0] + duration - t[j]
        x1, v1, x2, v2 = states[j, X1], states[j, V1], states[j, X2], states[j, V2]
        after, ball = after_impact_kernel(c.law, v1, v2)
        phase = (c.Omega * t[j]) % (2.0 * math.pi)
        motion = phasors(c.free, c.Omega, x1, after, phase)
        for at in turning_points_kernel(c, motion, ball, tau):
            x, _, bend, _, _ = derivatives(c.free, c.Omega, *turn(c.free, c.Omega, *motion, at))
            wall = 1.0 if bend < 0.0 else -1.0
            rows.append((float(j), at, wall, 1.0 - wall * (x - x2 - ball * at), bend))
    out = new_matrix(len(rows), 5)
    for i in range(len(rows)):
        for k in range(5):
            out[i, k] = rows[i][k]
    return out
