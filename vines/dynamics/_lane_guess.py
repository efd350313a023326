"""How long the next flight may last: what the search for its contact begins with. Nothing has to be right about it."""

from __future__ import annotations

from vines.dynamics import _lane_fields as f
from vines.dynamics._lane_motion import forced_motion, free_derivatives, kept
from vines.kernels import loop_njit

__all__ = ["GROUP", "predict"]

GROUP = 16
"""Lanes that are looked at together: two vectors, or four. On settled orbits few of them need a guess."""

HORIZON = 0.6
"""Share of the longest move up to which Taylor's polynomial of tenth order is of use."""

SHORT = 0.7
"""A hop below this share of the usual time is taken for the next flight."""


@loop_njit
def predict(L):
    """Find roughly how long the next flight will last, in the first of the lanes where they have struck.

    At the usual time, or after the hop to which the ball is pushed back, Taylor's polynomial of tenth order gives w and
    three derivatives, and these the next contact.
    """
    for i in range(GROUP):
        omega = L[f.OMEGA + i]
        lam = L[f.LAM + i]
        omega2 = omega * omega
        xh = L[f.X_FREE + i]
        vh = L[f.V_FREE + i]
        move = kept(L[f.MOVE + i], L[f.UNIT + i])
        horizon = HORIZON * L[f.LIMIT + i]
        usual = min(L[f.USUAL + i], horizon)
        xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], omega, L[f.COS + i], L[f.SIN + i])
        h2, h3, h4, h5, h6 = free_derivatives(lam, xh, vh)
        h7, h8, h9, h10, _ = free_derivatives(lam, h5, h6)
        q2 = -omega2 * xq
        q3 = -omega2 * vq
        q4 = -omega2 * q2
        q5 = -omega2 * q3
        q6 = -omega2 * q4
        q7 = -omega2 * q5
        q8 = -omega2 * q6
        w = (xh + xq) - L[f.BALL + i]
        v = (vh + vq) - L[f.SPEED + i]
        d2 = h2 + q2
        d3 = h3 + q3
        d4 = h4 + q4
        d5 = h5 + q5
        d6 = h6 + q6
        d7 = h7 + q7
        d8 = h8 + q8
        d9 = h9 - omega2 * q7
        d10 = h10 - omega2 * q8
        # Pushed back to the wall that it has left, as in a chatter, a ball hops: -pace + push t + jerk t^2 = 0. That is
        # solved by a step of Newton's from t = pace/push.
        pace = abs(v)
        push = -0.5 * d2 if v > 0.0 else 0.5 * d2
        jerk = (-1 / 6) * d3 if v > 0.0 else (1 / 6) * d3
        bend = push * push + jerk * pace
        rise = push * (bend + jerk * pace)
        hop = pace * bend / rise
        hops = (push > 0.0) & (rise > 0.0) & (hop > 0.0) & (hop < SHORT * usual)
        T = hop if hops else usual
        tail = d8 * (1 / 40320) + T * (d9 * (1 / 362880) + T * (d10 * (1 / 3628800)))
        middle = d5 * (1 / 120) + T * (d6 * (1 / 720) + T * (d7 * (1 / 5040) + T * tail))
        value = w + T * (v + T * (d2 * 0.5 + T * (d3 * (1 / 6) + T * (d4 * (1 / 24) + T * middle))))
        tail = d8 * (1 / 5040) + T * (d9 * (1 / 40320) + T * (d10 * (1 / 362880)))
        middle = d5 * (1 / 24) + T * (d6 * (1 / 120) + T * (d7 * (1 / 720) + T * tail))
        first = v + T * (d2 + T * (d3 * 0.5 + T * (d4 * (1 / 6) + T * middle)))
        tail = d8 * (1 / 720) + T * (d9 * (1 / 5040) + T * (d10 * (1 / 40320)))
        middle = d5 * (1 / 6) + T * (d6 * (1 / 24) + T * (d7 * (1 / 120) + T * tail))
        second = d2 + T * (d3 + T * (d4 * 0.5 + T * middle))
        tail = d8 * (1 / 120) + T * (d9 * (1 / 720) + T * (d10 * (1 / 5040)))
        third = d3 + T * (d4 + T * (d5 * 0.5 + T * (d6 * (1 / 6) + T * (d7 * (1 / 24) + T * tail))))
        # Householder's step of third order to the wall that it is moving to there.
        gap = (1.0 if first > 0.0 else -1.0) - value
        square = first * first
        bent = second * gap
        later = T + gap * (6.0 * square + 3.0 * bent) / (first * (6.0 * (square + bent)) + third * gap * gap)
        longest = min(2.5 * T, horizon)
        later = min(max(later, 0.3 * T), longest)
        fits = (L[f.ROUGH + i] > 0.0) & (L[f.WAITS + i] == 0.0) & (later + 1e-9 < L[f.LEFT + i])
        L[f.MOVE + i] = later if fits else move
