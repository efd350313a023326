"""Disturbances of the frame and of several balls, (x1, v1, x2_1, v2_1, …), at fixed time.

At an impact the balls that ride are kicked off or struck: they follow the frame until the disturbed impact and fly
freely after it. Of balls that are struck at once disturbances are taken that keep them together: at others the flow is
discontinuous.
"""

from __future__ import annotations

from vines.dynamics._advance import A_V1, A_V2, IMPACT, KIND, PHASE, RUN, SIDE, STICK, V1, V2, X1, X2
from vines.dynamics._flight import derivatives, flight
from vines.dynamics._impact_law import after_impact_kernel
from vines.dynamics._tangent import carry_basis, directions, flow_basis, jump_basis, offset, swing, swing_of
from vines.dynamics.parallel._constants import (
    BETA,
    MU,
    ParallelConstants,
    R,
    frame_with,
    law_of_ball,
    of_ball,
    riding,
)
from vines.dynamics.parallel._layout import BALL, BEFORE, R_V2
from vines.kernels import fused_njit, linked_njit, njit

__all__: list[str] = []

carry_basis.register(ParallelConstants)(carry_basis.first)


@directions.register(ParallelConstants)
@njit
def _directions(c):
    return range(2 + 2 * c.balls)


@flow_basis.register(ParallelConstants)
@fused_njit
def _flow_basis(c, mode, tau, Y):
    if tau == 0.0:
        # Between two events of one instant who still counts as riding is on the point of being kicked off or struck.
        return
    o = c.free.own if mode == 0.0 else frame_with(c, mode).own
    ride = int(abs(mode))
    sine, cosine = swing_of(o, tau)
    for j in range(Y.shape[1]):
        swing(o, sine, cosine, Y, j)
        for i in range(c.balls):
            if ride & (1 << i):
                Y[2 + 2 * i, j], Y[3 + 2 * i, j] = Y[0, j], Y[1, j]
            else:
                Y[2 + 2 * i, j] += tau * Y[3 + 2 * i, j]


@njit
def _acceleration(c, o, row, v):
    return derivatives(o, c.Omega, *flight(c, o, row[X1], v, row[PHASE], 0.0))[2]


@linked_njit
def _struck_at_once(c, row, group, ride, Y):
    """Apply an impact of a group of balls, of which this is the first row: the others are as they were before."""
    b = int(row[BALL]) - 1
    v1, after1 = row[V1], row[A_V1]
    a = _acceleration(c, frame_with(c, row[BEFORE]), row, v1)
    a_after = _acceleration(c, c.free, row, after1)
    closing = v1 - row[V2]
    for j in range(Y.shape[1]):
        shift = (Y[0, j] - Y[2 + 2 * b, j]) / closing if closing != 0.0 else 0.0
        x1, w1 = Y[0, j] - v1 * shift, Y[1, j] - a * shift
        momentum, mass = 0.0, 1.0
        for i in range(c.balls):
            if group & (1 << i):
                mu = of_ball(c.each, i, MU)
                momentum += mu * (1.0 + of_ball(c.each, i, R)) * (w1 - (Y[3 + 2 * i, j] + c.G * shift))
                mass += mu
            elif ride & (1 << i):
                Y[3 + 2 * i, j] = Y[1, j] - (a + c.G) * shift
        after = w1 - momentum / mass
        for i in range(c.balls):
            if group & (1 << i):
                r, v2 = of_ball(c.each, i, R), row[V2] if i == b else row[R_V2 + 2 * i]
                Y[2 + 2 * i, j] += (after1 + r * (v1 - v2) - v2) * shift
                Y[3 + 2 * i, j] = after + r * (w1 - (Y[3 + 2 * i, j] + c.G * shift)) - c.G * shift
        Y[0, j] = x1 + after1 * shift
        Y[1, j] = after + a_after * shift


@jump_basis.register(ParallelConstants)
@linked_njit
def _jump_basis(c, row, Y):
    b = int(row[BALL]) - 1
    before = row[BEFORE]
    ride = int(abs(before))
    if row[KIND] == IMPACT and row[RUN] != 0.0:
        if row[RUN] > 0.0:
            _struck_at_once(c, row, int(row[RUN]), ride, Y)
    elif row[KIND] == IMPACT:
        v1, v2 = row[V1], row[V2]
        law = law_of_ball(c.each, b)
        after1, after2 = after_impact_kernel(law, v1, v2)
        o = frame_with(c, before)
        a = _acceleration(c, o, row, v1)
        kicked = row[A_V1] != v1
        a_after = _acceleration(c, c.free if kicked else o, row, after1)
        closing = v1 - v2
        for j in range(Y.shape[1]):
            shift = (Y[0, j] - Y[2 + 2 * b, j]) / closing if closing != 0.0 else 0.0
            for i in range(c.balls):
                if kicked and ride & (1 << i):
                    Y[3 + 2 * i, j] = Y[1, j] - (a + c.G) * shift
            x1, w1 = Y[0, j] - v1 * shift, Y[1, j] - a * shift
            x2, w2 = Y[2 + 2 * b, j] - v2 * shift, Y[3 + 2 * b, j] + c.G * shift
            w1, w2 = after_impact_kernel(law, w1, w2)
            Y[0, j] = x1 + after1 * shift
            Y[1, j] = w1 + a_after * shift
            Y[2 + 2 * b, j] = x2 + after2 * shift
            Y[3 + 2 * b, j] = w2 - c.G * shift
    elif row[KIND] == STICK:
        mass, mu = 1.0 + riding(c, before), of_ball(c.each, b, MU)
        share = 1.0 / (mass + mu)
        # As for one ball: the rest of the chatter closes the gap of a disturbed run, and the damper acts meanwhile.
        damped = c.lam * mu * share * share
        for j in range(Y.shape[1]):
            x = share * (mass * Y[0, j] + mu * Y[2 + 2 * b, j])
            v = share * (mass * Y[1, j] + mu * Y[3 + 2 * b, j]) + damped * (Y[0, j] - Y[2 + 2 * b, j])
            Y[0, j], Y[1, j] = x, v
            for i in range(c.balls):
                if i == b or ride & (1 << i):
                    Y[2 + 2 * i, j], Y[3 + 2 * i, j] = x, v


@offset.register(ParallelConstants)
@njit
def _offset(c, row, event, late, scale, away):
    b = int(row[BALL]) - 1
    v1, v2 = event[V1], event[V2]
    after1, after2 = after_impact_kernel(law_of_ball(c.each, b), v1, v2)
    a = _acceleration(c, c.free, event, after1)
    for i in range(away.shape[0]):
        away[i] = 0.0
    # Of the other balls the closing equations give no state here.
    away[0] = (row[X1] - event[X1] - after1 * late) / scale
    away[1] = (row[A_V1] - after1 - a * late) / scale
    away[2 + 2 * b] = (row[X2] - (event[X1] - event[SIDE] * of_ball(c.each, b, BETA)) - after2 * late) / scale
    away[3 + 2 * b] = (row[A_V2] - after2 + c.G * late) / scale
