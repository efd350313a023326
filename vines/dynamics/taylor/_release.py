"""Where a wall stops pressing against what rides on it, certified on the polynomial of a step."""

from __future__ import annotations

from vines.dynamics._contact import BEYOND, CONTACT, FEW_ULP, MAX_STEPS, NO_CONTACT, STEP_CAP
from vines.dynamics._steps import leaving_step, only_root, safe_step, taylor_root
from vines.dynamics.taylor._contacts import root
from vines.dynamics.taylor._series import X, bounds, coefficients, derivatives_at
from vines.kernels import loop_njit

__all__ = ["release_in_step"]


@loop_njit
def release_in_step(f, push, h, clear, until, side, limit, since):
    """Search a step of length h for the first release between `clear` and `until`, both from its begin.

    Parameters
    ----------
    f : Field
        The room holds the step, in which x1 moves with what rides on the wall.
    push : int
        Where in the room x1'' may be put.
    side : int
        The wall; it presses while ``side x1'' > limit``.
    since : float
        Time from the last event to the begin of the step.

    Returns
    -------
    (code, s)
        Without release s is what a later search can start from.
    """
    a = coefficients(f)
    order = f.order - 2
    for k in range(order + 1):
        a[push + k] = (k + 1.0) * (k + 2.0) * a[X + k + 2]
    bend, third, _ = bounds(a, push, order, h)
    if min(side * a[push], side * (a[push] + h * a[push + 1])) - bend > limit:
        return NO_CONTACT, clear
    s = clear
    for _ in range(MAX_STEPS):
        value, rate, second, _, _, _, _ = derivatives_at(a, push, order, s)
        # How far the force is above where it ends, and how fast it falls.
        force, slope, curve = side * value - limit, -side * rate, -side * second
        left = h - s
        if force < 0.0 or (force == 0.0 and slope > 0.0):
            return (CONTACT, s) if s <= until else (NO_CONTACT, s)
        if slope > 0.0:
            step, _ = taylor_root(force, slope, curve, 0.0, 0.0, 0.0, 0.0)
            beyond = BEYOND * step
            if beyond <= left and only_root(force, slope, curve, -third, 0.0, 0.0, beyond):
                found = root(a, push, order, -limit, -side, s, s + beyond, s + step)
                return (CONTACT, found) if found <= until else (NO_CONTACT, s)
        if force == 0.0:
            step = leaving_step(-slope, curve, third, 0.0, left)
        else:
            step = safe_step(force, slope, curve + third * left / 3.0, left)
            shorter = min(1.5 * step, left)
            step = max(step, safe_step(force, slope, curve + third * shorter / 3.0, shorter))
        if left <= FEW_ULP * (since + h):
            return NO_CONTACT, s
        if not step > FEW_ULP * (since + s):
            return (CONTACT, s) if s <= until else (NO_CONTACT, s)
        if s + step >= until:
            return NO_CONTACT, s
        s += step
    return STEP_CAP, s
