"""Energies with scatter: as `vines.dynamics._integrals`, with both harmonics and the work of the held force.

All are quadratic forms in y = (u, G1, G2), so the integrals of y_a y_b and of y_a conj(y_b) are enough
(docs/dynamics.md, "Scatter").
"""

from __future__ import annotations

import math

import numpy as np

from vines.dynamics import _totals as entry
from vines.dynamics._flight import flight, modulus, turn
from vines.dynamics._integrals import NODES, WEIGHTS, peak_between, stays_below
from vines.dynamics._scatter_constants import ScatterConstants, ScatterOscillator
from vines.dynamics._scatter_motion import LEFT, end_of, redraw
from vines.dynamics._totals import add_segment, base_at, event_loss, event_work, stored_energy, window_totals
from vines.kernels import fused_njit, linked_njit, njit

__all__: list[str] = []


@base_at.register(ScatterConstants)
@njit
def _base_at(c, phase):
    return c.A * np.sin(phase) + c.second * np.sin(2.0 * phase + c.second_phase)


for _name in (event_loss, event_work, stored_energy, window_totals):
    _name.register(ScatterConstants)(_name.first)


@stays_below.register(ScatterOscillator)
@fused_njit
def _stays_below(o, Omega, now, end, left, best):
    ur, ui, pr, pi, qr, qi, held, _, _ = now
    # x1 leaves the chord between its ends by less than its second derivative allows.
    re = (o.first.s2r * ur - o.first.s2i * ui) + (o.first.c2r * pr - o.first.c2i * pi)
    im = (o.first.s2r * ui + o.first.s2i * ur) + (o.first.c2r * pi + o.first.c2i * pr)
    re += o.second.c2r * qr - o.second.c2i * qi
    im += o.second.c2r * qi + o.second.c2i * qr
    force = abs(pr) + abs(pi) + 4.0 * (abs(qr) + abs(qi))
    bend = abs(re) + abs(im) + left * Omega * Omega * force
    if max(abs(held + ur), abs(end[6] + end[0])) + 0.125 * left * left * bend <= best:
        return True
    if o.reach != 0.0:
        return False
    ar, ai = pr * o.first.er - pi * o.first.ei, pr * o.first.ei + pi * o.first.er
    br, bi = qr * o.second.er - qi * o.second.ei, qr * o.second.ei + qi * o.second.er
    return abs(held) + modulus(ur - ar - br, ui - ai - bi) + modulus(ar, ai) + modulus(br, bi) <= best


@fused_njit
def _remains(rate, length):
    """Return the integral of exp(-rate t) over a time."""
    y = rate * length
    if y > 0.03125:
        return -math.expm1(-y) / rate
    tail = 1 / 120 - y * (1 / 720 - y * (1 / 5040))
    return length * (1.0 - y * (1 / 2 - y * (1 / 6 - y * (1 / 24 - y * tail))))


