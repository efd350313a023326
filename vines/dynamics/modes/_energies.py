"""Energies of a structure of several modes and of its ball over a window, and what each mode has and loses.

Between events all is a sum of exponentials of known rates: Gauss's rule over parts that are short against the fastest
of them integrates their products to rounding, as of a ball that is dragged (`vines.dynamics._travel`).
"""

from __future__ import annotations

import math

from vines.dynamics import _totals as entry
from vines.dynamics._advance import A_V1, A_V2, IMPACT, KIND, MODE, PHASE, SIDE, V1, V2, X2
from vines.dynamics._flight import advance_phase, derivatives, free_ball, turn
from vines.dynamics._integrals import NODES, WEIGHTS, peak_between
from vines.dynamics._totals import (
    add_integrals,
    ball_mass,
    base_at,
    event_loss,
    event_work,
    segment_state,
    window_totals,
)
from vines.dynamics._travel import OF_A_WINDOW
from vines.dynamics.modes._constants import GAMMA, LAM, STIFFNESS, ModesConstants, of_mode
from vines.dynamics.modes._jet import launch, modal_at
from vines.dynamics.modes._layout import DAMPER, EACH, R_MODAL, SPEED_SQUARE, STRAIN_SQUARE
from vines.dynamics.modes._motion import base
from vines.dynamics.parallel._energies import add_motion, add_rows, count_row, row_energy
from vines.kernels import linked_njit, njit, zero_vector

__all__ = ["of_row"]

for _name in (ball_mass, base_at):
    _name.register(ModesConstants)(_name.first)


@event_loss.register(ModesConstants)
@njit
def _event_loss(c, row):
    # What a contact takes is its impulse times the mean relative velocity.
    return 0.5 * c.mu * (row[A_V2] - row[V2]) * ((row[V1] - row[V2]) + (row[A_V1] - row[A_V2]))


@event_work.register(ModesConstants)
@njit
def _event_work(c, row):
    # What of the cavity moves with the base hands its share of the impulse to the base.
    return c.direct * c.mu * (row[A_V2] - row[V2]) * base(c, row[PHASE])[1]


@njit
def of_row(c, row):
    """Return the motion that begins just after a row, and the structure that moves."""
    o = c.stuck if row[MODE] != 0.0 else c.free
    return o, launch(c, o, row, R_MODAL, row[PHASE])


@segment_state.register(ModesConstants)
@linked_njit
def _segment_state(c, row, tau):
    o, motion = of_row(c, row)
    x1, v1, _, _, _ = derivatives(o, c.Omega, *turn(o, c.Omega, *motion, tau))
    phase = advance_phase(row[PHASE], c.Omega * tau)
    if row[MODE] != 0.0:
        return x1, v1, x1 - row[MODE], v1, phase
    way, v2 = free_ball(c, row[A_V2], tau)
    return x1, v1, row[X2] + way, v2, phase


@add_motion.register(ModesConstants)
@linked_njit
def _add_motion(c, out, row, begins, low, length):
    """Add the motion from `low` to `length` after a row to the totals."""
    o, motion = of_row(c, row)
    rides = row[MODE] != 0.0
    lasts = length - low
    z = zero_vector(2 * c.modes)
    parts = max(1.0, math.ceil(lasts / (OF_A_WINDOW * c.window)))
    part = lasts / parts
    x_square = v_square = work = loss = 0.0
    for i in range(int(parts)):
        for m in range(8):
            tau = low + part * (i + 0.5 * (1.0 + (NODES[m // 2] if m % 2 else -NODES[m // 2])))
            weight = 0.5 * part * WEIGHTS[m // 2]
            x, v, a, _, _ = derivatives(o, c.Omega, *turn(o, c.Omega, *motion, tau))
            modal_at(c, o, tau, z, 0)
            e, rate, _ = base(c, row[PHASE] + c.Omega * tau)
            x_square += weight * x * x
            v_square += weight * v * v
            if rides:
                work += weight * c.direct * c.mu * a * rate
            for k in range(c.modes):
                gamma, square, lam = of_mode(c.each, k, GAMMA), of_mode(c.each, k, STIFFNESS), of_mode(c.each, k, LAM)
                strain, slip = z[2 * k] - gamma * e, z[1 + 2 * k] - gamma * rate
                damped = weight * lam * slip * slip
                work -= weight * gamma * rate * (square * strain + lam * slip)
                loss += damped
                out[SPEED_SQUARE + EACH * k] += weight * z[1 + 2 * k] * z[1 + 2 * k]
                out[STRAIN_SQUARE + EACH * k] += weight * square * strain * strain
                out[DAMPER + EACH * k] += damped
    add_integrals(out, lasts, x_square, v_square, v_square if rides else lasts * row[A_V2] * row[A_V2], work, loss)
    start = turn(o, c.Omega, *motion, low)
    if out[entry.MAX_ABS_X1] < abs(start[1]):
        out[entry.MAX_ABS_X1], out[entry.T_MAX_ABS_X1] = abs(start[1]), begins + low
    best, when = peak_between(c, o, start, turn(o, c.Omega, *motion, length), 0.0, lasts, out[entry.MAX_ABS_X1])
    if when >= 0.0:
        out[entry.MAX_ABS_X1], out[entry.T_MAX_ABS_X1] = best, begins + low + when


@row_energy.register(ModesConstants)
@linked_njit
def _row_energy(c, row, tau):
    """Return what is stored a time tau after a row, but for what moves with the base."""
    z = zero_vector(2 * c.modes)
    o, motion = of_row(c, row)
    modal_at(c, o, tau, z, 0)
    v2 = turn(o, c.Omega, *motion, tau)[2] if row[MODE] != 0.0 else row[A_V2]
    e, _, _ = base(c, row[PHASE] + c.Omega * tau)
    total = 0.5 * c.mu * v2 * v2
    for k in range(c.modes):
        strain = z[2 * k] - of_mode(c.each, k, GAMMA) * e
        total += 0.5 * (z[1 + 2 * k] * z[1 + 2 * k] + of_mode(c.each, k, STIFFNESS) * strain * strain)
    return total


@count_row.register(ModesConstants)
@linked_njit
def _count_row(c, out, row):
    left = row[SIDE] > 0.0
    out[entry.LOSS_LEFT if left else entry.LOSS_RIGHT] += event_loss(c, row)
    out[entry.BASE_WORK] += event_work(c, row)
    if row[KIND] == IMPACT:
        out[entry.IMPACTS_LEFT if left else entry.IMPACTS_RIGHT] += 1.0
    else:
        out[entry.STICKS_LEFT if left else entry.STICKS_RIGHT] += 1.0


@window_totals.register(ModesConstants)
@linked_njit
def _window_totals(c, rows, n, start, stop):
    out = zero_vector(entry.TOTALS + EACH * c.modes)
    add_rows(c, out, rows, n, start, stop)
    return out
