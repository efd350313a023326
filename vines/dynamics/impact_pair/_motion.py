"""Motion of the capsule and of a free ball in it, and what is certain of them.

The ball is followed in the frame of the laboratory, in which it falls along the axis with x2'' = -G; the gap is
w = x1 - x2 as everywhere.
"""

from __future__ import annotations

import math

from vines.dynamics._advance import A_V2, IMPACT, KIND, SIDE, STICK, V1, V2, X1, X2, advance, begin, law_of
from vines.dynamics._contact import next_contact
from vines.dynamics._flight import (
    ball_flown,
    derivatives,
    drift,
    fifth,
    flight,
    flown,
    forced_fifth,
    fourth_bound,
    free_ball,
    launched,
    phase_after,
    pull,
    rate_alone,
    relative,
    ringing,
    sixth,
    speed_terms,
    terms,
    turn,
)
from vines.dynamics._impact_law import after_impact_kernel
from vines.dynamics._sincos import sincos
from vines.dynamics._sticking import holds_for, next_release
from vines.dynamics._tangent import carry_basis, directions, flow_basis, jump_basis, offset
from vines.dynamics._tilt import falling_ball, pull_of_tilt
from vines.dynamics._window import width_of, write_end
from vines.dynamics.impact_pair._constants import Capsule, PairConstants, PairTable
from vines.kernels import fused_njit, njit

__all__: list[str] = []

for _name in (
    advance,
    begin,
    carry_basis,
    write_end,
    law_of,
    next_contact,
    next_release,
    flown,
    launched,
    ball_flown,
    phase_after,
    drift,
    rate_alone,
    relative,
):
    _name.register(PairConstants)(_name.first)

width_of.register(PairTable)(width_of.first)


@flight.register(PairConstants)
@fused_njit
def _flight(c, o, x, v, phase, t):
    sine, cosine = sincos(phase)
    return o.B * sine, o.B * cosine


@turn.register(Capsule)
@fused_njit
def _turn(o, Omega, x, v, tau):
    sine, cosine = sincos(tau)
    return cosine * x + sine * v, cosine * v - sine * x


@derivatives.register(Capsule)
@fused_njit
def _derivatives(o, Omega, x, v):
    return x, v, -x, -v, x


@fifth.register(Capsule)
@fused_njit
def _fifth(o, x, v):
    return v, x


@sixth.register(Capsule)
@fused_njit
def _sixth(o, x, v):
    return -x


@terms.register(Capsule)
@fused_njit
def _terms(o, x, v):
    return 1.0 + abs(x) + abs(v)


@forced_fifth.register(PairConstants)
@fused_njit
def _forced_fifth(c, x, v):
    return 0.0


@fourth_bound.register(PairConstants)
@fused_njit
def _fourth_bound(c, x, v, window):
    return c.B


@speed_terms.register(PairConstants)
@njit
def _speed_terms(c, x, v):
    return abs(x) + abs(v) + abs(c.G)


@holds_for.register(PairConstants)
@fused_njit
def _holds_for(c, x, v):
    return math.inf


free_ball.register(PairConstants)(falling_ball)
pull.register(PairConstants)(pull_of_tilt)


@ringing.register(PairConstants)
@njit
def _ringing(c, x1, v1, v2, phase):
    return 0.0


@directions.register(PairConstants)
@njit
def _directions(c):
    return 0, 0


@flow_basis.register(PairConstants)
@fused_njit
def _flow_basis(c, mode, tau, Y):
    for j in range(2):
        if mode == 0.0:
            Y[0, j] += tau * Y[1, j]


@jump_basis.register(PairConstants)
@fused_njit
def _jump_basis(c, row, Y):
    if row[KIND] == IMPACT:
        v1, v2 = row[V1], row[V2]
        _, after = after_impact_kernel(c.law, v1, v2)
        closing = v1 - v2
        for j in range(2):
            shift = -Y[0, j] / closing if closing != 0.0 else 0.0
            x2 = Y[0, j] - v2 * shift
            _, w2 = after_impact_kernel(c.law, row[X1] * shift, Y[1, j] + c.G * shift)
            Y[0, j] = x2 + after * shift
            Y[1, j] = w2 - c.G * shift
    elif row[KIND] == STICK:
        for j in range(2):
            Y[0, j] = 0.0
            Y[1, j] = 0.0


@offset.register(PairConstants)
@njit
def _offset(c, row, event, late, scale, away):
    _, after = after_impact_kernel(c.law, event[V1], event[V2])
    away[0] = (row[X2] - (event[X1] - event[SIDE]) - after * late) / scale
    away[1] = (row[A_V2] - after + c.G * late) / scale
