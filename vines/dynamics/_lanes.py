"""One tick of all lanes: move to where the next contact is expected, find it, prove that none came before, and strike.

The mathematics is in docs/dynamics.md, "Lanes", written without branches so that LLVM does a vector of lanes at a
time. What is rare (chatter, sticking, grazing, the end of a run) only raises the flag WAITS; the scalar kernel then
does it.
"""

from __future__ import annotations

from vines.dynamics import _lane_fields as f
from vines.dynamics._lane_certificate import certify
from vines.dynamics._lane_guess import GROUP, predict
from vines.dynamics._lane_motion import forced_motion, kept
from vines.dynamics._lane_strike import aim, arrive, go, strike
from vines.dynamics._sticking import OMITTED, UNRESOLVED
from vines.kernels import fused_njit, loop_njit

__all__ = ["HEIGHT_OF_BOUND", "LOOSER", "choose", "octagon", "tick"]

LANES = f.LANES

SLOW = 1e-7
"""A move below this is left to the scalar kernel."""

ONWARD = 0.25
"""Share of the longest move by which a lane goes on where no contact is in sight."""

MOST_TRIES = 8.0
"""Moves of a flight that were not certified before the scalar kernel takes it."""

FORGOTTEN = 300.0
"""Decay of a flight's free part, as its logarithm, before the scalar kernel takes the flight: that goes back to the
start, and from twice as far no double comes back."""

LOOSER = 1.05
"""The lanes' test for a merge is looser than `merges`, which then decides: both kernels merge at the same impact."""

HEIGHT_OF_BOUND = LOOSER * UNRESOLVED * 2.42
"""Part of the unresolved height that grows with the free motion (see `fill_lane`)."""


@fused_njit
def octagon(a, b):
    """Return a bound of the length of (a, b), at most 8 % above it: the octagon around a circle."""
    a = abs(a)
    b = abs(b)
    return 1.000000001 * (max(a, b) + 0.4142135623730952 * min(a, b))


@fused_njit
def _merges(correction, height, pace, push, jerk):
    """Say whether a ball that leaves a wall at `pace` may be about to stick."""
    cube = pace * pace * pace
    return (push > 0.0) & (
        (correction * cube < LOOSER * OMITTED * push * push)
        | (pace * pace < height * push)
        | (2.0 * cube < height * height * max(jerk, 0.0))
    )


@loop_njit
def choose(L, cap):
    """Choose the next move of every lane; `cap` is that of events in a period."""
    for i in range(LANES):
        unit = L[f.UNIT + i]
        half = L[f.HALF + i]
        omega2 = L[f.OMEGA + i] * L[f.OMEGA + i]
        lam = L[f.LAM + i]
        xh = L[f.X_FREE + i]
        vh = L[f.V_FREE + i]
        left = L[f.LEFT + i]
        side = L[f.SIDE + i]
        limit = L[f.LIMIT + i]
        ahead = L[f.AHEAD + i]
        step = L[f.STEP + i]
        hit = L[f.HIT + i] > 0.0
        clear = L[f.CLEAR + i] > 0.0
        close = L[f.CLOSE + i] > 0.0

        # After an impact the free motion is another one; the ball leaves the wall for good or is pushed against it.
        xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], L[f.OMEGA + i], L[f.COS + i], L[f.SIN + i])
        now = octagon(xh, (vh + half * xh) * L[f.INVERSE + i])
        most = kept(L[f.AMPLITUDE + i], unit)
        most = now if hit else most
        L[f.AMPLITUDE + i] = most
        ah = -lam * vh - xh
        jh = -lam * ah - vh
        height = L[f.HEIGHT + i] + HEIGHT_OF_BOUND * most
        pace = abs((vh + vq) - L[f.SPEED + i])
        push = side * (ah - omega2 * xq)
        merges = hit & _merges(L[f.CORRECTION + i], height, pace, push, side * (jh - omega2 * vq))

        # On from a certified move: to the contact ahead, if there is one. Else back to a contact before its end, or
        # half of the way: a contact is looked for again from there.
        onward = ahead if (ahead > 0.0) & (ahead <= limit) else ONWARD * limit
        nearer = step + ahead
        nearer = nearer if (not close) & (nearer > 0.25 * step) & (nearer < step) else 0.5 * step
        move = onward if clear else nearer
        move = min(L[f.ONE_BEFORE + i], limit) if hit else move

        tries = L[f.TRIES + i] + (0.0 if clear else 1.0)
        tries = 0.0 if hit else tries
        began = kept(L[f.BEGAN + i], unit)
        busy = L[f.BUSY + i]
        fresh = began - left >= L[f.PERIOD + i]
        busy = (0.0 if fresh else busy) + (1.0 if hit else 0.0)
        # What the scalar kernel has to see: a chatter about to end, tiny steps, hard flights, the end of the run.
        slow = not (move >= SLOW)
        ending = not (left > move + 1e-9)
        long = (not hit) & (half * L[f.TAU + i] > FORGOTTEN)
        odd = merges | (L[f.WAITS + i] > 0.0) | (tries > MOST_TRIES) | (busy > cap) | long
        waits = slow | ending | odd
        wall = kept(L[f.WALL + i], unit)
        chain = kept(L[f.CHAIN + i], unit)
        released = kept(L[f.RELEASED + i], unit)
        again = chain + 1.0 if wall == side else 1.0
        L[f.CHAIN + i] = again if hit else chain
        L[f.WALL + i] = side if hit else wall
        L[f.RELEASED + i] = 0.0 if hit else released
        L[f.TRIES + i] = tries
        L[f.BUSY + i] = busy
        L[f.BEGAN + i] = left if fresh else began
        L[f.IMPACTS + i] += 1.0 if hit else 0.0
        L[f.MOVE + i] = 0.0 if waits else move
        L[f.WAITS + i] = 1.0 if waits else 0.0


@loop_njit
def tick(L, cap):
    """Move every lane that does not wait to where its next contact may be, strike if it is one, and choose again."""
    go(L)
    aim(L)
    arrive(L)
    certify(L)
    strike(L)
    choose(L, cap)
    for i in range(0, LANES, GROUP):
        rough = False
        for k in range(i, i + GROUP):
            rough |= L[f.ROUGH + k] > 0.0
        if rough:
            predict(L[i:])
