"""Energies of one segment of motion as closed forms, and the largest displacement in it.

Between events every quantity is a product of two sums Re[a exp(s t)] + Re[b exp(i Omega t)], whose integral is a sum of
complex exponentials; nothing is sampled (docs/dynamics.md, "Integrals between events").
"""

from __future__ import annotations

import math

from vines.dynamics._flight import derivatives, phasors, turn
from vines.dynamics._jit import njit
from vines.dynamics._sincos import sincos
from vines.dynamics._steps import leaving_step, quartic_root, safe_step

__all__ = ["largest_displacement", "segment_integrals"]

FORCED_STEP = 1e-7
"""Smallest step past a zero of v1; a second zero within it would change |x1| by less than 1e-20."""


@njit
def _exponential(rate, length):
    """Return the integral of exp(rate t) over [0, length], accurate for every complex rate."""
    if rate == 0.0:
        return complex(length, 0.0)
    re = rate.real * length
    im = rate.imag * length
    sine, cosine = sincos(im)
    half_sine, _ = sincos(0.5 * im)
    grown = math.expm1(re)
    return complex(grown * cosine - 2.0 * half_sine * half_sine, (grown + 1.0) * sine) / rate


@njit
def _product(a, b, d, f, e2, e1, plus, minus, turning, length):
    """Return the integral of (Re[a e^{st}] + Re[b e^{iOt}]) (Re[d e^{st}] + Re[f e^{iOt}])."""
    total = a * d * e2 + a * d.conjugate() * e1
    total += (a * f + d * b) * plus + (a * f.conjugate() + d * b.conjugate()) * minus
    total += b * f * turning + b * f.conjugate() * length
    return 0.5 * total.real


@njit
def segment_integrals(c, mode, x1, v1, v2, phase, length):
    """Return the integrals of x1^2, v1^2, v2^2, the base work and the damper loss over [0, length].

    The state is that just after the event with which the segment begins, `mode` 0 in flight and the wall when stuck.
    """
    o = c.stuck if mode != 0.0 else c.free
    zr, zi, qr, qi = phasors(o, c.Omega, x1, v1, phase)
    s = complex(-o.half, o.gamma)
    i_omega = complex(0.0, c.Omega)
    e2 = _exponential(2.0 * s, length)
    e1 = _exponential(complex(-2.0 * o.half, 0.0), length)
    plus = _exponential(s + i_omega, length)
    minus = _exponential(s - i_omega, length)
    turning = _exponential(2.0 * i_omega, length)
    z = complex(zr, zi)
    q = complex(qr, qi)
    sine, cosine = sincos(phase)
    base = c.A * c.Omega * complex(cosine, sine)
    zv = s * z
    qv = i_omega * q
    x_square = _product(z, q, z, q, e2, e1, plus, minus, turning, length)
    v_square = _product(zv, qv, zv, qv, e2, e1, plus, minus, turning, length)
    none = complex(0.0, 0.0)
    work = _product(s * zv, i_omega * qv, none, base, e2, e1, plus, minus, turning, length)
    relative = qv - base
    loss = c.lam * _product(zv, relative, zv, relative, e2, e1, plus, minus, turning, length)
    if mode != 0.0:
        return x_square, v_square, v_square, (1.0 + c.mu) * work, loss
    return x_square, v_square, v2 * v2 * length, work, loss


@njit
def largest_displacement(c, mode, x1, v1, phase, start, length, best):
    """Return (largest |x1| on [start, length], its time), or `best` and a negative time if none exceeds it.

    The times are those since the event at which x1, v1, phase are given. All zeros of v1 are found by certified steps.
    """
    o = c.stuck if mode != 0.0 else c.free
    zr, zi, qr, qi = phasors(o, c.Omega, x1, v1, phase)
    when = -1.0
    zrt, zit, qrt, qit = turn(o, c.Omega, zr, zi, qr, qi, length)
    if abs(zrt + qrt) > best:
        best = abs(zrt + qrt)
        when = length
    tau = start
    window = c.window
    for _ in range(1_000_000):
        zrt, zit, qrt, qit = turn(o, c.Omega, zr, zi, qr, qi, tau)
        x, v, a, j, _ = derivatives(o, c.Omega, zrt, zit, qrt, qit)
        if abs(x) > best:
            best = abs(x)
            when = tau
        z_size = math.sqrt(zrt * zrt + zit * zit)
        q_size = math.sqrt(qrt * qrt + qit * qit)
        if z_size + q_size <= best:
            return best, when
        bound = z_size * o.size**4 + q_size * c.Omega4
        side = 1.0 if v > 0.0 or (v == 0.0 and a < 0.0) else -1.0
        gap = abs(v)
        slope = -side * a
        if slope > 0.0 and 2.0 * gap <= slope * window:
            reach = 2.0 * gap / slope
            if slope * slope > 2.0 * (abs(j) + bound * reach) * gap:
                tau, x, slope, j = _turning_point(o, c.Omega, zr, zi, qr, qi, side, tau, reach)
                if tau > length:
                    return best, when
                if abs(x) > best:
                    best = abs(x)
                    when = tau
                tau += max(leaving_step(slope, side * j, bound, 0.0, window), FORCED_STEP)
                if tau >= length:
                    return best, when
                continue
        h = safe_step(gap, slope, -side * j + bound * window / 3.0, window)
        tau += max(h, FORCED_STEP)
        if tau >= length:
            return best, when
    return best, when


@njit
def _turning_point(o, Omega, zr, zi, qr, qi, side, tau, reach):
    """Return (tau, x1, slope of |v1| towards 0, x1''') at the only zero of v1 in [tau, tau + reach]."""
    low = tau
    high = tau + reach
    x = slope = j = 0.0
    for _ in range(80):
        zrt, zit, qrt, qit = turn(o, Omega, zr, zi, qr, qi, tau)
        x, v, a, j, k = derivatives(o, Omega, zrt, zit, qrt, qit)
        if side * v > 0.0:
            low = max(low, tau)
        else:
            high = min(high, tau)
        slope = -side * a
        step = quartic_root(side * v, slope, -side * j, -side * k, 0.0) if slope > 0.0 else math.nan
        if abs(step) <= 1e-5:
            x += step * (v + step * (0.5 * a + step * j / 6.0))
            return tau + step, x, max(slope, 0.0), j
        if not low <= tau + step <= high:
            step = 0.5 * (low + high) - tau
            if abs(step) <= 1e-12 * (1.0 + high):
                break
        tau += step
    return tau, x, max(slope, 0.0), j
