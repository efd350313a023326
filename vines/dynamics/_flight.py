"""Closed-form motion between events: the oscillator's two phasors, and what follows from them."""

from __future__ import annotations

import math

from vines.dynamics._jit import njit
from vines.dynamics._sincos import sincos

__all__ = ["advance_phase", "derivatives", "fourth_bound", "phasors", "turn"]


@njit
def phasors(o, Omega, x, v, phase):
    """Return z, q of x(t) = Re[z exp(s t) + q exp(i Omega t)] as four reals, from x, v and the phase at t = 0."""
    sine, cosine = sincos(phase)
    qr = o.qr * cosine - o.qi * sine
    qi = o.qr * sine + o.qi * cosine
    zr = x - qr
    zi = (-o.half * zr - Omega * qi - v) / o.gamma
    return zr, zi, qr, qi


@njit
def turn(o, Omega, zr, zi, qr, qi, tau):
    """Return both phasors at time tau, (z exp(s tau), q exp(i Omega tau)), as four reals."""
    decay = math.exp(-o.half * tau)
    sine, cosine = sincos(o.gamma * tau)
    sine *= decay
    cosine *= decay
    s, c = sincos(Omega * tau)
    return zr * cosine - zi * sine, zr * sine + zi * cosine, qr * c - qi * s, qr * s + qi * c


@njit
def derivatives(o, Omega, zr, zi, qr, qi):
    """Return x and its first four derivatives where the phasors are z, q."""
    Omega2 = Omega * Omega
    return (
        zr + qr,
        -o.half * zr - o.gamma * zi - Omega * qi,
        o.s2r * zr - o.s2i * zi - Omega2 * qr,
        o.s3r * zr - o.s3i * zi + Omega2 * Omega * qi,
        o.s4r * zr - o.s4i * zi + Omega2 * Omega2 * qr,
    )


@njit
def fourth_bound(c, zr, zi, qr, qi, fourth, window):
    """Return a bound of the oscillator's fourth derivative over a window of free flight (docs/dynamics.md).

    The second form matters near resonance, where both phasors are large and cancel.
    """
    z = math.sqrt(zr * zr + zi * zi)
    q = math.sqrt(qr * qr + qi * qi)
    o = c.free
    both_r = o.s4r * zr - o.s4i * zi + c.Omega4 * qr
    both_i = o.s4r * zi + o.s4i * zr + c.Omega4 * qi
    return min(z + q * c.Omega4, math.sqrt(both_r * both_r + both_i * both_i) + z * c.detuning * window)


@njit
def advance_phase(phase, angle):
    """Return (phase + angle) modulo 2 pi, in [0, 2 pi)."""
    turned = (phase + angle) % (2.0 * math.pi)
    return turned if turned < 2.0 * math.pi else 0.0
