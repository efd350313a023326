"""Disturbances of oscillator, ball and mass, (x1, v1, x2, v2, x3, v3), at fixed time: the same series, linear."""

from __future__ import annotations

from vines.dynamics._advance import IMPACT, KIND, MODE, PHASE, STICK, V1, V2, X1
from vines.dynamics._flight import advance_phase
from vines.dynamics._impact_law import after_impact_kernel
from vines.dynamics._tangent import carry_basis, directions, jump_basis
from vines.dynamics._travel import merged, struck_under
from vines.dynamics.hybrid._constants import HybridConstants
from vines.dynamics.hybrid._flights import of_row
from vines.dynamics.hybrid._layout import R_V3, R_X3
from vines.dynamics.hybrid._series import Z, accelerations, disturb, expand_both
from vines.dynamics.taylor._series import W, X, at, coefficients
from vines.kernels import fused_njit, linked_njit, loop_njit, njit

__all__: list[str] = []


@directions.register(HybridConstants)
@njit
def _directions(c):
    return 0, 0, 0, 0, 0, 0


@fused_njit
def _to_gap(Y):
    """Turn disturbances of position and velocity of the mass into those of z and z', or back."""
    for j in range(Y.shape[1]):
        Y[4, j] = Y[0, j] - Y[4, j]
        Y[5, j] = Y[1, j] - Y[5, j]


@carry_basis.register(HybridConstants)
@loop_njit
def _carry_basis(c, row, tau, Y):
    f = c.field
    a = coefficients(f)
    rides = row[MODE] != 0.0
    load = c.mu if rides else 0.0
    x, v, w, u, z, y = of_row(row)
    _to_gap(Y)
    done = 0.0
    while done < tau:
        h = min(expand_both(f, load, x, v, w, u, z, y, advance_phase(row[PHASE], f.Omega * done)), tau - done)
        disturb(f, load, h, Y)
        x, v = at(a, X, f.order, h)
        w, u = at(a, W, f.order, h)
        z, y = at(a, Z, f.order, h)
        done += h
    _to_gap(Y)
    for j in range(Y.shape[1]):
        if rides:
            Y[2, j], Y[3, j] = Y[0, j], Y[1, j]
        else:
            Y[2, j] += tau * Y[3, j]


@njit
def _of_all(c, row, v1):
    """Return x1'' and x3'' of a flight at the place of a row, with x1' given."""
    x1, x3, v3 = row[X1], row[R_X3], row[R_V3]
    return accelerations(c.field, 0.0, x1, v1, x1 - x3, v1 - v3, row[PHASE])


@jump_basis.register(HybridConstants)
@linked_njit
def _jump_basis(c, row, Y):
    if row[KIND] == IMPACT:
        v1, v2 = row[V1], row[V2]
        a1, a3 = _of_all(c, row, v1)
        b1, b3 = _of_all(c, row, after_impact_kernel(c.law, v1, v2)[0])
        closing = v1 - v2
        for j in range(Y.shape[1]):
            # The blow on the oscillator changes what the damper beside the spring does to the mass.
            Y[5, j] += (b3 - a3) * (Y[0, j] - Y[2, j]) / closing if closing != 0.0 else 0.0
        struck_under(c.law, v1, v2, (a1, 0.0), (b1, 0.0), Y)
    elif row[KIND] == STICK:
        f, share = c.field, 1.0 / (1.0 + c.mu)
        # What is left of the chatter moves the oscillator, against the damper beside the spring too.
        moved = f.l2 * c.mu * share
        for j in range(Y.shape[1]):
            gap = Y[0, j] - Y[2, j]
            Y[1, j] += f.mu_n * moved * gap
            Y[5, j] -= moved * gap
        merged(c, Y)
