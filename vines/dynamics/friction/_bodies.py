"""Energies and disturbances of a ball that slides."""

from __future__ import annotations

from vines.dynamics._advance import IMPACT, KIND, PHASE, RUN, SIDE, SLIDE, STICK, STOP, V1, X1
from vines.dynamics._flight import derivatives, launched
from vines.dynamics._integrals import segment_integrals
from vines.dynamics._tangent import carry_basis, directions, flow_basis, jump_basis, offset, swing, swing_of
from vines.dynamics._totals import (
    add_segment,
    ball_mass,
    base_at,
    event_loss,
    event_work,
    segment_state,
    state_energy,
    stored_energy,
    window_totals,
)
from vines.dynamics._travel import add_travel, merged, offset_of_travel, struck, travel_integrals
from vines.dynamics.friction._constants import FrictionConstants
from vines.dynamics.friction._motion import sliding
from vines.kernels import fused_njit, linked_njit, njit

__all__: list[str] = []

for _name in (window_totals, ball_mass, base_at, carry_basis, directions, event_loss, event_work, segment_state):
    _name.register(FrictionConstants)(_name.first)

segment_integrals.register(FrictionConstants)(travel_integrals)
add_segment.register(FrictionConstants)(add_travel)
offset.register(FrictionConstants)(offset_of_travel)


@stored_energy.register(FrictionConstants)
@njit
def _stored_energy(c, x1, v1, x2, v2, phase):
    return state_energy(c, x1, v1, v2, phase) + c.mu * c.G * x2


@flow_basis.register(FrictionConstants)
@fused_njit
def _flow_basis(c, mode, tau, Y):
    o = c.stuck.own if mode != 0.0 else c.free.own
    sine, cosine = swing_of(o, tau)
    for j in range(4):
        x = Y[0, j]
        swing(o, sine, cosine, Y, j)
        if mode != 0.0:
            # A disturbed run stops elsewhere in the cavity, and stays as far away.
            Y[2, j] += Y[0, j] - x
            Y[3, j] = Y[1, j]
        else:
            Y[2, j] += tau * Y[3, j]


@jump_basis.register(FrictionConstants)
@linked_njit
def _jump_basis(c, row, Y):
    if row[KIND] == IMPACT:
        struck(c, row, Y)
    elif row[KIND] == STICK:
        merged(c, Y)
    elif row[KIND] == STOP or (row[KIND] == SLIDE and row[RUN] == 0.0):
        x, v, phase = row[X1], row[V1], row[PHASE]
        came = row[SIDE] if row[KIND] == STOP else -row[SIDE]
        before = derivatives(c.free, c.Omega, *sliding(c, c.free, x, v, v, phase, came))[2]
        push = before - (c.friction * came - c.G)
        if row[KIND] == STOP:
            after = derivatives(c.stuck, c.Omega, *launched(c, c.stuck, x, v, v, phase, 0.0))[2]
            other = after
        else:
            after = derivatives(c.free, c.Omega, *sliding(c, c.free, x, v, v, phase, -came))[2]
            other = -c.friction * came - c.G
        for j in range(4):
            # The disturbed run comes to w' = 0 later by this; until then it has the one acceleration, then the other.
            late = -(Y[1, j] - Y[3, j]) / push if push != 0.0 else 0.0
            Y[1, j] += (before - after) * late
            Y[3, j] += (c.friction * came - c.G - other) * late
        if row[KIND] == STOP:
            for j in range(4):
                Y[3, j] = Y[1, j]
