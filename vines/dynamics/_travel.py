"""Energies over a segment in which something acts on the ball on its way, a drag or a friction.

Between events all is smooth, sums of exponentials and polynomials of known rates: Gauss's rule over parts that are
short against the fastest of them integrates their products to rounding, next to resonance as anywhere.
"""

from __future__ import annotations

import math

from vines.dynamics import _totals as entry
from vines.dynamics._advance import A_V1, A_V2, PHASE, SIDE, V1, V2, X1, X2
from vines.dynamics._flight import derivatives, launched, relative, turn
from vines.dynamics._impact_law import after_impact_kernel
from vines.dynamics._integrals import NODES, WEIGHTS, peak_between
from vines.dynamics._totals import TRAVEL_LOSS, add_integrals, base_at
from vines.kernels import linked_njit, njit

__all__ = ["accelerations", "add_travel", "merged", "offset_of_travel", "struck", "struck_under", "travel_integrals"]

OF_A_WINDOW = 0.75
"""Parts are no longer than this times the window, 1.5 over the fastest rate: a product of two of them turns by 3."""


@linked_njit
def _integrals(c, mode, motion, phase, length):
    """Return the integrals of x1², v1², v2² and w'², of |w'|, the base work and the loss in the damper."""
    o = c.stuck if mode != 0.0 else c.free
    seen = relative(c)
    # Over a part the rule of eight points is exact to rounding: 3^16/16! times 2e-10.
    parts = max(1.0, math.ceil(length / (OF_A_WINDOW * c.window)))
    part = length / parts
    x_square = v_square = ball = square = way = work = damped = 0.0
    for i in range(int(parts)):
        for k in range(8):
            tau = part * (i + 0.5 * (1.0 + (NODES[k // 2] if k % 2 else -NODES[k // 2])))
            weight = 0.5 * part * WEIGHTS[k // 2]
            now = turn(o, c.Omega, *motion, tau)
            x, v, _, _, _ = derivatives(o, c.Omega, *now)
            closing = derivatives(seen.free, c.Omega, *now)[1] if mode == 0.0 else 0.0
            shaken = c.A * c.Omega * math.cos(phase + c.Omega * tau)
            rate = v - shaken
            x_square += weight * x * x
            v_square += weight * v * v
            ball += weight * (v - closing) * (v - closing)
            square += weight * closing * closing
            way += weight * abs(closing)
            work += weight * (base_at(c, phase + c.Omega * tau) - x - c.lam * rate) * shaken
            damped += weight * c.lam * rate * rate
    return x_square, v_square, ball, square, way, work, damped


@njit
def _start(c, mode, x1, v1, v2, phase):
    return launched(c, c.stuck if mode != 0.0 else c.free, x1, v1, v2, phase, 0.0)


@linked_njit
def travel_integrals(c, mode, x1, v1, v2, phase, length):
    """Return what `segment_integrals` does; what is lost on the way counts as lost in the damper."""
    motion = _start(c, mode, x1, v1, v2, phase)
    x_square, v_square, ball, square, way, work, damped = _integrals(c, mode, motion, phase, length)
    return x_square, v_square, ball, work, damped + c.mu * (c.delta * square + c.friction * way)


@linked_njit
def add_travel(c, out, mode, begins, x1, v1, x2, v2, phase, length):
    """Do what `add_segment` does."""
    motion = _start(c, mode, x1, v1, v2, phase)
    x_square, v_square, ball, square, way, work, damped = _integrals(c, mode, motion, phase, length)
    add_integrals(out, length, x_square, v_square, ball, work, damped)
    out[TRAVEL_LOSS] += c.mu * (c.delta * square + c.friction * way)
    o = c.stuck if mode != 0.0 else c.free
    best, when = peak_between(c, o, motion, turn(o, c.Omega, *motion, length), 0.0, length, out[entry.MAX_ABS_X1])
    if when >= 0.0:
        out[entry.MAX_ABS_X1] = best
        out[entry.T_MAX_ABS_X1] = begins + when


@njit
def accelerations(c, x1, v1, v2, phase):
    """Return those of oscillator and ball in flight."""
    motion = launched(c, c.free, x1, v1, v2, phase, 0.0)
    a = derivatives(c.free, c.Omega, *motion)[2]
    seen = relative(c)
    return a, a - derivatives(seen.free, c.Omega, *motion)[2]


@njit
def struck(c, row, Y):
    """Apply an impact to the disturbances that are the columns of Y."""
    v1, v2 = row[V1], row[V2]
    after1, after2 = after_impact_kernel(c.law, v1, v2)
    before = accelerations(c, row[X1], v1, v2, row[PHASE])
    struck_under(c.law, v1, v2, before, accelerations(c, row[X1], after1, after2, row[PHASE]), Y)


@njit
def struck_under(law, v1, v2, before, after, Y):
    """Apply an impact to the disturbances that are the columns of Y, from both accelerations before and after it."""
    after1, after2 = after_impact_kernel(law, v1, v2)
    a1, a2 = before
    b1, b2 = after
    closing = v1 - v2
    for j in range(Y.shape[1]):
        # The disturbed run hits earlier by `shift`; before that it has the one motion, after it the other.
        shift = (Y[0, j] - Y[2, j]) / closing if closing != 0.0 else 0.0
        w1, w2 = after_impact_kernel(law, Y[1, j] - a1 * shift, Y[3, j] - a2 * shift)
        Y[0, j] += (after1 - v1) * shift
        Y[1, j] = w1 + b1 * shift
        Y[2, j] += (after2 - v2) * shift
        Y[3, j] = w2 + b2 * shift


@njit
def merged(c, Y):
    """Apply a merge, after a chatter, to the disturbances that are the columns of Y."""
    share = 1.0 / (1.0 + c.mu)
    # A force between the two moves both: what is left of the chatter closes the gap of a disturbed run, and the damper
    # acts meanwhile.
    damped = c.lam * c.mu * share * share
    for j in range(Y.shape[1]):
        x = share * (Y[0, j] + c.mu * Y[2, j])
        v = share * (Y[1, j] + c.mu * Y[3, j]) + damped * (Y[0, j] - Y[2, j])
        Y[0, j] = Y[2, j] = x
        Y[1, j] = Y[3, j] = v


@njit
def offset_of_travel(c, row, event, late, scale, away):
    """Do what `offset` does."""
    x1, v1, v2 = event[X1], event[V1], event[V2]
    after1, after2 = after_impact_kernel(c.law, v1, v2)
    a1, a2 = accelerations(c, x1, after1, after2, event[PHASE])
    away[0] = (row[X1] - x1 - after1 * late) / scale
    away[1] = (row[A_V1] - after1 - a1 * late) / scale
    away[2] = (row[X2] - (x1 - event[SIDE]) - after2 * late) / scale
    away[3] = (row[A_V2] - after2 - a2 * late) / scale
