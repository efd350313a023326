"""Closed-form motion between events: the oscillator's complex displacement and force, and what follows from them.

x = Re u with u' = s u + G and G turning with the forcing. Neither u nor G grows at resonance, where the usual two
phasors, free motion and steady response, are large and cancel (docs/dynamics.md, "Motion between events").
"""

from __future__ import annotations

import math

from vines.dynamics._constants import Constants, Oscillator
from vines.dynamics._sincos import sincos
from vines.kernels import by_type, fused_njit, njit

__all__ = [
    "advance_phase",
    "ball_flown",
    "decay",
    "derivatives",
    "drift",
    "fifth",
    "flight",
    "flown",
    "forced_fifth",
    "fourth_bound",
    "free_ball",
    "launched",
    "modulus",
    "phase_after",
    "phasors",
    "pull",
    "rate_alone",
    "relative",
    "ringing",
    "sixth",
    "slow_growth",
    "speed_terms",
    "terms",
    "turn",
]

TWO_PI = 2.0 * math.pi


@fused_njit
def phasors(o, Omega, x, v, phase):
    """Return u, G as four reals from x, v and the phase of the forcing."""
    sine, cosine = sincos(phase)
    gr = o.gr * cosine - o.gi * sine
    gi = o.gr * sine + o.gi * cosine
    return x, (gr - o.half * x - v) * o.inverse, gr, gi


@fused_njit
def decay(x):
    """Return exp(-x) for x >= 0 (or any x, more slowly)."""
    if abs(x) > 0.03125:
        return math.exp(-x)
    tail = 1 / 24 - x * (1 / 120 - x * (1 / 720 - x * (1 / 5040 - x * (1 / 40320))))
    return 1.0 - x * (1.0 - x * (1 / 2 - x * (1 / 6 - x * tail)))


@by_type(Oscillator)
@fused_njit
def turn(o, Omega, ur, ui, gr, gi, tau):
    """Return u and G at time tau, as four reals.

    u(tau) = u e^{s tau} + G (e^{i Omega tau} - e^{s tau})/(i Omega - s). Near resonance both exponentials are written
    as their geometric mean times e^{+-y}, y = (i Omega - s) tau/2, and the quotient as the mean times tau sinh(y)/y.
    """
    if abs(tau) <= o.reach:
        size = decay(0.5 * o.half * tau)
        sine, cosine = sincos(0.5 * o.sum * tau)
        mr = size * cosine
        mi = size * sine
        yr = 0.5 * o.dr * tau
        yi = 0.5 * o.di * tau
        pr = yr * yr - yi * yi
        pi = 2.0 * yr * yi
        hr, hi, cr, ci = _slow(pr, pi)
        tr = yr * hr - yi * hi
        ti = yr * hi + yi * hr
        # e^{s tau} = mean (cosh y - sinh y), and so on.
        er, ei = _times(mr, mi, cr - tr, ci - ti)
        fr, fi = _times(mr, mi, cr + tr, ci + ti)
        br, bi = _times(mr, mi, hr * tau, hi * tau)
    else:
        size = decay(o.half * tau)
        ei, er = sincos(o.gamma * tau)
        er *= size
        ei *= size
        fi, fr = sincos(Omega * tau)
        br, bi = _times(fr - er, fi - ei, o.er, o.ei)
    return (
        er * ur - ei * ui + (br * gr - bi * gi),
        er * ui + ei * ur + (br * gi + bi * gr),
        fr * gr - fi * gi,
        fr * gi + fi * gr,
    )


@fused_njit
def _times(ar, ai, br, bi):
    return ar * br - ai * bi, ar * bi + ai * br


@fused_njit
def _nest(hr, hi, pr, pi, scale):
    """Return 1 + scale p h."""
    return 1.0 + scale * (hr * pr - hi * pi), scale * (hr * pi + hi * pr)


@fused_njit
def _slow(pr, pi):
    """Return sinh(y)/y and cosh(y), as four reals, for p = y^2 with |y| <= 1/2: Taylor, to rounding."""
    hr, hi = _nest(1.0 + pr * (1 / 210), pi * (1 / 210), pr, pi, 1 / 156)
    hr, hi = _nest(hr, hi, pr, pi, 1 / 110)
    hr, hi = _nest(hr, hi, pr, pi, 1 / 72)
    hr, hi = _nest(hr, hi, pr, pi, 1 / 42)
    hr, hi = _nest(hr, hi, pr, pi, 1 / 20)
    hr, hi = _nest(hr, hi, pr, pi, 1 / 6)
    cr, ci = _nest(1.0 + pr * (1 / 182), pi * (1 / 182), pr, pi, 1 / 132)
    cr, ci = _nest(cr, ci, pr, pi, 1 / 90)
    cr, ci = _nest(cr, ci, pr, pi, 1 / 56)
    cr, ci = _nest(cr, ci, pr, pi, 1 / 30)
    cr, ci = _nest(cr, ci, pr, pi, 1 / 12)
    cr, ci = _nest(cr, ci, pr, pi, 1 / 2)
    return hr, hi, cr, ci


@fused_njit
def slow_growth(o, tau):
    """Return the integral of exp(-(i Omega - s) t) over [0, tau], tau up to the oscillator's reach, as two reals."""
    yr = 0.5 * o.dr * tau
    yi = 0.5 * o.di * tau
    hr, hi, cr, ci = _slow(yr * yr - yi * yi, 2.0 * yr * yi)
    # exp(-y) sinh(y)/y, with exp(-y) = cosh y - sinh y.
    re, im = _times(hr, hi, cr - (yr * hr - yi * hi), ci - (yr * hi + yi * hr))
    return re * tau, im * tau


