"""Disturbances of (x1, v1, x2, v2) at fixed time of a ball that is dragged."""

from __future__ import annotations

from vines.dynamics._advance import A_V1, A_V2, IMPACT, KIND, PHASE, SIDE, STICK, V1, V2, X1, X2
from vines.dynamics._flight import derivatives, launched, turn
from vines.dynamics._impact_law import after_impact_kernel
from vines.dynamics._tangent import directions, flow_basis, jump_basis, offset
from vines.dynamics.drag._constants import DragConstants
from vines.dynamics.drag._motion import ball_velocity, set_out
from vines.kernels import fused_njit, linked_njit, njit

__all__: list[str] = []

directions.register(DragConstants)(directions.first)


@flow_basis.register(DragConstants)
@fused_njit
def _flow_basis(c, mode, tau, Y):
    o = c.stuck if mode != 0.0 else c.free
    for j in range(4):
        now = turn(o, c.Omega, *set_out(o, Y[0, j], Y[1, j], Y[3, j], 0.0, 0.0), tau)
        Y[0, j], Y[1, j], _, _, _ = derivatives(o, c.Omega, *now)
        if mode != 0.0:
            Y[2, j], Y[3, j] = Y[0, j], Y[1, j]
        else:
            Y[2, j] += now[5]
            Y[3, j] = ball_velocity(o, *now)


@njit
def _accelerations(c, x1, v1, v2, phase):
    a = derivatives(c.free, c.Omega, *launched(c, c.free, x1, v1, v2, phase, 0.0))[2]
    return a, c.delta * (v1 - v2)


@jump_basis.register(DragConstants)
@linked_njit
def _jump_basis(c, row, Y):
    x1, v1, v2 = row[X1], row[V1], row[V2]
    if row[KIND] == IMPACT:
        after1, after2 = after_impact_kernel(c.law, v1, v2)
        a1, a2 = _accelerations(c, x1, v1, v2, row[PHASE])
        b1, b2 = _accelerations(c, x1, after1, after2, row[PHASE])
        closing = v1 - v2
        for j in range(4):
            shift = (Y[0, j] - Y[2, j]) / closing if closing != 0.0 else 0.0
            w1, w2 = after_impact_kernel(c.law, Y[1, j] - a1 * shift, Y[3, j] - a2 * shift)
            Y[0, j] += (after1 - v1) * shift
            Y[1, j] = w1 + b1 * shift
            Y[2, j] += (after2 - v2) * shift
            Y[3, j] = w2 + b2 * shift
    elif row[KIND] == STICK:
        share = 1.0 / (1.0 + c.mu)
        # As without drag, a force between the two: what is left of the chatter closes the gap of a disturbed run.
        damped = c.lam * c.mu * share * share
        for j in range(4):
            x = share * (Y[0, j] + c.mu * Y[2, j])
            v = share * (Y[1, j] + c.mu * Y[3, j]) + damped * (Y[0, j] - Y[2, j])
            Y[0, j] = Y[2, j] = x
            Y[1, j] = Y[3, j] = v


@offset.register(DragConstants)
@njit
def _offset(c, row, event, late, scale, away):
    x1, v1, v2 = event[X1], event[V1], event[V2]
    after1, after2 = after_impact_kernel(c.law, v1, v2)
    a1, a2 = _accelerations(c, x1, after1, after2, event[PHASE])
    away[0] = (row[X1] - x1 - after1 * late) / scale
    away[1] = (row[A_V1] - after1 - a1 * late) / scale
    away[2] = (row[X2] - (x1 - event[SIDE]) - after2 * late) / scale
    away[3] = (row[A_V2] - after2 - a2 * late) / scale
