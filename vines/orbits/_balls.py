"""What the closing equations need to know of balls in parallel cavities, and what an orbit of them looks like."""

from __future__ import annotations

import math

from vines.dynamics.kernels import after_impact_kernel, derivatives, flight, tangent_product, turn
from vines.dynamics.kernels import rows as col
from vines.dynamics.parallel import ParallelConstants
from vines.dynamics.parallel.kernels import BALL, BETA, R_V2, R_X2, law_of_ball, of_ball
from vines.kernels import copy_values, linked_njit, new_cube, njit, zero_matrix
from vines.orbits._budget import orbit_rows
from vines.orbits._chains import ball_of, chain_closing, gravity, response, response_of, steady, steady_of
from vines.orbits._equations import closing_kernel, closing_unit, prepared
from vines.orbits._survey import NO_TURNING, inspect_flight, survey_kernel

__all__: list[str] = []


@prepared.register(ParallelConstants)
@njit
def _prepared(c):
    return c


@closing_unit.register(ParallelConstants)
@njit
def _closing_unit(c):
    return 1.0, 1.0 + math.hypot(c.free.own.qr, c.free.own.qi)


closing_kernel.register(ParallelConstants)(chain_closing)


@steady.register(ParallelConstants)
@njit
def _steady(c, t):
    return steady_of(c.free.own, c.Omega, t)


@response.register(ParallelConstants)
@njit
def _response(c, duration, tau):
    return response_of(c.free.own, duration, tau)


@ball_of.register(ParallelConstants)
@njit
def _ball_of(c, number):
    law = law_of_ball(c.each, number - 1)
    return law.pass1, law.pass2, law.keep2, of_ball(c.each, number - 1, BETA)


@gravity.register(ParallelConstants)
@njit
def _gravity(c):
    return c.G


@orbit_rows.register(ParallelConstants)
@linked_njit
def _orbit_rows(c, duration, side, t, states):
    N = t.size
    rows = zero_matrix(N + 1, R_X2 + 2 * c.balls)
    for k in range(N + 1):
        j = k % N
        b = abs(side[j]) - 1
        row = rows[k]
        x1, v1, x2, v2 = states[j, 0], states[j, 1], states[j, 2], states[j, 3]
        row[col.KIND], row[col.SIDE], row[BALL] = col.IMPACT, (1.0 if side[j] > 0 else -1.0), b + 1.0
        row[col.TIME] = t[j] if k < N else t[0] + duration
        row[col.PHASE] = (c.Omega * t[j]) % (2.0 * math.pi)
        row[col.X1], row[col.V1], row[col.X2], row[col.V2] = x1, v1, x2, v2
        row[col.A_V1], row[col.A_V2] = after_impact_kernel(law_of_ball(c.each, b), v1, v2)
        if k > 0:
            row[col.TAU] = row[col.TIME] - rows[k - 1, col.TIME]
    # Where each ball is just after an impact follows from its own last one.
    for k in range(N + 1):
        j = k % N
        for b in range(c.balls):
            for back in range(N):
                i = (j - back) % N
                if abs(side[i]) == b + 1:
                    since = t[j] - t[i] if i <= j else t[j] - t[i] + duration
                    _, speed = after_impact_kernel(law_of_ball(c.each, b), states[i, 1], states[i, 3])
                    rows[k, R_X2 + 2 * b] = states[i, 2] + since * (speed - 0.5 * c.G * since)
                    rows[k, R_V2 + 2 * b] = speed - c.G * since
                    break
    rows[0, col.KIND] = col.START
    rows[0, col.V1], rows[0, col.V2] = rows[0, col.A_V1], rows[0, col.A_V2]
    return rows


@survey_kernel.register(ParallelConstants)
@linked_njit
def _survey(c, duration, side, t, states):
    rows = orbit_rows(c, duration, side, t, states)
    N, d = t.size, 2 + 2 * c.balls
    jacobians = new_cube(N, d, d)
    residual, clearance, violation, wall = 0.0, NO_TURNING, math.nan, 0
    for j in range(N):
        row, following = rows[j], rows[j + 1]
        Y = tangent_product(c, rows, j, j + 1)
        for i in range(d):
            copy_values(jacobians[j, i], Y[i])
        tau = following[col.TAU]
        arrives = side[(j + 1) % N]
        next_ball = abs(arrives) - 1
        for b in range(c.balls):
            own = (1 if side[j] > 0 else -1) if abs(side[j]) == b + 1 else 0
            distance, when, where = inspect_flight(
                c, of_ball(c.each, b, BETA), own, row[col.X1], row[col.A_V1],
                row[R_X2 + 2 * b], row[R_V2 + 2 * b], row[col.PHASE], tau,
            )  # fmt: skip
            clearance = min(clearance, distance)
            if where != 0 and wall == 0:
                violation, wall = row[col.TIME] + when, where
        x2, v2 = row[R_X2 + 2 * next_ball], row[R_V2 + 2 * next_ball]
        motion = flight(c, c.free, row[col.X1], row[col.A_V1], row[col.PHASE], 0.0)
        x1, v1, _, _, _ = derivatives(c.free, c.Omega, *turn(c.free, c.Omega, *motion, tau))
        residual = max(
            residual,
            abs(x1 - following[col.X1]),
            abs(v1 - following[col.V1]),
            abs(x2 + tau * (v2 - 0.5 * c.G * tau) - following[col.X2]),
            abs(v2 - c.G * tau - following[col.V2]),
        )
        towards = 1 if arrives > 0 else -1
        if towards * (following[col.V1] - following[col.V2]) <= 0.0 and wall == 0:
            violation, wall = following[col.TIME], towards
    return jacobians, residual, clearance, violation, wall
