"""Energies of oscillator and mass: squares of polynomials, whose integrals Gauss's rule gives to rounding.

Terms of a step fall by e^-2 from order to order, those of a square by e^-2 too: what ten nodes, exact up to degree 19,
leave out is e^-40 of it.
"""

from __future__ import annotations

import numpy as np

from vines.dynamics import _totals as entry
from vines.dynamics._advance import A_V1, A_V2, MODE, PHASE, X1, X2
from vines.dynamics._constants import Oscillator
from vines.dynamics._flight import advance_phase, phasors, turn
from vines.dynamics._integrals import energies_between, peak_between
from vines.dynamics._sincos import sincos
from vines.dynamics._totals import (
    TOTALS,
    add_integrals,
    add_segment,
    add_window,
    ball_mass,
    base_at,
    event_loss,
    event_work,
    segment_state,
    state_energy,
    stored_energy,
    window_totals,
)
from vines.dynamics.taylor._constants import Field, TaylorConstants
from vines.dynamics.taylor._contacts import flown_from
from vines.dynamics.taylor._held import held, ride
from vines.dynamics.taylor._series import W, X, at, bounds, coefficients, derivatives_at, expand
from vines.kernels import by_type, fused_njit, linked_njit, loop_njit, njit, zero_vector

__all__ = [
    "NODES",
    "TAYLOR_TOTALS",
    "VISCOUS_LOSS",
    "WEIGHTS",
    "by_series",
    "held_energy",
    "peak",
    "ride_integrals",
    "viscosity",
]

VISCOUS_LOSS = TOTALS
"""Entry of the totals of a window behind those of one ball: what of the damper loss the damper of the spring takes."""

TAYLOR_TOTALS = TOTALS + 1

_GAUSS = np.polynomial.legendre.leggauss(10)
NODES, WEIGHTS = 0.5 + 0.5 * _GAUSS[0], 0.5 * _GAUSS[1]

THIN = 2.0**-20
"""Part of a step below which x1 is called flat where neither its velocity nor its acceleration keeps a sign."""

for _name in (ball_mass, base_at, event_loss, event_work):
    _name.register(TaylorConstants)(_name.first)


@stored_energy.register(TaylorConstants)
@linked_njit
def _stored_energy(c, x1, v1, x2, v2, phase):
    return state_energy(c, x1, v1, v2, phase) + held_energy(c.field, x1, x2)


@by_type(Field)
@njit
def held_energy(f, x1, x2):
    """Return the energy that the springs of a field hold beside the one between base and oscillator."""
    square = (x1 - x2) * (x1 - x2)
    spring = square * (0.5 * f.k1 + 0.25 * f.k3 * square)
    return f.mu * spring


@by_type(Field)
@fused_njit
def viscosity(f):
    """Return the damping of the mass over w', times its mass."""
    return f.mu * f.l2


@segment_state.register(TaylorConstants)
@linked_njit
def _segment_state(c, row, tau):
    phase = advance_phase(row[PHASE], c.Omega * tau)
    mode = row[MODE]
    if mode != 0.0:
        x, v = ride(c.stuck, c.Omega, row[X1], row[A_V1], row[PHASE], tau)
        return x, v, x - mode, v, phase
    x1, v1 = row[X1], row[A_V1]
    x, v, w, u = flown_from(c.field, x1, v1, x1 - row[X2], v1 - row[A_V2], row[PHASE], tau)
    return x, v, x - w, v - u, phase


@loop_njit
def peak(a, order, h, best):
    """Return the largest |x1| over a step if it is above `best`, and when it is reached, else (best, -1)."""
    bend, third, _ = bounds(a, X, order, h)
    when = -1.0
    if max(abs(a[X]), abs(a[X] + h * a[X + 1])) + bend <= best:
        return best, when
    s = 0.0
    width = h
    while s < h:
        width = min(width, h - s)
        half = 0.5 * width
        x, v, curve, _, _, _, _ = derivatives_at(a, X, order, s + half)
        largest = abs(curve) + third * half
        if abs(x) + half * (abs(v) + 0.5 * half * largest) > best:
            low, high = s, s + width
            if abs(v) <= half * largest:
                if abs(curve) <= third * half and width > THIN * h:
                    width = half
                    continue
                low, high = _flat(a, order, low, high)
            for place in (low, high):
                size = abs(at(a, X, order, place)[0])
                if size > best:
                    best, when = size, place
        s += width
        width *= 2.0
    return best, when


@loop_njit
def _flat(a, order, low, high):
    """Return where x1' vanishes between two times, twice, if its sign changes there; else those times."""
    below, above = at(a, X, order, low)[1], at(a, X, order, high)[1]
    if below * above > 0.0:
        return low, high
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return low, high
        slope = at(a, X, order, middle)[1]
        if slope * below > 0.0:
            low = middle
        else:
            high = middle


@by_type(Oscillator)
@loop_njit
def ride_integrals(o, c, out, side, begins, x1, v1, phase, length):
    """Return the integrals of a ride as `energies_between` does, and keep the largest |x1| in the totals."""
    start = phasors(o, c.Omega, x1, v1, phase)
    end = turn(o, c.Omega, *start, length)
    found = energies_between(c, o, True, start, end, v1, length)
    best, when = peak_between(held(c, 0.0), o, start, end, 0.0, length, out[entry.MAX_ABS_X1])
    if when >= 0.0:
        out[entry.MAX_ABS_X1], out[entry.T_MAX_ABS_X1] = best, begins + when
    return found


@loop_njit
def by_series(f, out, begins, x1, v1, w, u, phase, length):
    """Return the same of a motion by series; what a damper of the mass takes is added to the totals."""
    a = coefficients(f)
    xx = vv = ball = work = loss = viscous = 0.0
    done = 0.0
    while done < length:
        h = min(expand(f, x1, v1, w, u, advance_phase(phase, f.Omega * done)), length - done)
        for k in range(NODES.shape[0]):
            s, weight = h * NODES[k], h * WEIGHTS[k]
            x, v = at(a, X, f.order, s)
            _, rate = at(a, W, f.order, s)
            sine, cosine = sincos(advance_phase(phase, f.Omega * (done + s)))
            base, speed = f.A * sine, f.A * f.Omega * cosine
            xx += weight * x * x
            vv += weight * v * v
            ball += weight * (v - rate) * (v - rate)
            work += weight * (base - x + f.lam * (speed - v)) * speed
            loss += weight * (v - speed) * (v - speed)
            viscous += weight * rate * rate
        best, when = peak(a, f.order, h, out[entry.MAX_ABS_X1])
        if when >= 0.0:
            out[entry.MAX_ABS_X1], out[entry.T_MAX_ABS_X1] = best, begins + done + when
        x1, v1 = at(a, X, f.order, h)
        w, u = at(a, W, f.order, h)
        done += h
    viscous *= viscosity(f)
    loss = f.lam * loss + viscous
    out[VISCOUS_LOSS] += viscous
    return xx, vv, ball, work, loss


@add_segment.register(TaylorConstants)
@linked_njit
def _add_segment(c, out, mode, begins, x1, v1, x2, v2, phase, length):
    if mode != 0.0:
        found = ride_integrals(c.stuck, c, out, mode, begins, x1, v1, phase, length)
    else:
        found = by_series(c.field, out, begins, x1, v1, x1 - x2, v1 - v2, phase, length)
    add_integrals(out, length, *found)


@window_totals.register(TaylorConstants)
@linked_njit
def _window_totals(c, rows, n, start, stop):
    out = zero_vector(TAYLOR_TOTALS)
    add_window(c, out, rows, n, start, stop)
    return out
