"""Energies of oscillator, ball and mass over a window, and what each of the two takes.

Integrals are as in `vines.dynamics.taylor._energies`: squares of polynomials by Gauss's rule.
"""

from __future__ import annotations

from vines.dynamics import _totals as entry
from vines.dynamics._advance import A_V1, A_V2, IMPACT, KIND, MODE, PHASE, STICK, TAU, TIME, X1
from vines.dynamics._flight import advance_phase
from vines.dynamics._sincos import sincos
from vines.dynamics._totals import add_integrals, ball_mass, base_at, count_event, event_loss, event_work, window_totals
from vines.dynamics.hybrid._constants import HybridConstants
from vines.dynamics.hybrid._flights import carry, of_row, place_row
from vines.dynamics.hybrid._layout import R_V3, R_X3
from vines.dynamics.hybrid._series import Z, expand_both
from vines.dynamics.taylor._energies import NODES, TAYLOR_TOTALS, VISCOUS_LOSS, WEIGHTS, peak
from vines.dynamics.taylor._samples import add_and_carry
from vines.dynamics.taylor._series import W, X, at, coefficients
from vines.kernels import copy_values, linked_njit, loop_njit, njit, zero_vector

__all__ = ["BALL_SQUARE", "HYBRID_TOTALS", "MASS_SQUARE"]

BALL_SQUARE, MASS_SQUARE = TAYLOR_TOTALS, TAYLOR_TOTALS + 1
"""Entries of the totals of a window: integrals of v2² and v3², without their masses; V2_SQUARE has both with them."""

HYBRID_TOTALS = TAYLOR_TOTALS + 2

for _name in (base_at, event_loss, event_work):
    _name.register(HybridConstants)(_name.first)


@ball_mass.register(HybridConstants)
@njit
def _ball_mass(c):
    # The masses are in the totals of V2_SQUARE already.
    return 1.0


@njit
def _stored(c, row):
    """Return what is stored just after the event of a row."""
    f = c.field
    stretch = row[X1] - base_at(c, row[PHASE])
    square = (row[X1] - row[R_X3]) * (row[X1] - row[R_X3])
    spring = square * (f.k1 + 0.5 * f.k3 * square)
    v1, v2, v3 = row[A_V1], row[A_V2], row[R_V3]
    return 0.5 * (v1 * v1 + c.mu * v2 * v2 + stretch * stretch + f.mu_n * (v3 * v3 + spring))


@loop_njit
def _add_motion(c, out, row, begins, length):
    """Add the motion after a row to totals, and let the row be what it is then."""
    f = c.field
    a = coefficients(f)
    order = f.order
    load = c.mu if row[MODE] != 0.0 else 0.0
    phase = row[PHASE]
    x1, v1, w, u, z, y = of_row(row)
    xx = vv = ball = mass = work = loss = viscous = 0.0
    done = 0.0
    while done < length:
        h = min(expand_both(f, load, x1, v1, w, u, z, y, advance_phase(phase, f.Omega * done)), length - done)
        if not h > 0.0:
            # A motion that is lost in overflow.
            break
        for k in range(NODES.shape[0]):
            s, weight = h * NODES[k], h * WEIGHTS[k]
            x, v = at(a, X, order, s)
            _, closing = at(a, W, order, s)
            _, rate = at(a, Z, order, s)
            sine, cosine = sincos(advance_phase(phase, f.Omega * (done + s)))
            base, speed = f.A * sine, f.A * f.Omega * cosine
            xx += weight * x * x
            vv += weight * v * v
            ball += weight * (v - closing) * (v - closing)
            mass += weight * (v - rate) * (v - rate)
            work += weight * (base - x + f.lam * (speed - v)) * speed
            loss += weight * (v - speed) * (v - speed)
            viscous += weight * rate * rate
        best, when = peak(a, order, h, out[entry.MAX_ABS_X1])
        if when >= 0.0:
            out[entry.MAX_ABS_X1], out[entry.T_MAX_ABS_X1] = best, begins + done + when
        x1, v1 = at(a, X, order, h)
        w, u = at(a, W, order, h)
        z, y = at(a, Z, order, h)
        done += h
    viscous *= f.mu_n * f.l2
    add_integrals(out, length, xx, vv, c.mu * ball + f.mu_n * mass, work, f.lam * loss + viscous)
    out[VISCOUS_LOSS] += viscous
    out[BALL_SQUARE] += ball
    out[MASS_SQUARE] += mass
    place_row(row, x1, v1, w, u, z, y, advance_phase(phase, f.Omega * length))


@add_and_carry.register(HybridConstants)
@linked_njit
def _add_and_carry(c, sums, row, tau):
    _add_motion(c, sums, row, 0.0, tau)


@window_totals.register(HybridConstants)
@linked_njit
def _window_totals(c, rows, n, start, stop):
    out = zero_vector(HYBRID_TOTALS)
    here = zero_vector(rows.shape[1])
    opened = False
    energy = 0.0
    for i in range(n):
        begins = rows[i, TIME]
        if begins > stop:
            break
        counted = i > 0 and (begins > start or (begins == start and rows[0, TIME] == start))
        if counted and rows[i, KIND] in (IMPACT, STICK):
            count_event(c, out, rows[i])
        if i == n - 1:
            break
        ends = rows[i + 1, TIME]
        length = stop - begins if ends > stop else rows[i + 1, TAU]
        low = start - begins if begins < start else 0.0
        if ends < start or length < low:
            continue
        copy_values(here, rows[i])
        if low > 0.0:
            carry(c, here, low)
        if not opened:
            opened = True
            energy = _stored(c, here)
            out[entry.MAX_ABS_X1], out[entry.T_MAX_ABS_X1] = abs(here[X1]), begins + low
        _add_motion(c, out, here, begins + low, length - low)
        if ends >= stop or i == n - 2:
            # An event that ends the window belongs to it.
            whole = i == n - 2 and ends <= stop
            out[entry.ENERGY_CHANGE] = (_stored(c, rows[n - 1]) if whole else _stored(c, here)) - energy
    return out
