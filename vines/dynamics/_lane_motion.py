"""How lanes move: the oscillator's free part by its flow, the forcing as a unit phasor, the ball straight on."""

from __future__ import annotations

from vines.dynamics._sincos import ROUND, eighth_turn
from vines.kernels import fused_njit

__all__ = [
    "MOST_DECAY",
    "MOST_TURN",
    "NEAR_DECAY",
    "NEAR_TURN",
    "any_turn",
    "flow",
    "forced_motion",
    "free_derivatives",
    "half_turn",
    "kept",
    "short_flow",
    "small_expm1",
]

MOST_TURN = 6.28
"""Largest angle of one move: up to some hundred `any_turn` would be right to the last bit."""

MOST_DECAY = 0.8
"""Largest argument of `small_expm1`."""

NEAR_TURN = 0.2
"""Largest angle of `short_flow`: beyond, its polynomials would be wrong in the last bit."""

NEAR_DECAY = 0.03
"""Largest decay of `short_flow`."""

ONE_OVER_PI = 0.3183098861837907
PI_1 = 3.14159265346825122833
PI_2 = 1.21542010130121322635e-10


@fused_njit
def kept(value, unit):
    """Return a value that a field keeps unless something happens, times a 1 that LLVM cannot know.

    Storing either a new value or what the field held, LLVM would take a masked store, which costs ten ordinary ones on
    some processors.
    """
    return value * unit


@fused_njit
def half_turn(x):
    """Return (sin x, cos x) for |x| <= 1.64: those of half the angle, doubled."""
    s, c = eighth_turn(0.5 * x)
    t = 2.0 * s
    return t * c, 1.0 - t * s


@fused_njit
def any_turn(x):
    """Return (sin x, cos x): half turns are taken off, and an odd number of them changes both signs."""
    n = (x * ONE_OVER_PI + ROUND) - ROUND
    s, c = half_turn((x - n * PI_1) - n * PI_2)
    odd = abs(n - 2.0 * ((0.5 * n + ROUND) - ROUND))
    sign = 1.0 - 2.0 * odd
    return sign * s, sign * c


@fused_njit
def small_expm1(x):
    """Return exp(x) - 1 for |x| <= MOST_DECAY: Taylor at an eighth of it, doubled three times without losing digits."""
    u = 0.125 * x
    m = 1.0 / 5040.0 + u * (1.0 / 40320.0 + u * (1.0 / 362880.0))
    m = u * (1.0 + u * (1.0 / 2.0 + u * (1.0 / 6.0 + u * (1.0 / 24.0 + u * (1.0 / 120.0 + u * (1.0 / 720.0 + u * m))))))
    m = m * (2.0 + m)
    m = m * (2.0 + m)
    return m * (2.0 + m)


@fused_njit
def _moved(half, inverse, xh, vh, decay, s, c):
    """Return free displacement and velocity after a turn by (s, c)."""
    s *= decay * inverse
    c *= decay
    drag = half * s
    return (c + drag) * xh + s * vh, (c - drag) * vh - s * xh


@fused_njit
def flow(half, gamma, inverse, omega, xh, vh, cosine, sine, h):
    """Return free displacement and velocity and the phasor a time h later."""
    s, c = any_turn(gamma * h)
    moved, speed = _moved(half, inverse, xh, vh, 1.0 + small_expm1(-half * h), s, c)
    s, c = any_turn(omega * h)
    return moved, speed, cosine * c - sine * s, cosine * s + sine * c


@fused_njit
def _small_turn(x):
    """Return (sin x, cos x) for |x| <= NEAR_TURN by Taylor."""
    z = x * x
    s = x - x * z * (1 / 6 - z * (1 / 120 - z * (1 / 5040 - z * (1 / 362880 - z * (1 / 39916800)))))
    return s, 1.0 - z * (0.5 - z * (1 / 24 - z * (1 / 720 - z * (1 / 40320 - z * (1 / 3628800)))))


@fused_njit
def short_flow(half, gamma, inverse, omega, xh, vh, cosine, sine, h):
    """Return what `flow` does for a time h of either sign with angles below NEAR_TURN, decay below NEAR_DECAY."""
    s, c = _small_turn(gamma * h)
    y = half * h
    decay = 1.0 - y * (1.0 - y * (1 / 2 - y * (1 / 6 - y * (1 / 24 - y * (1 / 120 - y * (1 / 720 - y * (1 / 5040)))))))
    moved, speed = _moved(half, inverse, xh, vh, decay, s, c)
    s, c = _small_turn(omega * h)
    return moved, speed, cosine * c - sine * s, cosine * s + sine * c


@fused_njit
def free_derivatives(lam, xh, vh):
    """Return the second to sixth derivative of the free part: each from its own equation, no large differences."""
    a = -lam * vh - xh
    j = -lam * a - vh
    k = -lam * j - a
    fifth = -lam * k - j
    return a, j, k, fifth, -lam * fifth - k


@fused_njit
def forced_motion(q_re, q_im, omega, cosine, sine):
    """Return the steady response and its quadrature, and its velocity."""
    yq = q_re * sine + q_im * cosine
    return q_re * cosine - q_im * sine, yq, -omega * yq
