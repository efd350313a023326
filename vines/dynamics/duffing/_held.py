"""A ball that rides: the frame with the mass 1 + mu by its own series, and the release certified on its polynomial.

The wall presses with ``mu side x1''`` while that is positive.
"""

from __future__ import annotations

from vines.dynamics import _advance as col
from vines.dynamics._contact import CONTACT, MAX_STEPS, NO_CONTACT, STEP_CAP
from vines.dynamics._flight import advance_phase
from vines.dynamics.duffing._constants import DuffingField
from vines.dynamics.taylor.kernels import (
    DISTURBED,
    X,
    at,
    by_series,
    carried,
    coefficients,
    expand,
    flown_from,
    release,
    release_in_step,
    ride,
    ride_basis,
    ride_integrals,
)
from vines.kernels import linked_njit, loop_njit

__all__: list[str] = []


@release.register(DuffingField)
@loop_njit
def _release(o, c, side, x, v, phase, clear, stop):
    a = coefficients(o)
    since = 0.0
    for _ in range(MAX_STEPS):
        h = expand(o, x, v, 1.0 * side, 0.0, advance_phase(phase, o.Omega * since))
        if not h > 0.0:
            break
        # What a search before this one has passed is passed over by whole steps: a ride does not depend on cuts.
        if since + h > clear:
            code, s = release_in_step(o, DISTURBED, h, 0.0, min(h, stop - since), side, 0.0, since)
            if code == CONTACT:
                x, v = at(a, X, o.order, s)
                return CONTACT, since + s, x, v
            if code == STEP_CAP:
                return STEP_CAP, since, 0.0, 0.0
        if since + h >= stop:
            return NO_CONTACT, since, 0.0, 0.0
        x, v = at(a, X, o.order, h)
        since += h
    return STEP_CAP, since, 0.0, 0.0


@ride.register(DuffingField)
@linked_njit
def _ride(o, Omega, x, v, phase, tau):
    x, v, _, _ = flown_from(o, x, v, 0.0, 0.0, phase, tau)
    return x, v


@ride_integrals.register(DuffingField)
@linked_njit
def _ride_integrals(o, c, out, side, begins, x1, v1, phase, length):
    return by_series(o, out, begins, x1, v1, side, 0.0, phase, length)


@ride_basis.register(DuffingField)
@linked_njit
def _ride_basis(o, row, tau, Y):
    carried(o, row[col.X1], row[col.A_V1], row[col.MODE], 0.0, row[col.PHASE], tau, Y)
    for j in range(Y.shape[1]):
        Y[2, j], Y[3, j] = Y[0, j], Y[1, j]
