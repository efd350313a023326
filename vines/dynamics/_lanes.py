"""One tick of all lanes: move by a certified step, look, and strike, close in on a wall, or choose the next step.

The mathematics is that of `vines.dynamics._contact` (docs/dynamics.md, "Lanes"), written without branches so that
LLVM does eight lanes at a time. What is rare (chatter, sticking, grazing, the end of a run) only raises the flag
WAITS; the scalar kernel then does it.
"""

from __future__ import annotations

import math

from vines.dynamics import _lane_fields as f
from vines.dynamics._contact import BEYOND
from vines.dynamics._jit import fused_njit, loop_njit
from vines.dynamics._sincos import eighth_turn
from vines.dynamics._steps import only_root, step_ahead, step_back, taylor_root
from vines.dynamics._sticking import OMITTED, UNRESOLVED

__all__ = ["half_turn", "small_expm1", "tick"]

LANES = f.LANES
SLOW = 1e-7
"""A certified step below this, in units of the shortest time scale, is left to the scalar kernel."""


@fused_njit
def half_turn(x):
    """Return (sin x, cos x) for |x| <= pi/2: those of half the angle, doubled."""
    s, c = eighth_turn(0.5 * x)
    t = 2.0 * s
    return t * c, 1.0 - t * s


@fused_njit
def small_expm1(x):
    """Return exp(x) - 1 for |x| <= 1.6: Taylor at an eighth of it, doubled three times without losing digits."""
    u = 0.125 * x
    m = u * (
        1.0
        + u
        * (
            1.0 / 2.0
            + u
            * (
                1.0 / 6.0
                + u
                * (
                    1.0 / 24.0
                    + u
                    * (
                        1.0 / 120.0
                        + u * (1.0 / 720.0 + u * (1.0 / 5040.0 + u * (1.0 / 40320.0 + u * (1.0 / 362880.0))))
                    )
                )
            )
        )
    )
    m = m * (2.0 + m)
    m = m * (2.0 + m)
    return m * (2.0 + m)


