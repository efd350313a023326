"""Energies of one segment of motion as closed forms, and the largest displacement in it.

Between events every quantity is a quadratic form in u and G, whose integral follows from their values at both ends;
nothing is sampled (docs/dynamics.md, "Integrals between events").
"""

from __future__ import annotations

import math

import numpy as np

from vines.dynamics._constants import Constants, Oscillator
from vines.dynamics._contact import BEYOND, SPEED, close_in
from vines.dynamics._flight import derivatives, fifth, forced_fifth, modulus, phasors, slow_growth, turn
from vines.dynamics._steps import only_root, step_ahead, step_back, taylor_root
from vines.kernels import by_type, fused_njit, linked_njit, loop_njit

__all__ = [
    "base_per_force",
    "energies_between",
    "frame_energies",
    "largest_displacement",
    "peak_between",
    "quadratic_forms",
    "segment_integrals",
    "stays_below",
]

FORCED_STEP = 1e-7
"""Smallest step past a zero of v1; a second zero within it would change |x1| by less than 1e-20."""

NODES = np.array([0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363])
WEIGHTS = np.array([0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763])
"""Gauss–Legendre of eight points: exact to rounding for the slow motion over a time up to 1/|i Omega - s|."""


@fused_njit
def _away_from_resonance(o, u0, g0, u1, g1, length):
    """Return the integrals of u conj(G) and |u|^2 from the free part and the steady response at both ends."""
    inverse = complex(o.er, o.ei)
    q0 = g0 * inverse
    q1 = g1 * inverse
    z0 = u0 - q0
    z1 = u1 - q1
    cross = (z0 * q0.conjugate() - z1 * q1.conjugate()) * inverse
    steady = q0.real * q0.real + q0.imag * q0.imag
    free = z0.real * z0.real + z0.imag * z0.imag
    rate = 2.0 * o.half
    remains = -math.expm1(-rate * length) / rate if rate > 0.0 else length
    straight = (g0.real * g0.real + g0.imag * g0.imag) * length
    ug = (straight - (u1 * g1.conjugate() - u0 * g0.conjugate())) * inverse
    return ug, free * remains + 2.0 * cross.real + steady * length


