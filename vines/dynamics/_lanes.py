"""One tick of all lanes: move by a certified step, look, go to the contact and strike, choose the next step.

The mathematics is that of `vines.dynamics._contact` (docs/dynamics.md, "Lanes"), written without branches so that
LLVM does a vector of lanes at a time. What is rare (chatter, sticking, grazing, the end of a run) only raises the flag
WAITS; the scalar kernel then does it.
"""

from __future__ import annotations

from vines.dynamics import _lane_fields as f
from vines.dynamics._lane_motion import forced_motion, free_derivatives, go_to_root, kept, step_on
from vines.dynamics._lane_strike import look, polish, strike
from vines.dynamics._steps import step_ahead, step_back
from vines.dynamics._sticking import OMITTED, UNRESOLVED
from vines.kernels import fused_njit, loop_njit

__all__ = ["HEIGHT_OF_BOUND", "LOOSER", "certify", "choose", "tick"]

LANES = f.LANES

SLOW = 1e-7
"""A certified step below this, in units of the shortest time scale, is left to the scalar kernel."""

LOOSER = 1.05
"""The lanes' test for a merge is looser than `merges`, which then decides: both kernels merge at the same impact."""

HEIGHT_OF_BOUND = LOOSER * UNRESOLVED * 2.42
"""Part of the unresolved height that grows with the free motion, of which MOST5 is a bound (see `fill_lane`)."""


@fused_njit
def _size(a, b):
    """Return a bound of the length of (a, b), at most 8 % above it: the octagon around a circle."""
    a = abs(a)
    b = abs(b)
    return max(a, b) + 0.4142135623730952 * min(a, b)


@loop_njit
def certify(L):
    """Find the certified step of every lane, and whether a ball that has just struck may be about to stick."""
    for i in range(LANES):
        unit = L[f.UNIT + i]
        inverse = L[f.INVERSE + i]
        half = L[f.HALF + i]
        omega = L[f.OMEGA + i]
        limit = L[f.LIMIT + i]
        xh = L[f.X_FREE + i]
        vh = L[f.V_FREE + i]
        hit = L[f.HIT + i] > 0.0

        # The fifth derivative of u at the start of a flight, and a bound of it that does not grow with time.
        xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], omega, L[f.COS + i], L[f.SIN + i])
        ah, jh, kh, lh, mh = free_derivatives(L[f.LAM + i], xh, vh)
        omega2 = omega * omega
        omega4 = omega2 * omega2
        quadrature = omega4 * omega * xq - (mh + half * lh) * inverse
        free5 = kept(L[f.FREE5 + i], unit)
        most5 = kept(L[f.MOST5 + i], unit)
        now5 = _size(lh + omega4 * vq, quadrature)
        ever5 = _size(xh, (vh + half * xh) * inverse) + L[f.FORCED5 + i]
        free5 = now5 if hit else free5
        most5 = ever5 if hit else most5
        L[f.FREE5 + i] = free5
        L[f.MOST5 + i] = most5
        fifth = min(free5 + L[f.GROW5 + i] * (L[f.TAU + i] + limit), most5)

        # Towards the wall ahead and back to the one behind; just left, its gap is 0 exactly.
        closing = (vh + vq) - L[f.SPEED + i]
        ahead = 1.0 if closing > 0.0 else -1.0
        ahead = -L[f.SIDE + i] if hit else ahead
        pace = abs(closing)
        w = ahead * ((xh + xq) - L[f.BALL + i])
        d2 = ahead * (ah - omega2 * xq)
        d3 = ahead * (jh - omega2 * vq)
        d4 = ahead * (kh + omega4 * xq)
        forth = step_ahead(max(1.0 - w, 0.0), pace, d2, d3, d4, fifth, limit)
        back = step_back(0.0 if hit else max(1.0 + w, 0.0), pace, -d2, -d3, -d4, fifth, limit)
        L[f.MOVE + i] = min(forth, back)

        push = -d2
        height = L[f.HEIGHT + i] + HEIGHT_OF_BOUND * most5
        cube = pace * pace * pace
        merges = (push > 0.0) & (
            (L[f.CORRECTION + i] * cube < LOOSER * OMITTED * push * push)
            | (pace * pace < height * push)
            | (2.0 * cube < height * height * max(-d3, 0.0))
        )
        L[f.MERGES + i] = 1.0 if hit & merges else 0.0


@loop_njit
def choose(L, cap):
    """Choose the next step of every lane; `cap` is that of events in a period."""
    for i in range(LANES):
        unit = L[f.UNIT + i]
        left = L[f.LEFT + i]
        side = L[f.SIDE + i]
        h = L[f.ROOT + i]
        step = L[f.MOVE + i]
        tries = L[f.POLISH + i]
        aimed = L[f.AIMED + i] > 0.0
        close = L[f.CLOSE + i] > 0.0
        hit = L[f.HIT + i] > 0.0
        jump = aimed & (not close)
        step = h if jump else step

        # What the scalar kernel has to see: a chatter about to end, tiny steps, a lost bracket, the end of the run.
        lost = ((tries > 0.0) & (not aimed)) | (jump & (not (abs(h) <= L[f.LIMIT + i])))
        slow = (not jump) & (not (step >= SLOW))
        ending = not (left > step + 1e-9)
        began = kept(L[f.BEGAN + i], unit)
        busy = L[f.BUSY + i]
        fresh = began - left >= L[f.PERIOD + i]
        busy = (0.0 if fresh else busy) + (1.0 if hit else 0.0)
        tries = tries + 1.0 if jump else 0.0
        odd = (L[f.MERGES + i] > 0.0) | (L[f.WAITS + i] > 0.0) | (close & (not hit)) | (tries > 8.0) | (busy > cap)
        waits = slow | lost | ending | odd
        wall = kept(L[f.WALL + i], unit)
        chain = kept(L[f.CHAIN + i], unit)
        released = kept(L[f.RELEASED + i], unit)
        again = chain + 1.0 if wall == side else 1.0
        L[f.CHAIN + i] = again if hit else chain
        L[f.WALL + i] = side if hit else wall
        L[f.RELEASED + i] = 0.0 if hit else released
        L[f.POLISH + i] = tries
        L[f.BUSY + i] = busy
        L[f.BEGAN + i] = left if fresh else began
        L[f.IMPACTS + i] += 1.0 if hit else 0.0
        L[f.MOVE + i] = 0.0 if waits else step
        L[f.WAITS + i] = 1.0 if waits else 0.0


@loop_njit
def tick(L, cap):
    """Move every lane that does not wait by its step, strike where a contact is certain, and choose the next step."""
    step_on(L)
    look(L)
    go_to_root(L)
    polish(L)
    strike(L)
    certify(L)
    choose(L, cap)
