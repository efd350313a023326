"""The closing equations of one ball that is moved as it flies, from the closed forms of its flights alone.

Given the times of the impacts, flights and the law of impact are affine in (x1, v1, v2). That the motion closes fixes
these at the first impact; what remains is that each flight ends on its wall: N equations in the N times. Nothing but
the flow is used, so that they hold for any system with one ball (docs/orbits.md, "Any system").
"""

from __future__ import annotations

import math

from vines.dynamics.kernels import (
    after_impact_kernel,
    ball_flown,
    derivatives,
    flow_basis,
    launched,
    pull,
    relative,
    turn,
)
from vines.kernels import copy_values, identity, linked_njit, new_cube, new_matrix, new_vector, njit, zero_matrix
from vines.orbits._elimination import eliminate

__all__ = ["flown_closing"]

KEPT = (0, 1, 3)
"""Places of x1, v1, v2 among x1, v1, x2, v2: where the cavity lies changes nothing."""


@njit
def _rates(c, x1, v1, v2, phase):
    """Return the velocities and accelerations of both bodies in flight: the rates of x1, v1, x2, v2."""
    motion = launched(c, c.free, x1, v1, v2, phase, 0.0)
    seen = relative(c)
    a = derivatives(c.free, c.Omega, *motion)[2]
    return v1, a, v2, a - pull(seen, derivatives(seen.free, c.Omega, *motion)[2])


@njit
def _flown(c, x1, v1, v2, phase, tau):
    """Return x1, v1, v2 and the way of the ball after a flight."""
    motion = launched(c, c.free, x1, v1, v2, phase, 0.0)
    x, v, _, _, _ = derivatives(c.free, c.Omega, *turn(c.free, c.Omega, *motion, tau))
    way, speed = ball_flown(c, motion, v2, tau)
    return x, v, speed, way


@njit
def _struck(c, Y):
    """Apply the law of impact at fixed times to the columns of Y."""
    for j in range(Y.shape[1]):
        Y[1, j], Y[3, j] = after_impact_kernel(c.law, Y[1, j], Y[3, j])


@linked_njit
def flown_closing(c, duration, side, t):
    """Return the closing equations at given impact times; see `closing_kernel`.

    The defect of an impact is by how much the gap at the end of the flight after it misses the wall.
    """
    N = t.size
    defect = new_vector(N)
    slope = new_matrix(N, N)
    states = new_matrix(N, 4)
    lasts, phases = new_vector(N), new_vector(N)
    for j in range(N):
        lasts[j] = t[j + 1] - t[j] if j < N - 1 else t[0] + duration - t[j]
        phases[j] = (c.Omega * t[j]) % (2.0 * math.pi)

    # The whole round from a state of zeros, and what becomes of each of its numbers.
    x, v, w = 0.0, 0.0, 0.0
    whole = identity(4)
    for j in range(N):
        v, w = after_impact_kernel(c.law, v, w)
        x, v, w, _ = _flown(c, x, v, w, phases[j], lasts[j])
        _struck(c, whole)
        flow_basis(c, 0.0, lasts[j], whole)
    system, again = new_matrix(3, 3), new_matrix(3, 3)
    first = new_matrix(3, 1)
    first[0, 0], first[1, 0], first[2, 0] = x, v, w
    for i in range(3):
        for k in range(3):
            system[i, k] = again[i, k] = (1.0 if i == k else 0.0) - whole[KEPT[i], KEPT[k]]
    if not eliminate(system, first)[0]:
        return False, defect, slope, states

    # States, and each flight on its own: how it carries disturbances, and how fast all moves at its ends.
    flights = new_cube(N, 4, 4)
    begins, ends = new_matrix(N, 4), new_matrix(N, 4)
    x, v, w = first[0, 0], first[1, 0], first[2, 0]
    for j in range(N):
        wall = 1.0 if side[j] > 0 else -1.0
        states[j, 0], states[j, 1], states[j, 2], states[j, 3] = x, v, x - wall, w
        v, w = after_impact_kernel(c.law, v, w)
        begins[j, 0], begins[j, 1], begins[j, 2], begins[j, 3] = _rates(c, x, v, w, phases[j])
        x, v, w, way = _flown(c, x, v, w, phases[j], lasts[j])
        following = (j + 1) % N
        ends[j, 0], ends[j, 1], ends[j, 2], ends[j, 3] = _rates(c, x, v, w, phases[following])
        defect[j] = x - (states[j, 2] + way) - (1.0 if side[following] > 0 else -1.0)
        Y = identity(4)
        flow_basis(c, 0.0, lasts[j], Y)
        for i in range(4):
            copy_values(flights[j, i], Y[i])

    # Derivatives in the times: first with the state before the first impact held, which gives its own.
    moved = new_matrix(3, N)
    for after in (False, True):
        now = zero_matrix(4, N)
        if after:
            for i in range(3):
                for k in range(N):
                    now[KEPT[i], k] = moved[i, k]
        for j in range(N):
            following = (j + 1) % N
            if after:
                for k in range(N):
                    slope[j, k] = -now[0, k]
            _struck(c, now)
            for k in range(N):
                now[2, k] = 0.0
            for i in range(4):
                now[i, j] -= begins[j, i]
            carried = zero_matrix(4, N)
            for i in range(4):
                for k in range(N):
                    for m in range(4):
                        carried[i, k] += flights[j, i, m] * now[m, k]
                carried[i, following] += ends[j, i]
            now = carried
            if after:
                # The ball begins where its wall is: what moved that is in the first term.
                for k in range(N):
                    slope[j, k] += now[0, k] - now[2, k]
        if not after:
            for i in range(3):
                for k in range(N):
                    moved[i, k] = now[KEPT[i], k]
            eliminate(again, moved)
    return True, defect, slope, states