@linked_njit
def _near_resonance(o, Omega, u0, g0, length):
    """Return the same integrals by quadrature of u exp(-i Omega t), which hardly changes."""
    detuning = complex(o.dr, o.di)
    ug = complex(0.0, 0.0)
    square = 0.0
    done = 0.0
    while done < length:
        part = min(length - done, o.reach)
        a, b, d, e = turn(o, Omega, u0.real, u0.imag, g0.real, g0.imag, done)
        u = complex(a, b)
        g = complex(d, e)
        rate = g - detuning * u
        for k in range(8):
            t = 0.5 * part * (1.0 + (NODES[k // 2] if k % 2 else -NODES[k // 2]))
            weight = 0.5 * part * WEIGHTS[k // 2]
            re, im = slow_growth(o, t)
            y = u + rate * complex(re, im)
            ug += weight * y * g.conjugate()
            square += weight * (y.real * y.real + y.imag * y.imag)
        done += part
    return ug, square


@by_type(Constants)
@linked_njit
def segment_integrals(c, mode, x1, v1, v2, phase, length):
    """Return the integrals of x1^2, v1^2, v2^2, the base work and the damper loss over [0, length].

    The state is that just after the event with which the segment begins, `mode` 0 in flight and the wall when stuck.
    """
    o = c.stuck if mode != 0.0 else c.free
    start = phasors(o, c.Omega, x1, v1, phase)
    return energies_between(c, o, mode != 0.0, start, turn(o, c.Omega, *start, length), v2, length)


@fused_njit
def energies_between(c, o, stuck, start, end, v2, length):
    """Return the same from u and G at both ends."""
    x_square, v_square, work, loss = frame_energies(c, o, start, end, length)
    if stuck:
        return x_square, v_square, v_square, (1.0 + c.mu) * work, loss
    return x_square, v_square, v2 * v2 * length, work, loss


@fused_njit
def frame_energies(c, o, start, end, length):
    """Return the integrals of x1^2 and v1^2, work in flight and damper loss from u and G at both ends."""
    u0 = complex(start[0], start[1])
    g0 = complex(start[2], start[3])
    u1 = complex(end[0], end[1])
    g1 = complex(end[2], end[3])
    if o.reach == 0.0:
        ug, uu = _away_from_resonance(o, u0, g0, u1, g1, length)
    else:
        ug, uu = _near_resonance(o, c.Omega, u0, g0, length)
    c2 = complex(o.c2r, o.c2i)
    sum2 = 1.0 / (c2.real * c2.real + c2.imag * c2.imag)
    base = base_per_force(o, c.Omega, c.lam)
    return quadratic_forms(o.half, o.gamma, o.stiffness, c.Omega, c.lam, sum2, base, u0, g0, u1, g1, ug, uu, length)


@fused_njit
def base_per_force(o, Omega, lam):
    """Return the complex factor with which G gives the base's velocity, e' = Re[base G]."""
    return Omega / o.stiffness * complex(o.half, o.sum) / complex(lam * Omega, -1.0)


@fused_njit
def quadratic_forms(half, gamma, stiffness, Omega, lam, sum2, base, u0, g0, u1, g1, ug, uu, length):
    """Return the integrals of x1^2 and v1^2, work in flight and damper loss from those of u conj(G) and |u|^2.

    Without branches and divisions, so that lanes can share it; `sum2` is 1/|s + i Omega|^2.
    """
    gg = (g0.real * g0.real + g0.imag * g0.imag) * length
    s = complex(-half, gamma)
    s2 = s * s
    twice = complex(-2.0 * half, 2.0 * gamma)
    c2 = complex(-half, gamma + Omega)
    # Integrals of G^2, u G and u^2: their exponents are never small.
    rise = g1 * g1 - g0 * g0
    share = 0.5 / Omega
    g_g = complex(share * rise.imag, -share * rise.real)
    u_g = (u1 * g1 - u0 * g0 - g_g) * complex(sum2 * c2.real, -sum2 * c2.imag)
    share = 0.5 / stiffness
    u_u = (u1 * u1 - u0 * u0 - (u_g + u_g)) * complex(share * s.real, -share * s.imag)
    x_square = 0.5 * (u_u.real + uu)
    v_square = 0.5 * ((s2 * u_u + twice * u_g + g_g).real + stiffness * uu + (twice * ug).real + gg)
    work = (
        0.5 * (base * (s2 * u_g + c2 * g_g) + base.conjugate() * (s2 * ug + complex(c2.real * gg, c2.imag * gg))).real
    )
    other = complex(1.0 - base.real, -base.imag)
    square = (s2 * u_u + twice * other * u_g + other * other * g_g).real
    size = other.real * other.real + other.imag * other.imag
    loss = 0.5 * lam * (square + stiffness * uu + (twice * other.conjugate() * ug).real + size * gg)
    return x_square, v_square, work, loss


@by_type(Oscillator)
@fused_njit
def stays_below(o, Omega, now, end, left, best):
    """Say whether it is certain that |x1| does not exceed `best` between two motions, a time `left` apart."""
    ur, ui, gr, gi = now
    # u exp(-i Omega t) leaves the chord between its ends by less than its second derivative allows.
    rate = modulus(gr - (o.dr * ur - o.di * ui), gi - (o.dr * ui + o.di * ur))
    here = modulus(ur, ui)
    highest = max(here, modulus(end[0], end[1])) + 0.125 * modulus(o.dr, o.di) * rate * left * left
    if min(highest, here + modulus(gr, gi) * left) <= best:
        return True
    if o.reach != 0.0:
        return False
    qr, qi = gr * o.er - gi * o.ei, gr * o.ei + gi * o.er
    return modulus(ur - qr, ui - qi) + modulus(qr, qi) <= best


@loop_njit
def largest_displacement(c, mode, x1, v1, phase, start, length, best):
    """Return (largest |x1| on [start, length], its time), or `best` and a negative time if none exceeds it.

    The times are those since the event at which x1, v1, phase are given. All zeros of v1 are found by certified steps.
    """
    o = c.stuck if mode != 0.0 else c.free
    motion = phasors(o, c.Omega, x1, v1, phase)
    return peak_between(c, o, motion, turn(o, c.Omega, *motion, length), start, length, best)


@fused_njit
def peak_between(c, o, motion, end, start, length, best):
    """Return the same from the motion at the start of the segment and at its end, between which no force jumps."""
    when = -1.0
    last, _, _, _, _ = derivatives(o, c.Omega, *end)
    if abs(last) > best:
        best = abs(last)
        when = length
    tau = start
    window = c.window
    for _ in range(1_000_000):
        now = motion
        if tau > 0.0:
            now = turn(o, c.Omega, *motion, tau)
        x, v, a, j, k = derivatives(o, c.Omega, *now)
        if abs(x) > best:
            best = abs(x)
            when = tau
        if stays_below(o, c.Omega, now, end, length - tau, best):
            return best, when
        bound = modulus(*fifth(o, *now)) + forced_fifth(c, *motion) * window
        side = 1.0 if v > 0.0 or (v == 0.0 and a < 0.0) else -1.0
        gap = abs(v)
        slope = -side * a
        if slope > 0.0:
            h, _ = taylor_root(gap, slope, -side * j, -side * k, 0.0, 0.0, 0.0)
            reach = BEYOND * h
            if reach <= window and only_root(gap, slope, -side * j, -side * k, -bound, 0.0, reach):
                tau, x, _, a, j, k = close_in(c, o, SPEED, 1.0, motion, 0.0, 0.0, int(side), tau, h, reach)
                if tau > length:
                    return best, when
                if abs(x) > best:
                    best = abs(x)
                    when = tau
                # From here v1 goes to the other sign; the bound held for twice the window, but for the forcing's part.
                side = 1.0 if a > 0.0 else -1.0
                bound += forced_fifth(c, *motion) * window
                h = step_back(0.0, abs(a), -side * j, -side * k, bound, 0.0, window)
                if h < 0.25 * window:
                    h = max(h, step_back(0.0, abs(a), -side * j, -side * k, bound, 0.0, 2.0 * h))
                tau += max(h, FORCED_STEP)
                if tau >= length:
                    return best, when
                continue
            span = min(window, 1.5 * gap / slope)
            h = step_ahead(gap, slope, -side * j, -side * k, bound, 0.0, span)
        else:
            h = step_back(gap, -slope, -side * j, -side * k, bound, 0.0, window)
            if h < 0.25 * window:
                h = max(h, step_back(gap, -slope, -side * j, -side * k, bound, 0.0, 2.0 * h))
        tau += max(h, FORCED_STEP)
        if tau >= length:
            return best, when
    return best, when