@linked_njit
def _by_quadrature(o, Omega, motion, length, longest):
    """Return the integrals of u conj(G1), u conj(G2) and |u|^2 near a resonance, by Gauss–Legendre in short parts."""
    one, two, square = complex(0.0, 0.0), complex(0.0, 0.0), 0.0
    parts = math.ceil(length / longest)
    for i in range(parts):
        for k in range(8):
            t = (length / parts) * (i + 0.5 * (1.0 + (NODES[k // 2] if k % 2 else -NODES[k // 2])))
            weight = 0.5 * (length / parts) * WEIGHTS[k // 2]
            ur, ui, pr, pi, qr, qi, _, _, _ = turn(o, Omega, *motion, t)
            one += weight * complex(ur, ui) * complex(pr, -pi)
            two += weight * complex(ur, ui) * complex(qr, -qi)
            square += weight * (ur * ur + ui * ui)
    return one, two, square


@fused_njit
def _size(a):
    """Return |a|^2."""
    return a.real * a.real + a.imag * a.imag


@fused_njit
def _scaled(share, a):
    """Return a real multiple, without a product of two complex numbers."""
    return complex(share * a.real, share * a.imag)


@fused_njit
def _turned(share, a):
    """Return -i share a."""
    return complex(share * a.imag, -share * a.real)


@fused_njit
def _energies(c, o, stuck, start, end, v2, length):
    """Return the integrals of x1^2, v1^2, v2^2, the work of base and held force, and the damper loss over a piece."""
    u0, p0, q0 = complex(start[0], start[1]), complex(start[2], start[3]), complex(start[4], start[5])
    u1, p1, q1 = complex(end[0], end[1]), complex(end[2], end[3]), complex(end[4], end[5])
    held = start[6]
    s, s2 = complex(-o.first.half, o.first.gamma), complex(o.first.s2r, o.first.s2i)
    c1, c2 = complex(o.first.c2r, o.first.c2i), complex(o.second.c2r, o.second.c2i)
    e1, e2 = complex(o.first.er, o.first.ei), complex(o.second.er, o.second.ei)
    share = 1.0 / c.Omega
    mass = 1.0 / o.first.stiffness

    # Integrals of G1, G2 and of products, whose exponents are never small.
    p, q = _turned(share, p1 - p0), _turned(0.5 * share, q1 - q0)
    pp, qq = _turned(0.5 * share, p1 * p1 - p0 * p0), _turned(0.25 * share, q1 * q1 - q0 * q0)
    pq = _turned((1.0 / 3.0) * share, p1 * q1 - p0 * q0)
    up = (u1 * p1 - u0 * p0 - pp - pq) * _scaled(1.0 / _size(c1), c1.conjugate())
    uq = (u1 * q1 - u0 * q0 - pq - qq) * _scaled(1.0 / _size(c2), c2.conjugate())
    both = up + uq
    uu = (u1 * u1 - u0 * u0 - (both + both)) * _scaled(0.5 * mass, s.conjugate())
    rest = u1 - u0 - p - q
    mean = mass * (s.real * rest.real + s.imag * rest.imag)

    # Integrals with a conjugate: u conj(G1), u conj(G2), |u|^2, G1 conj(G2).
    p_p, q_q = _size(p0) * length, _size(q0) * length
    p_q = _turned(-share, p1 * q1.conjugate() - p0 * q0.conjugate())
    if o.reach == 0.0:
        u_p = (p_p + p_q.conjugate() - (u1 * p1.conjugate() - u0 * p0.conjugate())) * e1
        u_q = (q_q + p_q - (u1 * q1.conjugate() - u0 * q0.conjugate())) * e2
        a0, a1, b0, b1 = e1 * p0, e1 * p1, e2 * q0, e2 * q1
        z0, z1 = u0 - a0 - b0, u1 - a1 - b1
        cross = (z0 * a0.conjugate() - z1 * a1.conjugate()) * e1 + (z0 * b0.conjugate() - z1 * b1.conjugate()) * e2
        steady = _size(e1) * p_p + _size(e2) * q_q
        u_u = _size(z0) * _remains(2.0 * o.first.half, length) + steady
        u_u += 2.0 * (cross + e1 * e2.conjugate() * p_q).real
    else:
        u_p, u_q, u_u = _by_quadrature(o, c.Omega, start, length, 0.5 * c.window)

    x_square = held * (held * length + 2.0 * mean) + 0.5 * (uu.real + u_u)
    s2_uu = (s2 * uu).real + o.first.stiffness * u_u
    mixed = (s * (both + u_p + u_q)).real + pq.real + p_q.real
    v_square = 0.5 * (s2_uu + pp.real + qq.real + p_p + q_q) + mixed
    f, g = complex(o.br, o.bi), complex(o.second.br, o.second.bi)
    work = f * (s2 * up + c1 * pp + c2 * pq) + g * (s2 * uq + c1 * pq + c2 * qq)
    work += f.conjugate() * (s2 * u_p + _scaled(p_p, c1) + c2 * p_q.conjugate())
    work += g.conjugate() * (s2 * u_q + c1 * p_q + _scaled(q_q, c2))
    # What the held force does to the oscillator, less what the base does against it.
    moved = end[0] - start[0] - (f * p + g * q).real
    f, g = complex(1.0 - f.real, -f.imag), complex(1.0 - g.real, -g.imag)
    fg = f * g
    mixed = (s * (f * up + g * uq + f.conjugate() * u_p + g.conjugate() * u_q) + fg * pq).real
    mixed += (f * g.conjugate() * p_q).real
    loss = 0.5 * (s2_uu + (f * f * pp + g * g * qq).real + _size(f) * p_p + _size(g) * q_q) + mixed
    return (
        x_square,
        v_square,
        v_square if stuck else v2 * v2 * length,
        0.5 * (1.0 + c.mu if stuck else 1.0) * work.real + held * moved,
        c.lam * loss,
    )


@add_segment.register(ScatterConstants)
@fused_njit
def _add_segment(c, out, mode, begins, x1, v1, v2, phase, length):
    o = c.stuck if mode != 0.0 else c.free
    motion = flight(c, o, x1, v1, phase, begins)
    gone = 0.0
    while True:
        lasts = min(length - gone, motion[LEFT])
        end = end_of(c, o, motion, lasts)
        xx, vv, ball, work, loss = _energies(c, o, mode != 0.0, motion, end, v2, lasts)
        out[entry.DURATION] += lasts
        out[entry.X1_SQUARE] += xx
        out[entry.V1_SQUARE] += vv
        out[entry.V2_SQUARE] += ball
        out[entry.BASE_WORK] += work
        out[entry.DAMPER_LOSS] += loss
        best, when = peak_between(c, o, motion, end, 0.0, lasts, out[entry.MAX_ABS_X1])
        if when >= 0.0:
            out[entry.MAX_ABS_X1] = best
            out[entry.T_MAX_ABS_X1] = begins + gone + when
        if length - gone <= lasts:
            return
        gone += lasts
        motion = redraw(c, o, end)
