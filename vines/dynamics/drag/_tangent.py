"""Disturbances of (x1, v1, x2, v2) at fixed time of a ball that is dragged."""

from __future__ import annotations

from vines.dynamics._advance import IMPACT, KIND, STICK
from vines.dynamics._flight import derivatives, turn
from vines.dynamics._tangent import directions, flow_basis, jump_basis, offset
from vines.dynamics._travel import merged, offset_of_travel, struck
from vines.dynamics.drag._constants import DragConstants
from vines.dynamics.drag._motion import ball_velocity, set_out
from vines.kernels import fused_njit, linked_njit

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


@jump_basis.register(DragConstants)
@linked_njit
def _jump_basis(c, row, Y):
    if row[KIND] == IMPACT:
        struck(c, row, Y)
    elif row[KIND] == STICK:
        merged(c, Y)


offset.register(DragConstants)(offset_of_travel)
