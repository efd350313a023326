"""One pass over the flights of a closed orbit: Jacobians, how well it closes, and whether it is admissible."""

from __future__ import annotations

import math

from vines.dynamics.kernels import (
    Constants,
    after_impact_kernel,
    derivatives,
    directions,
    free_ball,
    jacobian_kernel,
    launched,
    pull,
    relative,
    segment_state,
    tangent_product,
    turn,
)
from vines.dynamics.kernels import rows as col
from vines.kernels import by_type, copy_values, linked_njit, new_cube, njit
from vines.orbits._turning import turning_points_kernel

__all__ = ["NO_TURNING", "inspect_flight", "inspect_row", "survey_kernel", "survey_rows"]

NO_TURNING = 2.0
"""Clearance of an orbit whose flights never turn back: the width of the cavity."""


@njit
def _gap(c, motion, x2, v2, tau):
    """Return w, w', w'' at tau."""
    x, v, a, _, _ = derivatives(c.free, c.Omega, *turn(c.free, c.Omega, *motion, tau))
    way, speed = free_ball(c, v2, tau)
    return x - (x2 + way), v - speed, pull(c, a)


@njit
def _crossing(c, beta, motion, x2, v2, side, inside, outside):
    """Return the time in [inside, outside] at which a monotone gap passes the wall."""
    for _ in range(200):
        mid = 0.5 * (inside + outside)
        if mid <= inside or mid >= outside:
            break
        if side * _gap(c, motion, x2, v2, mid)[0] < beta:
            inside = mid
        else:
            outside = mid
    return outside


@linked_njit
def inspect_flight(c, beta, side, x1, v1, x2, v2, phase, tau):
    """Inspect a flight in a cavity of half length beta that starts at `side`, or at no wall (0), and lasts tau.

    Returns
    -------
    (clearance, violation, wall)
        Least distance of a turning point to the wall it points at, negative beyond it; time and side of the
        first contact within the flight, nan and 0 if there is none.
    """
    motion = launched(c, c.free, x1, v1, v2, phase, 0.0)
    seen = relative(c)
    _, speed, push = _gap(seen, motion, x2, v2, 0.0)
    clearance = NO_TURNING
    violation = math.nan
    wall = 0
    if side != 0 and (side * speed > 0.0 or (speed == 0.0 and side * push >= 0.0)):
        violation = 0.0
        wall = side
    before = 0.0
    for at in turning_points_kernel(seen, motion, v2, tau):
        w, _, bend = _gap(seen, motion, x2, v2, at)
        towards = 1 if bend < 0.0 else -1
        distance = beta - towards * w
        clearance = min(clearance, distance)
        if distance <= 0.0 and wall == 0:
            wall = towards
            violation = _crossing(seen, beta, motion, x2, v2, towards, before, at)
        before = at
    return clearance, violation, wall


@by_type(Constants)
@linked_njit
def survey_kernel(c, duration, side, t, states):
    """Fly a closed orbit once, flight by flight from its stored states.

    Parameters
    ----------
    c : vines.dynamics._constants.Constants
    duration : float
        Period of the orbit, pT.
    side : (N,) int array
    t : (N,) float array
        Times of the impacts, increasing within one period; the phase of the forcing is zero at t = 0.
    states : (N, 4) float array
        x1, v1, x2, v2 just before each impact.

    Returns
    -------
    jacobians : (N, d, d) float array
        Saltation Jacobians of the maps from each impact to the next.
    residual : float
        Largest difference, in any component, of where a flight ends to the state stored there.
    clearance : float
        Least signed distance of a turning point of the gap to the wall it points at, NO_TURNING without one.
    violation, wall : float, int
        Time and side of the first contact within a flight, nan and 0 if there is none.
    """
    N = t.size
    jacobians = new_cube(N, 4, 4)
    residual = 0.0
    clearance = NO_TURNING
    violation = math.nan
    wall = 0
    for j in range(N):
        k = (j + 1) % N
        tau = (t[k] - t[j]) if k > 0 else (t[0] + duration - t[j])
        phase = (c.Omega * t[j]) % (2.0 * math.pi)
        x1, v1, x2, v2 = states[j, 0], states[j, 1], states[j, 2], states[j, 3]
        J, x1n, v1n, v2n = jacobian_kernel(c.mu, c.A, c.Omega, c.r, c.lam, x1, v1, v2, phase, tau)
        for i in range(4):
            copy_values(jacobians[j, i], J[i])
        residual = max(
            residual,
            abs(x1 - x2 - side[j]),
            abs(x1n - states[k, 0]),
            abs(v1n - states[k, 1]),
            abs(x2 + v2n * tau - states[k, 2]),
            abs(v2n - states[k, 3]),
        )
        after, _ = after_impact_kernel(c.law, v1, v2)
        distance, when, where = inspect_flight(c, 1.0, side[j], x1, after, x2, v2n, phase, tau)
        clearance = min(clearance, distance)
        if where != 0 and wall == 0:
            violation = t[j] + when
            wall = where
        if side[k] * (states[k, 1] - states[k, 3]) <= 0.0 and wall == 0:
            violation = t[j] + tau
            wall = side[k]
    return jacobians, residual, clearance, violation, wall


@by_type(Constants)
@njit
def inspect_row(c, side, row, tau):
    """Inspect the flight after a row as `inspect_flight` does, in a cavity of half length 1."""
    return inspect_flight(c, 1.0, side, row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2], row[col.PHASE], tau)


@linked_njit
def survey_rows(c, rows, side):
    """Return the same of an orbit of one ball given by its rows; its Jacobians are tangent maps at fixed times."""
    N = side.size
    jacobians = new_cube(N, len(directions(c)), len(directions(c)))
    residual = 0.0
    clearance = NO_TURNING
    violation = math.nan
    wall = 0
    for j in range(N):
        row, following = rows[j], rows[j + 1]
        Y = tangent_product(c, rows, j, j + 1)
        for i in range(Y.shape[0]):
            copy_values(jacobians[j, i], Y[i])
        tau = following[col.TAU]
        x1, v1, x2, v2, _ = segment_state(c, row, tau)
        residual = max(
            residual,
            abs(row[col.X1] - row[col.X2] - side[j]),
            abs(x1 - following[col.X1]),
            abs(v1 - following[col.V1]),
            abs(x2 - following[col.X2]),
            abs(v2 - following[col.V2]),
        )
        distance, when, where = inspect_row(c, side[j], row, tau)
        clearance = min(clearance, distance)
        if where != 0 and wall == 0:
            violation, wall = row[col.TIME] + when, where
        arrives = side[(j + 1) % N]
        if arrives * (following[col.V1] - following[col.V2]) <= 0.0 and wall == 0:
            violation, wall = following[col.TIME], arrives
    return jacobians, residual, clearance, violation, wall
