"""Energies with scatter: as `vines.dynamics._integrals`, with both harmonics and the work of the held force.

All are quadratic forms in y = (u, G1, G2), so the integrals of y_a y_b and of y_a conj(y_b) are enough
(docs/dynamics.md, "Scatter").
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from vines.dynamics import _totals as entry
from vines.dynamics._flight import derivatives, flight, modulus, slow_growth, turn
from vines.dynamics._integrals import NODES, WEIGHTS, energies_between, peak_between, stays_below
from vines.dynamics._scatter_constants import (
    AHEAD,
    FIRST,
    FORMS,
    JUMPS,
    NUMBERS,
    PIECES,
    SQUARES,
    SUMS,
    ScatterConstants,
    ScatterOscillator,
)
from vines.dynamics._scatter_motion import HELD, INDEX, LEFT, end_of, piece_at, redraw, sagging, under
from vines.dynamics._sincos import sincos
from vines.dynamics._totals import (
    add_segment,
    base_at,
    event_loss,
    event_work,
    segment_state,
    stored_energy,
    window_totals,
)
from vines.kernels import (
    cold_njit,
    doubles_at,
    fused_njit,
    linked_njit,
    loop_njit,
    new_vector,
    njit,
    zero_vector,
)

__all__ = ["fill_forms"]


@base_at.register(ScatterConstants)
@njit
def _base_at(c, phase):
    return c.A * np.sin(phase) + c.second * np.sin(2.0 * phase + c.second_phase)


for _name in (event_loss, event_work, segment_state, stored_energy, window_totals):
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
    ar, ai = pr * o.first.er - pi * o.first.ei, pr * o.first.ei + pi * o.first.er
    br, bi = qr * o.second.er - qi * o.second.ei, qr * o.second.ei + qi * o.second.er
    if o.first.reach == 0.0 and o.second.reach == 0.0:
        return abs(held) + modulus(ur - ar - br, ui - ai - bi) + modulus(ar, ai) + modulus(br, bi) <= best
    if o.second.reach == 0.0:
        highest = _chord(o.first, (ur - br, ui - bi, pr, pi), _less(o.second, end[0], end[1], end[4], end[5]), left)
        return abs(held) + modulus(br, bi) + highest <= best
    if o.first.reach == 0.0:
        highest = _chord(o.second, (ur - ar, ui - ai, qr, qi), _less(o.first, end[0], end[1], end[2], end[3]), left)
        return abs(held) + modulus(ar, ai) + highest <= best
    return False


@fused_njit
def _less(h, ur, ui, gr, gi):
    """Return u less the steady response to a harmonic."""
    return ur - (gr * h.er - gi * h.ei), ui - (gr * h.ei + gi * h.er)


@fused_njit
def _chord(h, start, end, left):
    """Return a bound of |u| between two motions under a harmonic that turns nearly as u, as without scatter."""
    ur, ui, gr, gi = start
    rate = modulus(gr - (h.dr * ur - h.di * ui), gi - (h.dr * ui + h.di * ur))
    return max(modulus(ur, ui), modulus(end[0], end[1])) + 0.125 * modulus(h.dr, h.di) * rate * left * left


@fused_njit
def _remains(rate, length):
    """Return the integral of exp(-rate t) over a time."""
    y = rate * length
    if y > 0.03125:
        return -math.expm1(-y) / rate
    tail = 1 / 120 - y * (1 / 720 - y * (1 / 5040))
    return length * (1.0 - y * (1 / 2 - y * (1 / 6 - y * (1 / 24 - y * tail))))


class Slow(NamedTuple):
    """The detuning i Omega - s of a harmonic near resonance, the time up to which it is small, and its frequency."""

    dr: float
    di: float
    reach: float
    Omega: float


@linked_njit
def _nearly_steady(h, u, g, length):
    """Return the integrals of u conj(G) and |u|^2 where u' = s u + G and u turns nearly as G.

    By quadrature of u exp(-i Omega t), which hardly changes, as without scatter.
    """
    mixed, square, done = complex(0.0, 0.0), 0.0, 0.0
    while True:
        part = min(length - done, h.reach)
        rate = g - complex(h.dr, h.di) * u
        for k in range(8):
            t = 0.5 * part * (1.0 + (NODES[k // 2] if k % 2 else -NODES[k // 2]))
            weight = 0.5 * part * WEIGHTS[k // 2]
            re, im = slow_growth(h, t)
            y = u + rate * complex(re, im)
            mixed += weight * y * g.conjugate()
            square += weight * (y.real * y.real + y.imag * y.imag)
        done += part
        if not done < length:
            return mixed, square
        re, im = slow_growth(h, part)
        sine, cosine = sincos(h.Omega * part)
        u, g = (u + rate * complex(re, im)) * complex(cosine, sine), g * complex(cosine, sine)


@linked_njit
def _by_quadrature(o, Omega, motion, length, longest):
    """Return the integrals of u conj(G1), u conj(G2) and |u|^2 by Gauss–Legendre in short parts, whatever is large."""
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
def _of_one_harmonic(c, o, stuck, start, end, v2, length):
    """Return the same without a second harmonic: of x1 - held as without scatter, and what the held force adds."""
    ur, ui, pr, pi, _, _, held, _, _ = start
    u, v, w, z, _, _, _, _, _ = end
    x_square, v_square, ball, work, loss = energies_between(
        c, o.first, stuck, (ur, ui, pr, pi), (u, v, w, z), v2, length
    )
    # The integral of G1, and from it those of u and of the base's velocity.
    p = _turned(1.0 / c.Omega, complex(w - pr, z - pi))
    mean = (-o.first.half * (u - ur - p.real) + o.first.gamma * (v - ui - p.imag)) / o.first.stiffness
    moved = u - ur - (o.br * p.real - o.bi * p.imag)
    return x_square + held * (held * length + 2.0 * mean), v_square, ball, work + held * moved, loss


@fused_njit
def _energies(c, o, stuck, start, end, v2, length):
    """Return the integrals of x1^2, v1^2, v2^2, the work of base and held force, and the damper loss over a piece."""
    if c.second == 0.0:
        return _of_one_harmonic(c, o, stuck, start, end, v2, length)
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
    if o.first.reach == 0.0 and o.second.reach == 0.0:
        u_p = (p_p + p_q.conjugate() - (u1 * p1.conjugate() - u0 * p0.conjugate())) * e1
        u_q = (q_q + p_q - (u1 * q1.conjugate() - u0 * q0.conjugate())) * e2
        a0, a1, b0, b1 = e1 * p0, e1 * p1, e2 * q0, e2 * q1
        z0, z1 = u0 - a0 - b0, u1 - a1 - b1
        cross = (z0 * a0.conjugate() - z1 * a1.conjugate()) * e1 + (z0 * b0.conjugate() - z1 * b1.conjugate()) * e2
        steady = _size(e1) * p_p + _size(e2) * q_q
        u_u = _size(z0) * _remains(2.0 * o.first.half, length) + steady
        u_u += 2.0 * (cross + e1 * e2.conjugate() * p_q).real
    elif o.second.reach == 0.0:
        # Less the steady response to the second harmonic, u turns nearly as the first does.
        slow = Slow(o.first.dr, o.first.di, o.first.reach, c.Omega)
        y0, y1 = u0 - e2 * q0, u1 - e2 * q1
        y_p, y_y = _nearly_steady(slow, y0, p0, length)
        y_q = (p_q - (y1 * q1.conjugate() - y0 * q0.conjugate())) * e2
        u_p, u_q = y_p + e2 * p_q.conjugate(), y_q + q_q * e2
        u_u = y_y + 2.0 * (e2.conjugate() * y_q).real + _size(e2) * q_q
    elif o.first.reach == 0.0:
        slow = Slow(o.second.dr, o.second.di, o.second.reach, 2.0 * c.Omega)
        y0, y1 = u0 - e1 * p0, u1 - e1 * p1
        y_q, y_y = _nearly_steady(slow, y0, q0, length)
        y_p = (p_q.conjugate() - (y1 * p1.conjugate() - y0 * p0.conjugate())) * e1
        u_p, u_q = y_p + p_p * e1, y_q + e1 * p_q
        u_u = y_y + 2.0 * (e1.conjugate() * y_p).real + _size(e1) * p_p
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


@cold_njit
def fill_forms(c):
    """Work out the quadratic forms that the integrals of whole pieces are, by Gauss–Legendre.

    Their errors add up over the pieces of a run, so no small denominator may be in them.
    """
    forms = doubles_at(c.room + 8 * PIECES, 2 * FORMS * SQUARES)
    for k in range(2 * FORMS * SQUARES):
        forms[k] = 0.0
    z, x, v, bend, base = zero_vector(NUMBERS), new_vector(7), new_vector(7), new_vector(7), new_vector(7)
    parts = math.ceil(2.0 * c.grid / c.window)
    for node in range(2 * 8 * parts):
        stuck, part, k = node // (8 * parts), (node // 8) % parts, node % 8
        o, mass = (c.stuck, 1.0 + c.mu) if stuck else (c.free, 1.0)
        t = (c.grid / parts) * (part + 0.5 * (1.0 + (NODES[k // 2] if k % 2 else -NODES[k // 2])))
        weight = 0.5 * (c.grid / parts) * WEIGHTS[k // 2]
        for i in range(7):
            z[i] = 1.0
            motion = turn(o, c.Omega, z[0], z[1], z[2], z[3], z[4], z[5], z[6], c.grid, 0.0, t)
            z[i] = 0.0
            x[i], v[i], bend[i], _, _ = derivatives(o, c.Omega, *motion)
            base[i] = o.br * motion[2] - o.bi * motion[3] + o.second.br * motion[4] - o.second.bi * motion[5]
        for i in range(7):
            for j in range(i + 1):
                at = stuck * FORMS * SQUARES + NUMBERS * i + j
                both = weight if i == j else 2.0 * weight
                forms[at] += both * x[i] * x[j]
                forms[at + SQUARES] += both * v[i] * v[j]
                forms[at + 2 * SQUARES] += 0.5 * both * mass * (base[i] * bend[j] + base[j] * bend[i])
                forms[at + 3 * SQUARES] += both * c.lam * (v[i] - base[i]) * (v[j] - base[j])
                if i == HELD:
                    # What the held force does to the oscillator, less what the base does against it.
                    forms[at + 2 * SQUARES] += 0.5 * both * (v[j] - base[j])


@fused_njit
def _gather(sums, motion):
    """Add the products of the numbers with which a whole piece begins to their sums."""
    ur, ui, pr, pi, qr, qi, held, _, _ = motion
    sums[0] += ur * ur
    sums[8] += ui * ur
    sums[9] += ui * ui
    sums[16] += pr * ur
    sums[17] += pr * ui
    sums[18] += pr * pr
    sums[24] += pi * ur
    sums[25] += pi * ui
    sums[26] += pi * pr
    sums[27] += pi * pi
    sums[32] += qr * ur
    sums[33] += qr * ui
    sums[34] += qr * pr
    sums[35] += qr * pi
    sums[36] += qr * qr
    sums[40] += qi * ur
    sums[41] += qi * ui
    sums[42] += qi * pr
    sums[43] += qi * pi
    sums[44] += qi * qr
    sums[45] += qi * qi
    sums[48] += held * ur
    sums[49] += held * ui
    sums[50] += held * pr
    sums[51] += held * pi
    sums[52] += held * qr
    sums[53] += held * qi
    sums[54] += held * held


@fused_njit
def _highest(o, motion, end):
    """Return a bound of |x1| between two motions that are a piece apart."""
    return max(abs(motion[HELD] + motion[0]), abs(end[HELD] + end[0])) + sagging(o, motion)


@fused_njit
def _base(c, o, motion):
    """Return the displacement of the base, from the forces that it makes."""
    _, _, pr, pi, qr, qi, _, _, _ = motion
    return ((o.bi * pr + o.br * pi) + 0.5 * (o.second.bi * qr + o.second.br * qi)) / c.Omega


@fused_njit
def _jump_work(c, o, before, after):
    """Return what the base works against the spring where its phase turns."""
    here, there = _base(c, o, before), _base(c, o, after)
    return (here - there) * ((before[HELD] + before[0]) - 0.5 * (here + there))


@fused_njit
def _over_pieces(c, o, motion, gone, last, best):
    """Go over whole pieces as long as |x1| stays below `best` and draws are at hand: so there is no call in the loop.

    Returns (motion, time gone, number of pieces).
    """
    drawn, sums = doubles_at(c.room, JUMPS + 1), doubles_at(c.room + 8 * SUMS, SQUARES)
    place, pieces = int(motion[INDEX] - drawn[FIRST]) + 1, 0
    while place < AHEAD and motion[INDEX] < last:
        end = end_of(c, o, motion, c.grid)
        if not _highest(o, motion, end) <= best:
            break
        _gather(sums, motion)
        motion = under(c, o, end, place)
        if c.diffusion > 0.0:
            drawn[JUMPS] += _jump_work(c, o, end, motion)
        gone += c.grid
        place += 1
        pieces += 1
    return motion, gone, pieces


@loop_njit
def _book(room, out, stuck, ball):
    """Add the integrals of whole pieces to the totals, and empty the sums; `ball` is the time times v2^2 in flight."""
    sums = doubles_at(room + 8 * SUMS, SQUARES)
    forms = doubles_at(room + 8 * (PIECES + stuck * FORMS * SQUARES), FORMS * SQUARES)
    x, v, work, loss = 0.0, 0.0, 0.0, 0.0
    for i in range(NUMBERS - 1):
        for k in range(NUMBERS * i, NUMBERS * i + i + 1):
            x += forms[k] * sums[k]
            v += forms[SQUARES + k] * sums[k]
            work += forms[2 * SQUARES + k] * sums[k]
            loss += forms[3 * SQUARES + k] * sums[k]
            sums[k] = 0.0
    out[entry.X1_SQUARE] += x
    out[entry.V1_SQUARE] += v
    out[entry.V2_SQUARE] += v if stuck else ball
    jumps = doubles_at(room, JUMPS + 1)
    out[entry.BASE_WORK] += work + jumps[JUMPS]
    jumps[JUMPS] = 0.0
    out[entry.DAMPER_LOSS] += loss


@add_segment.register(ScatterConstants)
@fused_njit
def _add_segment(c, out, mode, begins, x1, v1, x2, v2, phase, length):
    stuck = mode != 0.0
    o = c.stuck if stuck else c.free
    motion = flight(c, o, x1, v1, phase, begins)
    gone, pieces = 0.0, 0
    last = piece_at(c, begins + length) if c.drawn else 0.0
    out[entry.DURATION] += length
    while True:
        if motion[LEFT] == c.grid:
            motion, gone, more = _over_pieces(c, o, motion, gone, last, out[entry.MAX_ABS_X1])
            pieces += more
        lasts = motion[LEFT] if motion[INDEX] < last else max(length - gone, 0.0)
        end = end_of(c, o, motion, lasts)
        if motion[INDEX] < last and lasts == c.grid:
            _gather(doubles_at(c.room + 8 * SUMS, SQUARES), motion)
            pieces += 1
        else:
            xx, vv, ball, work, loss = _energies(c, o, stuck, motion, end, v2, lasts)
            out[entry.X1_SQUARE] += xx
            out[entry.V1_SQUARE] += vv
            out[entry.V2_SQUARE] += ball
            out[entry.BASE_WORK] += work
            out[entry.DAMPER_LOSS] += loss
        if not (lasts <= c.grid and _highest(o, motion, end) <= out[entry.MAX_ABS_X1]):
            best, when = peak_between(c, o, motion, end, 0.0, lasts, out[entry.MAX_ABS_X1])
            if when >= 0.0:
                out[entry.MAX_ABS_X1] = best
                out[entry.T_MAX_ABS_X1] = begins + gone + when
        if not motion[INDEX] < last:
            break
        gone += lasts
        motion = redraw(c, o, end)
        if c.diffusion > 0.0:
            out[entry.BASE_WORK] += _jump_work(c, o, end, motion)
    if pieces:
        _book(c.room, out, int(stuck), v2 * v2 * c.grid * pieces)