@by_type(Oscillator)
@fused_njit
def derivatives(o, Omega, ur, ui, gr, gi):
    """Return x and its first four derivatives where the oscillator is at u, G."""
    return (
        ur,
        gr - o.half * ur - o.gamma * ui,
        (o.s2r * ur - o.s2i * ui) + (o.c2r * gr - o.c2i * gi),
        (o.s3r * ur - o.s3i * ui) + (o.c3r * gr - o.c3i * gi),
        (o.s4r * ur - o.s4i * ui) + (o.c4r * gr - o.c4i * gi),
    )


@by_type(Oscillator)
@fused_njit
def fifth(o, ur, ui, gr, gi):
    """Return the fifth derivative of u, as two reals."""
    return (
        (o.s5r * ur - o.s5i * ui) + (o.c5r * gr - o.c5i * gi),
        (o.s5r * ui + o.s5i * ur) + (o.c5r * gi + o.c5i * gr),
    )


@by_type(Oscillator)
@fused_njit
def sixth(o, ur, ui, gr, gi):
    """Return the sixth derivative of x."""
    return (o.s6r * ur - o.s6i * ui) + (o.c6r * gr - o.c6i * gi)


@by_type(Constants)
@fused_njit
def flight(c, o, x, v, phase, t):
    """Return the motion that begins with x, v and a phase of the forcing at time t: what `turn` carries on, u and G."""
    return phasors(o, c.Omega, x, v, phase)


@by_type(Constants)
@fused_njit
def flown(c, o, motion, tau):
    """Return the motion a time tau after its begin, however long that is."""
    return turn(o, c.Omega, *motion, tau)


@by_type(Constants)
@fused_njit
def forced_fifth(c, ur, ui, gr, gi):
    """Return by how much in a unit of time the fifth derivative of u may come to exceed what it is at u, G."""
    return modulus(gr, gi) * c.Omega5


@by_type(Oscillator)
@fused_njit
def terms(o, ur, ui, gr, gi):
    """Return the size of the terms of which a gap is the sum, the half-width of the cavity among them."""
    return 1.0 + abs(ur) + abs(ui) + abs(gr) + abs(gi)


@by_type(Constants)
@fused_njit
def free_ball(c, v2, tau):
    """Return how far a free ball comes in a time tau that begins with the velocity v2, and its velocity then."""
    return v2 * tau, v2


@by_type(Constants)
@fused_njit
def launched(c, o, x, v, v2, phase, t):
    """Return what `flight` does where a ball leaves with the velocity v2, which a frame may feel as the ball flies."""
    return flight(c, o, x, v, phase, t)


@by_type(Constants)
@fused_njit
def ball_flown(c, motion, v2, tau):
    """Return what `free_ball` does, of a ball that left with the motion: the frame may move it as it flies."""
    return free_ball(c, v2, tau)


@by_type(Constants)
@fused_njit
def relative(c):
    """Return the constants in whose frame a ball flies as `free_ball` says: these, where the frame does not move it."""
    return c


@by_type(Constants)
@fused_njit
def pull(c, a):
    """Return the acceleration of a wall that moves with x1'' = a, against a free ball: w''."""
    return a


@fused_njit
def modulus(re, im):
    """Return |re + i im|."""
    return math.sqrt(re * re + im * im)


@by_type(Constants)
@njit
def speed_terms(c, ur, ui, gr, gi):
    """Return the size of the terms of which the velocity of a wall is the sum."""
    return abs(ur) + abs(ui) + (1.0 + c.Omega) * (abs(gr) + abs(gi))


@by_type(Constants)
@fused_njit
def fourth_bound(c, ur, ui, gr, gi, window):
    """Return a bound of the oscillator's fourth derivative over a window of free flight (docs/dynamics.md)."""
    o = c.free
    re = (o.s4r * ur - o.s4i * ui) + (o.c4r * gr - o.c4i * gi)
    im = (o.s4r * ui + o.s4i * ur) + (o.c4r * gi + o.c4i * gr)
    return math.sqrt(re * re + im * im) + math.sqrt(gr * gr + gi * gi) * c.Omega4 * window


@by_type(Constants)
@njit
def ringing(c, x1, v1, v2, phase):
    """Return how far the oscillator is from its steady motion under the forcing alone."""
    cosine, sine = math.cos(phase), math.sin(phase)
    q_re = c.free.qr * cosine - c.free.qi * sine
    q_im = c.free.qr * sine + c.free.qi * cosine
    return math.hypot(x1 - q_re, v1 + c.Omega * q_im)


@by_type(Constants)
@njit
def drift(c, v2):
    """Return the speed with which a ball of velocity v2 that is never hit comes to a wall in the end."""
    return abs(v2)


@by_type(Constants)
@njit
def rate_alone(c, d, k):
    """Return the k-th of the d exponents of a motion in which no ball is ever hit, in descending order.

    The balls keep what they are given, in position and in velocity; the oscillator, if it is one, does not.
    """
    return 0.0 if k < max(d - 2, 2) else -0.5 * c.lam


@fused_njit
def advance_phase(phase, angle):
    """Return (phase + angle) modulo 2 pi, in [0, 2 pi)."""
    turned = phase + angle
    turned -= TWO_PI * math.floor(turned * (1.0 / TWO_PI))
    # Rounding may leave it a little outside.
    if turned < 0.0:
        turned += TWO_PI
    return turned if turned < TWO_PI else 0.0


@by_type(Constants)
@fused_njit
def phase_after(c, phase, angle, before, after):
    """Return the phase of the forcing at a time, from that at a time before and the angle that it turns by since."""
    return advance_phase(phase, angle)
