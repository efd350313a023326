"""The next contact of a flight with a barrier, certified on the polynomial of each step."""

from __future__ import annotations

from vines.dynamics._advance import S_PHASE, S_RELEASED, S_WALL
from vines.dynamics._contact import BEYOND, CONTACT, FEW_ULP, MAX_STEPS, NO_CONTACT, STEP_CAP, leave_wall
from vines.dynamics._flight import advance_phase
from vines.dynamics._steps import certain_ways, only_root, taylor_root
from vines.dynamics.taylor._layout import CLEAR, SINCE, STEP_U, STEP_V, STEP_W, STEP_X, begin_step
from vines.dynamics.taylor._series import W, X, at, bounds, coefficients, derivatives_at, expand
from vines.kernels import fused_njit, loop_njit, njit

__all__ = ["flown_from", "fly", "hit_within", "open_step", "root"]

CLOSE = 1e-8
"""Step of Newton's method after which its square is rounding."""


@njit
def root(a, first, order, level, side, low, high, s):
    """Return the only root in [low, high] of what a polynomial lacks to a level; s is an estimate of it.

    The polynomial, times `side`, rises there.
    """
    for _ in range(80):
        value, rate = at(a, first, order, s)
        gap, slope = level - side * value, side * rate
        if gap > 0.0:
            low = s
        else:
            high = s
        step = gap / slope if slope > 0.0 else -1.0
        if slope > 0.0 and abs(step) <= CLOSE:
            return s + step
        if slope > 0.0 and low <= s + step <= high:
            s += step
        else:
            middle = 0.5 * (low + high)
            if middle == s:
                return s
            s = middle
    return s


@loop_njit
def hit_within(f, h, clear, until, wall, released, since):
    """Search a step of length h for the first contact between `clear` and `until`, both from its begin.

    Parameters
    ----------
    wall : int
        The wall that the step begins on, or 0; `released` says whether at the end of sticking.
    since : float
        Time from the last event to the begin of the step.

    Returns
    -------
    (code, s, side)
        Without contact s is what a later search can start from.
    """
    a = coefficients(f)
    order = f.order
    bend, _, fifth = bounds(a, W, order, h)
    if max(abs(a[W]), abs(a[W] + h * a[W + 1])) + bend < 1.0:
        return NO_CONTACT, clear, 0
    s = clear
    if s == 0.0 and wall != 0:
        _, u, d2, d3, d4, _, _ = derivatives_at(a, W, order, 0.0)
        s = leave_wall(1.0, -wall * u, wall * d2, wall * d3, wall * d4, fifth, h, released)
        if s >= until:
            return NO_CONTACT, 0.0, 0
    for _ in range(MAX_STEPS):
        w, u, d2, d3, d4, d5, d6 = derivatives_at(a, W, order, s)
        pace = abs(u)
        side = 1 if u > 0.0 else -1
        gap, behind = max(1.0 - side * w, 0.0), max(1.0 + side * w, 0.0)
        d2, d3, d4 = side * d2, side * d3, side * d4
        left = h - s
        step, _ = taylor_root(gap, pace, d2, d3, d4, side * d5, side * d6)
        beyond = BEYOND * step
        if beyond <= left and only_root(gap, pace, d2, d3, d4, fifth, beyond):
            found = root(a, W, order, 1.0, side, s, s + beyond, s + step)
            return (CONTACT, found, side) if found <= until else (NO_CONTACT, s, 0)
        forth, back = certain_ways(gap, behind, pace, d2, d3, d4, fifth, left)
        step = min(forth, back)
        if left <= FEW_ULP * (since + h):
            # What is left of the step is rounding; the next one begins where it ends.
            return NO_CONTACT, s, 0
        if not step > FEW_ULP * (since + s):
            return (CONTACT, s, (side if forth <= back else -side)) if s <= until else (NO_CONTACT, s, 0)
        if s + step >= until:
            return NO_CONTACT, s, 0
        s += step
    return STEP_CAP, s, 0


@fused_njit
def open_step(c, state):
    """Expand the series of the step that a flight is in; return its length."""
    phase = advance_phase(state[S_PHASE], c.Omega * state[SINCE])
    return expand(c.field, state[STEP_X], state[STEP_V], state[STEP_W], state[STEP_U], phase)


@loop_njit
def fly(c, state, stop):
    """Search a flight for its first contact until `stop`, in time since the last event; the room holds its step.

    Returns
    -------
    (code, tau, side)
        With CONTACT, time since the last event and the wall; the state is left in the step in which it happens.
    """
    f = c.field
    order = f.order
    a = coefficients(f)
    for _ in range(MAX_STEPS):
        since = state[SINCE]
        h = open_step(c, state)
        if not h > 0.0:
            break
        if c.walls != 0.0:
            wall = int(state[S_WALL]) if since == 0.0 else 0
            code, s, side = hit_within(
                f, h, state[CLEAR], min(h, stop - since), wall, wall != 0 and state[S_RELEASED] != 0.0, since
            )
            if code == CONTACT:
                return CONTACT, since + s, side
            state[CLEAR] = s
            if code == STEP_CAP:
                return STEP_CAP, since + s, 0
        if since + h >= stop:
            return NO_CONTACT, stop, 0
        x, v = at(a, X, order, h)
        w, u = at(a, W, order, h)
        begin_step(state, since + h, x, v, w, u)
    return STEP_CAP, state[SINCE], 0


@loop_njit
def flown_from(f, x, v, w, u, phase, tau):
    """Return x1, x1', w, w' of a flight a time tau after a state."""
    a = coefficients(f)
    done = 0.0
    while True:
        h = expand(f, x, v, w, u, advance_phase(phase, f.Omega * done))
        left = tau - done
        h = min(h, left)
        x, v = at(a, X, f.order, h)
        w, u = at(a, W, f.order, h)
        if not h < left:
            return x, v, w, u
        done += h
