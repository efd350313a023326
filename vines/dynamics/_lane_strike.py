"""The way to a contact in a tick: the move, the last bit of the way, and the impact itself.

They are loops of their own because short loops let the processor work at several vectors at once.
"""

from __future__ import annotations

from vines.dynamics import _lane_fields as f
from vines.dynamics._lane_motion import flow, forced_motion, free_derivatives, kept, short_flow
from vines.dynamics._steps import taylor_root
from vines.kernels import loop_njit

__all__ = ["aim", "arrive", "go", "strike"]

LANES = f.LANES

FRESH = 0.25
"""Share of the last flight in the running mean of their lengths."""

EXACT = 1.5e-5
"""Largest last correction, in units of NEAR: its cube, as the next would be, is below rounding."""

ALIKE = 0.2
"""By how much two flights may differ, in units of NEAR and of their length, for the next to be like the one between."""


@loop_njit
def go(L):
    """Find where every lane comes to by its next move."""
    for i in range(LANES):
        xh, vh, cosine, sine = flow(
            L[f.HALF + i],
            L[f.GAMMA + i],
            L[f.INVERSE + i],
            L[f.OMEGA + i],
            L[f.X_FREE + i],
            L[f.V_FREE + i],
            L[f.COS + i],
            L[f.SIN + i],
            L[f.MOVE + i],
        )
        L[f.END_X + i] = xh
        L[f.END_V + i] = vh
        L[f.END_COS + i] = cosine
        L[f.END_SIN + i] = sine


@loop_njit
def aim(L):
    """Find the way from there to the nearest contact with the wall ahead of the ball, and whether it is short."""
    for i in range(LANES):
        omega = L[f.OMEGA + i]
        xh = L[f.END_X + i]
        vh = L[f.END_V + i]
        move = L[f.MOVE + i]
        speed = L[f.SPEED + i]
        xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], omega, L[f.END_COS + i], L[f.END_SIN + i])
        ah, jh, kh, lh, mh = free_derivatives(L[f.LAM + i], xh, vh)
        omega2 = omega * omega
        aq = -omega2 * xq
        jq = -omega2 * vq
        kq = -omega2 * aq
        closing = (vh + vq) - speed
        side = 1.0 if closing > 0.0 else -1.0
        h, _ = taylor_root(
            1.0 - side * ((xh + xq) - (L[f.BALL + i] + speed * move)),
            side * closing,
            side * (ah + aq),
            side * (jh + jq),
            side * (kh + kq),
            side * (lh - omega2 * jq),
            side * (mh - omega2 * kq),
        )
        close = (abs(h) <= L[f.NEAR + i]) & (move + h > 0.0)
        L[f.SIDE + i] = side
        L[f.AHEAD + i] = h
        L[f.ROOT + i] = h if close else 0.0
        L[f.CLOSE + i] = 1.0 if close else 0.0


@loop_njit
def arrive(L):
    """Go that way where it is short, and correct it by Halley's step."""
    for i in range(LANES):
        omega = L[f.OMEGA + i]
        speed = L[f.SPEED + i]
        side = L[f.SIDE + i]
        h = L[f.ROOT + i]
        ahead = L[f.AHEAD + i]
        near = L[f.CLOSE + i] > 0.0
        xh, vh, cosine, sine = short_flow(
            L[f.HALF + i],
            L[f.GAMMA + i],
            L[f.INVERSE + i],
            omega,
            L[f.END_X + i],
            L[f.END_V + i],
            L[f.END_COS + i],
            L[f.END_SIN + i],
            h,
        )
        step = L[f.MOVE + i] + h
        xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], omega, cosine, sine)
        ah = -L[f.LAM + i] * vh - xh
        gap = side - ((xh + xq) - (L[f.BALL + i] + speed * step))
        closing = (vh + vq) - speed
        rest = 2.0 * gap * closing / (2.0 * closing * closing + (ah - omega * omega * xq) * gap)
        close = near & (abs(rest) <= EXACT * L[f.NEAR + i])
        last = rest if close else 0.0
        L[f.AHEAD + i] = rest if near else ahead
        L[f.CLOSE + i] = 1.0 if close else 0.0
        L[f.STEP + i] = step + last
        L[f.END_X + i] = xh + last * (vh + 0.5 * last * ah)
        L[f.END_V + i] = vh + last * (ah - 0.5 * last * (L[f.LAM + i] * ah + vh))
        angle = omega * last
        turned = cosine - angle * sine
        sine = sine + angle * cosine
        # The phasor must not shrink or grow by rounding over millions of ticks.
        length = 1.5 - 0.5 * (turned * turned + sine * sine)
        L[f.END_COS + i] = turned * length
        L[f.END_SIN + i] = sine * length


@loop_njit
def strike(L):
    """Go on to the end of every certified move, and apply the impact law where it is an impact."""
    for i in range(LANES):
        unit = L[f.UNIT + i]
        step = L[f.STEP + i]
        side = L[f.SIDE + i]
        hit = L[f.HIT + i] > 0.0
        goes = hit | (L[f.CLEAR + i] > 0.0)
        v2 = L[f.SPEED + i]
        ball = L[f.BALL + i]
        tau = L[f.TAU + i]
        xh = L[f.END_X + i]
        vh = L[f.END_V + i]
        cosine = L[f.END_COS + i]
        sine = L[f.END_SIN + i]
        old_x = kept(L[f.X_FREE + i], unit)
        old_v = kept(L[f.V_FREE + i], unit)
        old_cosine = kept(L[f.COS + i], unit)
        old_sine = kept(L[f.SIN + i], unit)
        xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], L[f.OMEGA + i], cosine, sine)
        v1 = vh + vq
        closing = v1 - v2
        L[f.BEFORE1 + i] = v1
        L[f.BEFORE2 + i] = v2
        given = L[f.PASS1 + i] * closing
        taken = L[f.PASS2 + i] * closing
        vh -= given if hit else 0.0
        L[f.X_FREE + i] = xh if goes else old_x
        L[f.V_FREE + i] = vh if goes else old_v
        L[f.COS + i] = cosine if goes else old_cosine
        L[f.SIN + i] = sine if goes else old_sine
        gone = step if goes else 0.0
        L[f.BALL + i] = (xh + xq) - side if hit else ball + v2 * gone
        L[f.SPEED + i] = v2 + (taken if hit else 0.0)
        L[f.LEFT + i] -= gone
        tau += gone
        L[f.FLIGHT + i] = tau
        L[f.TAU + i] = 0.0 if hit else tau
        # The last flight was like that two before it: then the next will be like the one before it.
        last = kept(L[f.LAST + i], unit)
        before = kept(L[f.ONE_BEFORE + i], unit)
        rough = hit & (not (abs(tau - before) <= ALIKE * min(L[f.NEAR + i], tau)))
        L[f.ROUGH + i] = 1.0 if rough else 0.0
        L[f.ONE_BEFORE + i] = last if hit else before
        L[f.LAST + i] = tau if hit else last
        usual = kept(L[f.USUAL + i], unit)
        L[f.USUAL + i] = usual + FRESH * (tau - usual) if hit else usual