@loop_njit
def tick(L, cap):
    """Move every lane that does not wait by its step and choose the next one; `cap` is that of events in a period."""
    for i in range(LANES):
        half = L[f.HALF + i]
        inverse = L[f.INVERSE + i]
        omega = L[f.OMEGA + i]
        lam = L[f.LAM + i]
        window = L[f.WINDOW + i]
        q_re = L[f.Q_RE + i]
        q_im = L[f.Q_IM + i]
        xh = L[f.X_FREE + i]
        vh = L[f.V_FREE + i]
        cosine = L[f.COS + i]
        sine = L[f.SIN + i]
        ball = L[f.BALL + i]
        v2 = L[f.SPEED + i]
        move = L[f.MOVE + i]
        left = L[f.LEFT + i] - move
        tau = L[f.TAU + i] + move

        # Move: the free part by its flow, the forcing by its phasor, the ball straight on.
        decay = 1.0 + small_expm1(-half * move)
        s, c = half_turn(L[f.GAMMA + i] * move)
        s *= decay * inverse
        c *= decay
        drag = half * s
        moved = (c + drag) * xh + s * vh
        vh = (c - drag) * vh - s * xh
        xh = moved
        s, c = half_turn(omega * move)
        turned = cosine * c - sine * s
        sine = cosine * s + sine * c
        cosine = turned
        ball += v2 * move

        # Derivatives: each part obeys its own equation, so none is a difference of large numbers.
        omega2 = omega * omega
        xq = q_re * cosine - q_im * sine
        yq = q_re * sine + q_im * cosine
        vq = -omega * yq
        aq = -omega2 * xq
        jq = -omega2 * vq
        kq = -omega2 * aq
        lq = -omega2 * jq
        ah = -lam * vh - xh
        jh = -lam * ah - vh
        kh = -lam * jh - ah
        lh = -lam * kh - jh
        mh = -lam * lh - kh
        closing = (vh + vq) - v2
        polish = L[f.POLISH + i]
        polishing = polish > 0.0
        side = 1.0 if closing > 0.0 else -1.0
        side = L[f.SIDE + i] if polishing else side
        gap = 1.0 - side * ((xh + xq) - ball)
        d1 = side * closing
        d2 = side * (ah + aq)
        d3 = side * (jh + jq)
        d4 = side * (kh + kq)
        d5 = side * (lh + lq)
        d6 = side * (mh - omega2 * kq)

        # The root of the Taylor polynomial. Is it certain that it is the only one, and the first? While polishing it is
        # known to lie in an older bracket.
        h, correction = taylor_root(gap, d1, d2, d3, d4, d5, d6)
        fifth = L[f.FREE5 + i] + L[f.FORCED5 + i]
        reach = BEYOND * h
        unique = only_root(gap, d1, d2, d3, d4, fifth, reach) & (reach <= window)
        reach = L[f.REACH + i] if polishing else reach
        gone = L[f.GONE + i] + move if polishing else 0.0
        lost = polishing & ((gone + h < 0.0) | (gone + h > reach) | (not (abs(h) <= window)))
        aimed = (polishing & (not lost)) | ((not polishing) & unique)
        # Halley's steps triple the digits, but only from near by: where the last was not small, look again from there.
        close = aimed & (abs(h) <= L[f.NEAR + i]) & (abs(correction) <= 1e-4 * abs(h) + 1e-12)
        idle = L[f.WAITS + i] > 0.0
        hit = close & (left > h) & (tau + h > 0.0) & (not idle)
        jump = aimed & (not close)

        # Strike: the last bit of the way by Taylor, then the impact law.
        h1 = h if hit else 0.0
        xh += h1 * (vh + h1 * (0.5 * ah + h1 * (jh * (1 / 6) + h1 * (kh * (1 / 24) + h1 * lh * (1 / 120)))))
        vh += h1 * (ah + h1 * (0.5 * jh + h1 * (kh * (1 / 6) + h1 * (lh * (1 / 24) + h1 * mh * (1 / 120)))))
        angle = omega * h1
        square = angle * angle
        s = angle * (1.0 - square * (1 / 6 - square * (1 / 120)))
        c = 1.0 - square * (0.5 - square * (1 / 24 - square * (1 / 720)))
        turned = cosine * c - sine * s
        sine = cosine * s + sine * c
        cosine = turned
        # The phasor must not shrink or grow by rounding over millions of ticks.
        length = 1.5 - 0.5 * (cosine * cosine + sine * sine)
        cosine *= length
        sine *= length
        left -= h1
        tau += h1
        ball += v2 * h1
        xq = q_re * cosine - q_im * sine
        yq = q_re * sine + q_im * cosine
        vq = -omega * yq
        v1 = vh + vq
        closing = v1 - v2
        L[f.HIT + i] = 1.0 if hit else 0.0
        L[f.FLIGHT + i] = tau
        L[f.BEFORE1 + i] = v1
        L[f.BEFORE2 + i] = v2
        vh -= L[f.PASS1 + i] * closing if hit else 0.0
        v2 += L[f.PASS2 + i] * closing if hit else 0.0
        ball = (xh + xq) - side if hit else ball
        tau = 0.0 if hit else tau
        rest = (vh + half * xh) * inverse
        size = math.sqrt(xh * xh + rest * rest)
        free5 = size if hit else L[f.FREE5 + i]
        wall = L[f.WALL + i]
        chain = L[f.CHAIN + i]
        chain = (chain + 1.0 if wall == side else 1.0) if hit else chain
        wall = side if hit else wall

        # The next certified step, towards the wall ahead and back to the one behind; just left, its gap is 0 exactly.
        aq = -omega2 * xq
        ah = -lam * vh - xh
        jh = -lam * ah - vh
        kh = -lam * jh - ah
        closing = (vh + vq) - v2
        ahead = 1.0 if closing > 0.0 else -1.0
        ahead = -side if hit else ahead
        pace = abs(closing)
        w = ahead * ((xh + xq) - ball)
        d2 = ahead * (ah + aq)
        d3 = ahead * (jh - omega2 * vq)
        d4 = ahead * (kh - omega2 * aq)
        fifth = free5 + L[f.FORCED5 + i]
        gap = max(1.0 - w, 0.0)
        forth = step_ahead(gap, pace, d2, d3, d4, fifth, min(window, 1.5 * gap / pace))
        gap = 0.0 if hit else max(1.0 + w, 0.0)
        back = step_back(gap, pace, -d2, -d3, -d4, fifth, window)
        step = min(forth, back, window)
        step = h if jump else step

        # What the scalar kernel has to see: a chatter about to end, tiny steps, a lost bracket, the end of the run.
        push = -d2
        # (A little looser than `merges`, which then decides: so both kernels merge a chatter at the same impact.)
        height = 1.05 * UNRESOLVED * (4.0 + 2.0 * free5 + (2.0 + omega) * (abs(xq) + abs(yq)) + abs(ball))
        cube = pace * pace * pace
        merging = (push > 0.0) & (
            (L[f.CORRECTION + i] * cube < 1.05 * OMITTED * push * push)
            | (pace * pace < height * push)
            | (2.0 * cube < height * height * max(-d3, 0.0))
        )
        slow = (not jump) & (not (step >= SLOW))
        ending = not (left > step + 1e-9)
        period = L[f.PERIOD + i]
        fresh = L[f.BEGAN + i] - left >= period
        busy = 0.0 if fresh else L[f.BUSY + i]
        busy += 1.0 if hit else 0.0
        polish = polish + 1.0 if jump else 0.0
        waits = (hit & merging) | slow | lost | ending | (close & (not hit)) | (polish > 8.0) | (busy > cap)
        L[f.X_FREE + i] = xh
        L[f.V_FREE + i] = vh
        L[f.COS + i] = cosine
        L[f.SIN + i] = sine
        L[f.BALL + i] = ball
        L[f.SPEED + i] = v2
        L[f.LEFT + i] = left
        L[f.FREE5 + i] = free5
        L[f.POLISH + i] = polish
        L[f.SIDE + i] = side
        L[f.REACH + i] = reach
        L[f.GONE + i] = gone
        L[f.TAU + i] = tau
        L[f.WALL + i] = wall
        L[f.RELEASED + i] = 0.0 if hit else L[f.RELEASED + i]
        L[f.CHAIN + i] = chain
        L[f.BUSY + i] = busy
        L[f.BEGAN + i] = left if fresh else L[f.BEGAN + i]
        L[f.IMPACTS + i] += 1.0 if hit else 0.0
        L[f.MOVE + i] = 0.0 if (waits | idle) else step
        L[f.WAITS + i] = 1.0 if (waits | idle) else 0.0
