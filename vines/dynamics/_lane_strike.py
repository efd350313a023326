"""The middle of a tick: is the next contact certain, how far is it, and the impact itself.

They are loops of their own because short loops let the processor work at several vectors at once.
"""

from __future__ import annotations

from vines.dynamics import _lane_fields as f
from vines.dynamics._contact import BEYOND
from vines.dynamics._lane_motion import forced_motion, free_derivatives, kept
from vines.dynamics._steps import only_root, taylor_root
from vines.kernels import loop_njit

__all__ = ["look", "polish", "strike"]

LANES = f.LANES


@loop_njit
def look(L):
    """Find the way to the contact of every lane in which it is certain that there is one, and that it is the first.

    While polishing it is known to lie in an older bracket. Elsewhere the way is 0.
    """
    for i in range(LANES):
        omega = L[f.OMEGA + i]
        window = L[f.WINDOW + i]
        v2 = L[f.SPEED + i]
        xh = L[f.X_FREE + i]
        vh = L[f.V_FREE + i]
        xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], omega, L[f.COS + i], L[f.SIN + i])
        ah, jh, kh, lh, mh = free_derivatives(L[f.LAM + i], xh, vh)
        omega2 = omega * omega
        aq = -omega2 * xq
        jq = -omega2 * vq
        kq = -omega2 * aq
        closing = (vh + vq) - v2
        polishing = L[f.POLISH + i] > 0.0
        side = 1.0 if closing > 0.0 else -1.0
        aim = kept(L[f.SIDE + i], L[f.UNIT + i])
        side = aim if polishing else side
        gap = 1.0 - side * ((xh + xq) - L[f.BALL + i])
        d1 = side * closing
        d2 = side * (ah + aq)
        d3 = side * (jh + jq)
        d4 = side * (kh + kq)
        h, _ = taylor_root(gap, d1, d2, d3, d4, side * (lh - omega2 * jq), side * (mh - omega2 * kq))
        fifth = min(L[f.FREE5 + i] + L[f.GROW5 + i] * (L[f.TAU + i] + window), L[f.MOST5 + i])
        reach = BEYOND * h
        unique = only_root(gap, d1, d2, d3, d4, fifth, reach) & (reach <= window)
        bracket = kept(L[f.REACH + i], L[f.UNIT + i])
        reach = bracket if polishing else reach
        begun = L[f.GONE + i] + L[f.MOVE + i]
        gone = (begun if polishing else 0.0) + h
        inside = (gone >= 0.0) & (gone <= reach) & (abs(h) <= L[f.LIMIT + i])
        aimed = (polishing | unique) & inside & (L[f.WAITS + i] == 0.0)
        L[f.SIDE + i] = side
        L[f.REACH + i] = reach
        L[f.GONE + i] = gone
        L[f.AIMED + i] = 1.0 if aimed else 0.0
        L[f.ROOT + i] = h if aimed else 0.0


@loop_njit
def polish(L):
    """Find the way to the contact from where the lane now is, and whether it is struck in this tick."""
    for i in range(LANES):
        omega = L[f.OMEGA + i]
        xh = L[f.X_FREE + i]
        vh = L[f.V_FREE + i]
        side = L[f.SIDE + i]
        xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], omega, L[f.COS + i], L[f.SIN + i])
        ah, jh, kh, lh, mh = free_derivatives(L[f.LAM + i], xh, vh)
        omega2 = omega * omega
        aq = -omega2 * xq
        jq = -omega2 * vq
        kq = -omega2 * aq
        h, correction = taylor_root(
            1.0 - side * ((xh + xq) - L[f.BALL + i]),
            side * ((vh + vq) - L[f.SPEED + i]),
            side * (ah + aq),
            side * (jh + jq),
            side * (kh + kq),
            side * (lh - omega2 * jq),
            side * (mh - omega2 * kq),
        )
        # Halley's steps triple the digits, but only from near by: where the last was not small, look again from there.
        near = (abs(h) <= L[f.NEAR + i]) & (abs(correction) <= 1e-4 * abs(h) + 1e-12)
        close = near & (L[f.AIMED + i] > 0.0)
        hit = close & (L[f.LEFT + i] > h) & (L[f.TAU + i] + h > 0.0)
        L[f.ROOT + i] = h
        L[f.CLOSE + i] = 1.0 if close else 0.0
        L[f.HIT + i] = 1.0 if hit else 0.0


@loop_njit
def strike(L):
    """Where a lane strikes, go the last bit of the way by Taylor's polynomial, and apply the impact law."""
    for i in range(LANES):
        omega = L[f.OMEGA + i]
        q_re = L[f.Q_RE + i]
        q_im = L[f.Q_IM + i]
        v2 = L[f.SPEED + i]
        xh = L[f.X_FREE + i]
        vh = L[f.V_FREE + i]
        cosine = L[f.COS + i]
        sine = L[f.SIN + i]
        ball = L[f.BALL + i]
        hit = L[f.HIT + i] > 0.0
        root = L[f.ROOT + i]
        h = root if hit else 0.0
        ah, jh, kh, lh, mh = free_derivatives(L[f.LAM + i], xh, vh)
        xh += h * (vh + h * (0.5 * ah + h * (jh * (1 / 6) + h * (kh * (1 / 24) + h * lh * (1 / 120)))))
        vh += h * (ah + h * (0.5 * jh + h * (kh * (1 / 6) + h * (lh * (1 / 24) + h * mh * (1 / 120)))))
        angle = omega * h
        square = angle * angle
        s = angle * (1.0 - square * (1 / 6 - square * (1 / 120)))
        c = 1.0 - square * (0.5 - square * (1 / 24 - square * (1 / 720)))
        turned = cosine * c - sine * s
        sine = cosine * s + sine * c
        # The phasor must not shrink or grow by rounding over millions of ticks.
        length = 1.5 - 0.5 * (turned * turned + sine * sine)
        cosine = turned * length
        sine *= length
        xq, _, vq = forced_motion(q_re, q_im, omega, cosine, sine)
        v1 = vh + vq
        closing = v1 - v2
        tau = L[f.TAU + i] + h
        L[f.FLIGHT + i] = tau
        L[f.BEFORE1 + i] = v1
        L[f.BEFORE2 + i] = v2
        given = L[f.PASS1 + i] * closing
        taken = L[f.PASS2 + i] * closing
        L[f.X_FREE + i] = xh
        L[f.V_FREE + i] = vh - (given if hit else 0.0)
        L[f.COS + i] = cosine
        L[f.SIN + i] = sine
        L[f.BALL + i] = (xh + xq) - L[f.SIDE + i] if hit else kept(ball, L[f.UNIT + i])
        L[f.SPEED + i] = v2 + (taken if hit else 0.0)
        L[f.LEFT + i] -= h
        L[f.TAU + i] = 0.0 if hit else tau
