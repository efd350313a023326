"""A motion of the cavity at any time since its start, from the exponentials that stand in the room of a `Structure`."""

from __future__ import annotations

from vines.dynamics._flight import derivatives, modulus, phasors, turn
from vines.dynamics._sincos import sincos
from vines.dynamics.modes._structure import oscillator_at, weight_at
from vines.kernels import doubles_at, fused_njit, loop_njit

__all__ = ["jet", "launch", "modal_at"]


@fused_njit
def _combined(sr, si, cr, ci, ur, ui, gr, gi):
    """Return s u + c G."""
    return (sr * ur - si * ui) + (cr * gr - ci * gi), (sr * ui + si * ur) + (cr * gi + ci * gr)


@loop_njit
def jet(o, Omega, tau):
    """Return the motion at a time since its start.

    Returns
    -------
    (tau, x, v, a, j, k, d5, d6, fourth, fifth, size, most, grows)
        x1 and its derivatives; bounds of the fourth and the fifth on what is to come, but for `Structure.forced`; the
        size of the terms of x1; |x1| is at most ``most + grows t`` a time t later.
    """
    room = doubles_at(o.room, 2 + 2 * o.n)
    er, ei = room[0], room[1]
    sine, cosine = sincos(Omega * tau)
    er, ei = er * cosine - ei * sine, er * sine + ei * cosine
    # What turns with the forcing.
    re, im = o.hr * er - o.hi * ei, o.hr * ei + o.hi * er
    still = modulus(re, im)
    square = Omega * Omega
    x, v, a = re, -Omega * im, -square * re
    j, k = square * Omega * im, square * square * re
    d5, d6 = -square * j, -square * k
    fourth = square * square * still
    bound = Omega * fourth
    size = most = still
    grows = 0.0
    for i in range(o.n):
        p = oscillator_at(o.table, i)
        ar, ai = weight_at(o.table, i)
        weight = modulus(ar, ai)
        hr, hi = p.gr * room[0] - p.gi * room[1], p.gr * room[1] + p.gi * room[0]
        ur, ui, gr, gi = turn(p, Omega, room[2 + 2 * i], room[3 + 2 * i], hr, hi, tau)
        r1, i1 = gr - p.half * ur - p.gamma * ui, gi - p.half * ui + p.gamma * ur
        r2, i2 = _combined(p.s2r, p.s2i, p.c2r, p.c2i, ur, ui, gr, gi)
        r3, i3 = _combined(p.s3r, p.s3i, p.c3r, p.c3i, ur, ui, gr, gi)
        r4, i4 = _combined(p.s4r, p.s4i, p.c4r, p.c4i, ur, ui, gr, gi)
        r5, i5 = _combined(p.s5r, p.s5i, p.c5r, p.c5i, ur, ui, gr, gi)
        r6, i6 = _combined(p.s6r, p.s6i, p.c6r, p.c6i, ur, ui, gr, gi)
        x += ar * ur - ai * ui
        v += ar * r1 - ai * i1
        a += ar * r2 - ai * i2
        j += ar * r3 - ai * i3
        k += ar * r4 - ai * i4
        d5 += ar * r5 - ai * i5
        d6 += ar * r6 - ai * i6
        fourth += weight * modulus(r4, i4)
        bound += weight * modulus(r5, i5)
        here, push = modulus(ur, ui), modulus(gr, gi)
        size += weight * (here + push)
        if p.reach == 0.0:
            qr, qi = gr * p.er - gi * p.ei, gr * p.ei + gi * p.er
            most += weight * (modulus(ur - qr, ui - qi) + modulus(qr, qi))
        else:
            most += weight * here
            grows += weight * push
    return tau, x, v, a, j, k, d5, d6, fourth, bound, size, most, grows


@loop_njit
def launch(c, o, values, first, phase):
    """Return the motion that begins with the modes that stand in `values`, from place `first` on, at a phase."""
    room = doubles_at(o.room, 2 + 2 * o.n)
    sine, cosine = sincos(phase)
    room[0], room[1] = cosine, sine
    if o.loaded == 0.0:
        for k in range(o.n):
            p = oscillator_at(o.table, k)
            room[2 + 2 * k], room[3 + 2 * k], _, _ = phasors(
                p, c.Omega, values[first + 2 * k], values[first + 1 + 2 * k], phase
            )
    else:
        n = 2 * o.n
        to = doubles_at(o.to, (n + 1) * n)
        for j in range(o.n):
            at = 2 * (n + 1) * j
            re = to[at + 2 * n] * cosine + to[at + 2 * n + 1] * sine
            im = to[at + 2 * n + 1] * cosine - to[at + 2 * n] * sine
            for i in range(n):
                re += to[at + 2 * i] * values[first + i]
                im += to[at + 2 * i + 1] * values[first + i]
            room[2 + 2 * j], room[3 + 2 * j] = re, im
    return jet(o, c.Omega, 0.0)


@loop_njit
def modal_at(c, o, tau, out, first):
    """Write amplitude and velocity of all modes, a time after the start of the present motion, to places of `out`."""
    room = doubles_at(o.room, 2 + 2 * o.n)
    n = 2 * o.n
    back = doubles_at(o.back, n * (o.n + 1) * 2) if o.loaded != 0.0 else room
    if o.loaded != 0.0:
        sine, cosine = sincos(c.Omega * tau)
        er, ei = room[0] * cosine - room[1] * sine, room[0] * sine + room[1] * cosine
        for i in range(n):
            at = 2 * (o.n + 1) * i + 2 * o.n
            out[first + i] = back[at] * er - back[at + 1] * ei
    for j in range(o.n):
        p = oscillator_at(o.table, j)
        hr, hi = p.gr * room[0] - p.gi * room[1], p.gr * room[1] + p.gi * room[0]
        ur, ui, gr, gi = turn(p, c.Omega, room[2 + 2 * j], room[3 + 2 * j], hr, hi, tau)
        if o.loaded == 0.0:
            out[first + 2 * j], out[first + 1 + 2 * j], _, _, _ = derivatives(p, c.Omega, ur, ui, gr, gi)
        else:
            for i in range(n):
                at = 2 * (o.n + 1) * i + 2 * j
                out[first + i] += back[at] * ur - back[at + 1] * ui
