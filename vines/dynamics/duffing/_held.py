"""A ball that rides: the frame with the mass 1 + mu by its own series, and the release certified on its polynomial.

The wall presses with ``mu side x1''`` while that is positive.
"""

from __future__ import annotations

from vines.dynamics import _advance as col
from vines.dynamics._contact import BEYOND, CONTACT, FEW_ULP, MAX_STEPS, NO_CONTACT, STEP_CAP
from vines.dynamics._flight import advance_phase
from vines.dynamics._steps import leaving_step, only_root, safe_step, taylor_root
from vines.dynamics.duffing._constants import DuffingField
from vines.dynamics.taylor.kernels import (
    X,
    at,
    bounds,
    by_series,
    carried,
    coefficients,
    derivatives_at,
    expand,
    flown_from,
    release,
    ride,
    ride_basis,
    ride_integrals,
)
from vines.kernels import linked_njit, loop_njit, njit

__all__: list[str] = []

CLOSE = 1e-8
"""Step of Newton's method after which its square is rounding."""


@njit
def _vanishes(a, order, side, low, high, s):
    """Return the only root in [low, high] of the push, which falls there; s is an estimate of it."""
    while True:
        _, _, push, slope, _, _, _ = derivatives_at(a, X, order, s)
        push, slope = side * push, side * slope
        if push > 0.0:
            low = s
        else:
            high = s
        if slope < 0.0:
            after = s - push / slope
            if abs(after - s) <= CLOSE:
                return min(max(after, low), high)
            if low < after < high:
                s = after
                continue
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return middle
        s = middle


@loop_njit
def _lost(f, side, h, since, stop):
    """Search a step of length h, which begins `since` after the last event, for the first loss of contact.

    Returns
    -------
    (code, s)
        Without a loss s is of no meaning.
    """
    a = coefficients(f)
    order = f.order
    _, _, fifth = bounds(a, X, order, h)
    s = 0.0
    for _ in range(MAX_STEPS):
        _, _, push, jerk, snap, _, _ = derivatives_at(a, X, order, s)
        push, slope, bend = side * push, -side * jerk, -side * snap
        if push < 0.0 or (push == 0.0 and slope > 0.0):
            return CONTACT, s
        left = h - s
        if left <= FEW_ULP * (since + h):
            return NO_CONTACT, s
        if slope > 0.0:
            step, _ = taylor_root(push, slope, bend, 0.0, 0.0, 0.0, 0.0)
            beyond = BEYOND * step
            if beyond <= left and only_root(push, slope, bend, -fifth, 0.0, 0.0, beyond):
                return CONTACT, _vanishes(a, order, side, s, s + beyond, s + step)
        if push == 0.0:
            step = leaving_step(-slope, bend, fifth, 0.0, left)
        else:
            step = safe_step(push, slope, bend + fifth * left / 3.0, left)
            shorter = min(1.5 * step, left)
            step = max(step, safe_step(push, slope, bend + fifth * shorter / 3.0, shorter))
        if step <= FEW_ULP * (since + s):
            return CONTACT, s
        if since + s + step > stop:
            return NO_CONTACT, s
        s += step
    return STEP_CAP, s


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
            code, s = _lost(o, side, h, since, stop)
            if code == CONTACT and since + s <= stop:
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
