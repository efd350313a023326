"""Energies of the impact pair, per unit of the ball's mass: what it is given by the capsule and loses in impacts."""

from __future__ import annotations

from vines.dynamics import _totals as entry
from vines.dynamics._advance import A_V2, V1, V2
from vines.dynamics._flight import flight, turn
from vines.dynamics._integrals import segment_integrals
from vines.dynamics._totals import (
    add_integrals,
    add_segment,
    ball_mass,
    base_at,
    event_loss,
    event_work,
    segment_state,
    stored_energy,
    window_totals,
)
from vines.dynamics.impact_pair._constants import PairConstants
from vines.kernels import linked_njit, njit

__all__: list[str] = []


for _name in (segment_state, window_totals):
    _name.register(PairConstants)(_name.first)


@ball_mass.register(PairConstants)
@njit
def _ball_mass(c):
    return 1.0


@base_at.register(PairConstants)
@njit
def _base_at(c, phase):
    return flight(c, c.free, 0.0, 0.0, phase, 0.0)[0]


@stored_energy.register(PairConstants)
@njit
def _stored_energy(c, x1, v1, x2, v2, phase):
    return 0.5 * v2 * v2 + c.G * x2


@event_loss.register(PairConstants)
@njit
def _event_loss(c, row):
    before, after = row[V1] - row[V2], row[V1] - row[A_V2]
    return 0.5 * (before - after) * (before + after)


@event_work.register(PairConstants)
@njit
def _event_work(c, row):
    # The wall, which keeps its velocity, gives the ball this much momentum.
    return row[V1] * (row[A_V2] - row[V2])


@segment_integrals.register(PairConstants)
@linked_njit
def _segment_integrals(c, mode, x1, v1, v2, phase, length):
    start = flight(c, c.free, x1, v1, phase, 0.0)
    end = turn(c.free, 1.0, *start, length)
    steady = c.B * c.B * length
    swing = end[0] * end[1] - start[0] * start[1]
    x_square, v_square = 0.5 * (steady - swing), 0.5 * (steady + swing)
    if mode != 0.0:
        work = 0.5 * (end[1] * end[1] - start[1] * start[1]) + c.G * (end[0] - start[0])
        return x_square, v_square, v_square, work, 0.0
    fall = c.G * length
    return x_square, v_square, length * (v2 * v2 - fall * (v2 - fall / 3.0)), 0.0, 0.0


@add_segment.register(PairConstants)
@linked_njit
def _add_segment(c, out, mode, begins, x1, v1, x2, v2, phase, length):
    x_square, v_square, ball, work, loss = segment_integrals(c, mode, x1, v1, v2, phase, length)
    add_integrals(out, length, x_square, v_square, ball, work, loss)
    # The capsule swings by itself: nothing is to be searched for.
    out[entry.MAX_ABS_X1] = c.B
