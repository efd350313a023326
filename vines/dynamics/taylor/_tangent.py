"""Disturbances of oscillator and mass, (x1, v1, x2, v2), at fixed time: variational equations by the same series."""

from __future__ import annotations

from vines.dynamics._advance import A_V1, A_V2, IMPACT, KIND, MODE, PHASE, SIDE, STICK, V1, V2, X1, X2
from vines.dynamics._constants import Oscillator
from vines.dynamics._flight import advance_phase
from vines.dynamics._impact_law import after_impact_kernel
from vines.dynamics._tangent import carry_basis, directions, jump_basis, offset, swing, swing_of
from vines.dynamics._travel import merged, struck_under
from vines.dynamics.taylor._constants import TaylorConstants
from vines.dynamics.taylor._series import W, X, at, coefficients, expand, expand_disturbances, slopes
from vines.kernels import by_type, fused_njit, linked_njit, loop_njit, njit

__all__ = ["carried", "ride_basis"]

directions.register(TaylorConstants)(directions.first)


@fused_njit
def _to_gaps(Y):
    """Turn disturbances of position and velocity of the mass into those of w and w', or back."""
    for j in range(Y.shape[1]):
        Y[2, j] = Y[0, j] - Y[2, j]
        Y[3, j] = Y[1, j] - Y[3, j]


@by_type(Oscillator)
@loop_njit
def ride_basis(o, row, tau, Y):
    """Carry disturbances over a ride; those of the mass become those of the oscillator."""
    sine, cosine = swing_of(o, tau)
    for j in range(Y.shape[1]):
        swing(o, sine, cosine, Y, j)
        Y[2, j], Y[3, j] = Y[0, j], Y[1, j]


@loop_njit
def carried(f, x, v, w, u, phase, tau, Y):
    """Carry disturbances of (x1, x1', w, w') by series over a time tau after a state."""
    a = coefficients(f)
    done = 0.0
    while done < tau:
        h = min(expand(f, x, v, w, u, advance_phase(phase, f.Omega * done)), tau - done)
        expand_disturbances(f, h, Y)
        x, v = at(a, X, f.order, h)
        w, u = at(a, W, f.order, h)
        done += h


@carry_basis.register(TaylorConstants)
@linked_njit
def _carry_basis(c, row, tau, Y):
    if row[MODE] != 0.0:
        ride_basis(c.stuck, row, tau, Y)
        return
    x, v = row[X1], row[A_V1]
    _to_gaps(Y)
    carried(c.field, x, v, x - row[X2], v - row[A_V2], row[PHASE], tau, Y)
    _to_gaps(Y)


@njit
def _both_slopes(c, side, x, v1, v2, phase):
    """Return x1'' and x2'' of a flight on a wall."""
    return slopes(c.field, x, v1, side, v1 - v2, phase)


@jump_basis.register(TaylorConstants)
@linked_njit
def _jump_basis(c, row, Y):
    if row[KIND] == IMPACT:
        v1, v2, side = row[V1], row[V2], row[SIDE]
        after1, after2 = after_impact_kernel(c.law, v1, v2)
        before = _both_slopes(c, side, row[X1], v1, v2, row[PHASE])
        struck_under(c.law, v1, v2, before, _both_slopes(c, side, row[X1], after1, after2, row[PHASE]), Y)
    elif row[KIND] == STICK:
        merged(c, Y)


@offset.register(TaylorConstants)
@linked_njit
def _offset(c, row, event, late, scale, away):
    side = event[SIDE]
    v1, v2 = event[V1], event[V2]
    after1, after2 = after_impact_kernel(c.law, v1, v2)
    b1, b2 = _both_slopes(c, side, event[X1], after1, after2, event[PHASE])
    away[0] = (row[X1] - event[X1] - after1 * late) / scale
    away[1] = (row[A_V1] - after1 - b1 * late) / scale
    away[2] = (row[X2] - (event[X1] - side) - after2 * late) / scale
    away[3] = (row[A_V2] - after2 - b2 * late) / scale
