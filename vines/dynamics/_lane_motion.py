"""How lanes move: the oscillator's free part by its flow, the forcing as a unit phasor, the ball straight on."""

from __future__ import annotations

from vines.dynamics import _lane_fields as f
from vines.dynamics._sincos import eighth_turn
from vines.kernels import fused_njit, loop_njit

__all__ = [
    "MOST_DECAY",
    "MOST_TURN",
    "flow",
    "forced_motion",
    "free_derivatives",
    "go_to_root",
    "half_turn",
    "small_expm1",
    "step_on",
]

LANES = f.LANES

MOST_TURN = 1.64
"""Largest angle of `half_turn`: at half of it the polynomials of `eighth_turn` are still right to the last bit."""

MOST_DECAY = 0.4
"""Largest argument of `small_expm1`."""


@fused_njit
def kept(value, unit):
    """Return a value that a field keeps unless something happens, times a 1 that LLVM cannot know.

    Storing either a new value or what the field held, LLVM would take a masked store, which costs ten ordinary ones on
    some processors.
    """
    return value * unit


@fused_njit
def half_turn(x):
    """Return (sin x, cos x) for |x| <= MOST_TURN: those of half the angle, doubled."""
    s, c = eighth_turn(0.5 * x)
    t = 2.0 * s
    return t * c, 1.0 - t * s


@fused_njit
def small_expm1(x):
    """Return exp(x) - 1 for |x| <= MOST_DECAY: Taylor at a quarter of it, doubled twice without losing digits."""
    u = 0.25 * x
    m = 1.0 / 5040.0 + u * (1.0 / 40320.0 + u * (1.0 / 362880.0))
    m = u * (1.0 + u * (1.0 / 2.0 + u * (1.0 / 6.0 + u * (1.0 / 24.0 + u * (1.0 / 120.0 + u * (1.0 / 720.0 + u * m))))))
    m = m * (2.0 + m)
    return m * (2.0 + m)


@fused_njit
def flow(half, gamma, inverse, omega, xh, vh, cosine, sine, h):
    """Return free displacement and velocity and the phasor a time h later."""
    decay = 1.0 + small_expm1(-half * h)
    s, c = half_turn(gamma * h)
    s *= decay * inverse
    c *= decay
    drag = half * s
    moved = (c + drag) * xh + s * vh
    speed = (c - drag) * vh - s * xh
    s, c = half_turn(omega * h)
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


@fused_njit
def _move_by(L, field):
    """Move every lane by the time that stands in a field, which LLVM has to know to make vectors."""
    for i in range(LANES):
        h = L[field + i]
        xh, vh, cosine, sine = flow(
            L[f.HALF + i],
            L[f.GAMMA + i],
            L[f.INVERSE + i],
            L[f.OMEGA + i],
            L[f.X_FREE + i],
            L[f.V_FREE + i],
            L[f.COS + i],
            L[f.SIN + i],
            h,
        )
        L[f.X_FREE + i] = xh
        L[f.V_FREE + i] = vh
        L[f.COS + i] = cosine
        L[f.SIN + i] = sine
        L[f.BALL + i] += L[f.SPEED + i] * h
        L[f.TAU + i] += h
        L[f.LEFT + i] -= h


@loop_njit
def step_on(L):
    """Move every lane by its next step."""
    _move_by(L, f.MOVE)


@loop_njit
def go_to_root(L):
    """Move every lane to the contact that it aims at."""
    _move_by(L, f.ROOT)
