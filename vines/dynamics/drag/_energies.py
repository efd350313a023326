"""Energies of a ball that is dragged: what base, damper, coil and impacts do.

Between events all is smooth, sums of exponentials of known rates: Gauss's rule over parts that are short against the
fastest of them integrates their products to rounding, next to resonance as anywhere.
"""

from __future__ import annotations

import math

from vines.dynamics import _totals as entry
from vines.dynamics._flight import derivatives, launched, turn
from vines.dynamics._integrals import NODES, WEIGHTS, peak_between, segment_integrals
from vines.dynamics._totals import (
    add_segment,
    ball_mass,
    base_at,
    event_loss,
    event_work,
    stored_energy,
    window_totals,
)
from vines.dynamics.drag._constants import DragConstants
from vines.dynamics.drag._motion import ball_velocity
from vines.kernels import linked_njit

__all__: list[str] = []

for _name in (window_totals, ball_mass, base_at, event_loss, event_work, stored_energy):
    _name.register(DragConstants)(_name.first)


@linked_njit
def _integrals(c, mode, motion, phase, length):
    """Return the integrals of x1², v1² and v2², the base work, and the losses in the damper and in the coil."""
    o = c.stuck if mode != 0.0 else c.free
    # Over 3/rate the rule of eight points is exact to rounding: 3^16/16! times 2e-10.
    parts = max(1.0, math.ceil(length * max(1.0, c.Omega, o.rho) / 1.5))
    part = length / parts
    x_square = v_square = ball = work = damped = dragged = 0.0
    for i in range(int(parts)):
        for k in range(8):
            tau = part * (i + 0.5 * (1.0 + (NODES[k // 2] if k % 2 else -NODES[k // 2])))
            weight = 0.5 * part * WEIGHTS[k // 2]
            now = turn(o, c.Omega, *motion, tau)
            x, v, _, _, _ = derivatives(o, c.Omega, *now)
            v2 = ball_velocity(o, *now) if mode == 0.0 else v
            shaken = c.A * c.Omega * math.cos(phase + c.Omega * tau)
            rate = v - shaken
            pull = c.A * math.sin(phase + c.Omega * tau) - x - c.lam * rate
            x_square += weight * x * x
            v_square += weight * v * v
            ball += weight * v2 * v2
            work += weight * pull * shaken
            damped += weight * c.lam * rate * rate
            dragged += weight * c.mu * c.delta * (v - v2) * (v - v2)
    return x_square, v_square, ball, work, damped, dragged


@linked_njit
def _start(c, mode, x1, v1, v2, phase):
    return launched(c, c.stuck if mode != 0.0 else c.free, x1, v1, v2, phase, 0.0)


@segment_integrals.register(DragConstants)
@linked_njit
def _segment_integrals(c, mode, x1, v1, v2, phase, length):
    motion = _start(c, mode, x1, v1, v2, phase)
    x_square, v_square, ball, work, damped, dragged = _integrals(c, mode, motion, phase, length)
    return x_square, v_square, ball, work, damped + dragged


@add_segment.register(DragConstants)
@linked_njit
def _add_segment(c, out, mode, begins, x1, v1, v2, phase, length):
    motion = _start(c, mode, x1, v1, v2, phase)
    x_square, v_square, ball, work, damped, dragged = _integrals(c, mode, motion, phase, length)
    out[entry.DURATION] += length
    out[entry.X1_SQUARE] += x_square
    out[entry.V1_SQUARE] += v_square
    out[entry.V2_SQUARE] += ball
    out[entry.BASE_WORK] += work
    out[entry.DAMPER_LOSS] += damped
    out[entry.TRAVEL_LOSS] += dragged
    o = c.stuck if mode != 0.0 else c.free
    best, when = peak_between(c, o, motion, turn(o, c.Omega, *motion, length), 0.0, length, out[entry.MAX_ABS_X1])
    if when >= 0.0:
        out[entry.MAX_ABS_X1] = best
        out[entry.T_MAX_ABS_X1] = begins + when
