"""Motion with scatter: two harmonics and a force that is held for a while, drawn again, and held.

A motion is (u, G1, G2, held, left, index): x = held + Re u, and draw `index` holds for a time `left` yet. Where the
next one is drawn the phase of the forcing may turn, too. What a single motion does, `turn`, and what is certain of it,
is as without scatter; a flight goes over draws, piece by piece.
"""

from __future__ import annotations

import math

from vines.dynamics._advance import advance, begin, law_of
from vines.dynamics._contact import NO_CONTACT, contact_within, next_contact
from vines.dynamics._flight import (
    advance_phase,
    ball_flown,
    decay,
    derivatives,
    fifth,
    flight,
    flown,
    forced_fifth,
    free_ball,
    launched,
    modulus,
    phase_after,
    pull,
    relative,
    sixth,
    slow_growth,
    terms,
    turn,
)
from vines.dynamics._impact_law import impact_law_kernel
from vines.dynamics._random import normal
from vines.dynamics._scatter_constants import (
    AHEAD,
    COSINES,
    DRAWS,
    FIRST,
    SINES,
    TURNS,
    Piece,
    ScatterConstants,
    ScatterOscillator,
)
from vines.dynamics._scatter_draws import fill
from vines.dynamics._sincos import sincos
from vines.dynamics._sticking import UNRESOLVED, holds_for, next_release, release_within
from vines.dynamics._window import write_end
from vines.kernels import doubles_at, fused_njit, linked_njit, loop_njit

__all__ = ["HELD", "INDEX", "LEFT", "end_of", "piece_at", "place_of", "redraw", "sagging", "under"]

HELD, LEFT, INDEX = 6, 7, 8

EARLY = 1e-7
"""Share of a piece that a time may lie before its begin, by rounding, and count as in it: windows end at such times."""

APART = 1.0 - 1e-12
"""Where |w| is smaller the gap to a wall can be told."""


@fused_njit
def place_of(c, index):
    """Return the place of a draw in the room, where it is by then."""
    drawn = doubles_at(c.room, DRAWS)
    place = index - drawn[FIRST]
    if not 0.0 <= place < AHEAD:
        fill(c, index)
        place = index - drawn[FIRST]
    return int(place)


@fused_njit
def piece_at(c, t):
    """Return the number of the draw that holds at a time."""
    return max(math.floor((t - c.origin) / c.grid + EARLY), 0.0)


@phase_after.register(ScatterConstants)
@linked_njit
def _phase_after(c, phase, angle, before, after):
    if c.diffusion > 0.0:
        turns = doubles_at(c.room + 8 * TURNS, AHEAD)
        index, last = piece_at(c, before), piece_at(c, after)
        while index < last:
            index += 1.0
            angle += turns[place_of(c, index)]
    return advance_phase(phase, angle)


@flight.register(ScatterConstants)
@fused_njit
def _flight(c, o, x, v, phase, t):
    sine, cosine = sincos(phase)
    twice, along = 2.0 * sine * cosine, 1.0 - 2.0 * sine * sine
    pr = o.first.gr * cosine - o.first.gi * sine
    pi = o.first.gr * sine + o.first.gi * cosine
    qr = o.second.gr * along - o.second.gi * twice
    qi = o.second.gr * twice + o.second.gi * along
    held, left, index = 0.0, math.inf, 0.0
    if c.drawn:
        index = piece_at(c, t)
        left = (index + 1.0) * c.grid - (t - c.origin)
        held = doubles_at(c.room + 8 * DRAWS, AHEAD)[place_of(c, index)]
    ur = x - held
    return ur, (pr + qr - o.first.half * ur - v) * o.first.inverse, pr, pi, qr, qi, held, left, index


@fused_njit
def _gained(h, er, ei, fr, fi, tau):
    """Return what a harmonic adds to u in a time over which u itself turns by e and the harmonic by f."""
    if abs(tau) <= h.reach:
        re, im = slow_growth(h, tau)
        return fr * re - fi * im, fr * im + fi * re
    return (fr - er) * h.er - (fi - ei) * h.ei, (fr - er) * h.ei + (fi - ei) * h.er


@turn.register(ScatterOscillator)
@fused_njit
def _turn(o, Omega, ur, ui, pr, pi, qr, qi, held, left, index, tau):
    fi, fr = sincos(Omega * tau)
    ti, tr = 2.0 * fi * fr, 1.0 - 2.0 * fi * fi
    size = decay(o.first.half * tau)
    ei, er = sincos(o.first.gamma * tau)
    er *= size
    ei *= size
    br, bi = _gained(o.first, er, ei, fr, fi, tau)
    dr, di = _gained(o.second, er, ei, tr, ti, tau)
    piece = Piece(er, ei, fr, fi, br, bi, tr, ti, dr, di)
    return _by_factors(piece, ur, ui, pr, pi, qr, qi, held, left - tau, index)


@fused_njit
def _by_factors(piece, ur, ui, pr, pi, qr, qi, held, left, index):
    er, ei, fr, fi, br, bi, tr, ti, dr, di = piece
    return (
        (er * ur - ei * ui) + (br * pr - bi * pi) + (dr * qr - di * qi),
        (er * ui + ei * ur) + (br * pi + bi * pr) + (dr * qi + di * qr),
        fr * pr - fi * pi,
        fr * pi + fi * pr,
        tr * qr - ti * qi,
        tr * qi + ti * qr,
        held,
        left,
        index,
    )


@fused_njit
def end_of(c, o, motion, lasts):
    """Return the motion a time later that is not longer than its piece; over a whole piece the factors are known."""
    if lasts == c.grid:
        return _by_factors(o.piece, *motion)
    return turn(o, c.Omega, *motion, lasts)


@fused_njit
def under(c, o, motion, place):
    """Return the motion under the next draw, which is at a place of the room: position and velocity go on."""
    ur, ui, pr, pi, qr, qi, held, _, index = motion
    drawn = doubles_at(c.room, SINES + AHEAD)
    force = drawn[DRAWS + place]
    ur += held - force
    ui -= o.first.half * o.first.inverse * (held - force)
    if c.diffusion > 0.0:
        cosine, sine = drawn[COSINES + place], drawn[SINES + place]
        twice, along = 2.0 * sine * cosine, 1.0 - 2.0 * sine * sine
        before = pr + qr
        pr, pi = cosine * pr - sine * pi, cosine * pi + sine * pr
        qr, qi = along * qr - twice * qi, along * qi + twice * qr
        ui += (pr + qr - before) * o.first.inverse
    return ur, ui, pr, pi, qr, qi, force, c.grid, index + 1.0


@fused_njit
def redraw(c, o, motion):
    """Return the motion after the next draw."""
    return under(c, o, motion, place_of(c, motion[INDEX] + 1.0))


for _name in (advance, ball_flown, begin, free_ball, launched, pull, relative, write_end):
    _name.register(ScatterConstants)(_name.first)


@flown.register(ScatterConstants)
@linked_njit
def _flown(c, o, motion, tau):
    while tau > motion[LEFT]:
        lasts = motion[LEFT]
        motion = redraw(c, o, end_of(c, o, motion, lasts))
        tau -= lasts
    return turn(o, c.Omega, *motion, tau)


@derivatives.register(ScatterOscillator)
@fused_njit
def _derivatives(o, Omega, ur, ui, pr, pi, qr, qi, held, left, index):
    x, v, a, j, k = derivatives(o.first, Omega, ur, ui, pr, pi)
    h = o.second
    return (
        held + x,
        v + qr,
        a + (h.c2r * qr - h.c2i * qi),
        j + (h.c3r * qr - h.c3i * qi),
        k + (h.c4r * qr - h.c4i * qi),
    )


@fifth.register(ScatterOscillator)
@fused_njit
def _fifth(o, ur, ui, pr, pi, qr, qi, held, left, index):
    re, im = fifth(o.first, ur, ui, pr, pi)
    return re + (o.second.c5r * qr - o.second.c5i * qi), im + (o.second.c5r * qi + o.second.c5i * qr)


@sixth.register(ScatterOscillator)
@fused_njit
def _sixth(o, ur, ui, pr, pi, qr, qi, held, left, index):
    return sixth(o.first, ur, ui, pr, pi) + (o.second.c6r * qr - o.second.c6i * qi)


@forced_fifth.register(ScatterConstants)
@fused_njit
def _forced_fifth(c, ur, ui, pr, pi, qr, qi, held, left, index):
    return (modulus(pr, pi) + 32.0 * modulus(qr, qi)) * c.Omega5


@terms.register(ScatterOscillator)
@fused_njit
def _terms(o, ur, ui, pr, pi, qr, qi, held, left, index):
    return terms(o.first, ur, ui, pr, pi) + abs(qr) + abs(qi) + abs(held)


@holds_for.register(ScatterConstants)
@fused_njit
def _holds_for(c, ur, ui, pr, pi, qr, qi, held, left, index):
    return left


@fused_njit
def _wall_left(c, motion, x2, v2):
    """Return the wall that the ball has just left, so little ago that no gap can be told yet, or 0."""
    x, v, _, _, _ = derivatives(c.free, c.Omega, *motion)
    side = 1 if x > x2 else -1
    near = 1.0 - side * (x - x2) < UNRESOLVED * (terms(c.free, *motion) + abs(x2))
    return side if near and side * (v - v2) <= 0.0 else 0


@fused_njit
def sagging(o, motion):
    """Return by how much x may leave the chord between the ends of a whole piece."""
    return o.bend + o.sag * (abs(motion[0]) + abs(motion[1]))


@next_contact.register(ScatterConstants)
@fused_njit
def _next_contact(c, motion, x2, v2, wall, released, tau, stop):
    begins = 0.0
    while True:
        left = motion[LEFT]
        ball = x2 + v2 * begins
        if wall == 0 and left == c.grid and tau <= begins and begins + left < stop:
            end = _by_factors(c.free.piece, *motion)
            w, later = motion[HELD] + motion[0] - ball, end[HELD] + end[0] - (ball + v2 * left)
            if max(abs(w), abs(later)) + sagging(c.free, motion) < APART:
                motion = redraw(c, c.free, end)
                begins += left
                continue
        clear = max(tau - begins, 0.0)
        until = min(stop - begins, left)
        if clear < until:
            code, at, side, x, v = contact_within(c, motion, ball, v2, wall, released, clear, until)
            if code != NO_CONTACT:
                return code, begins + at, side, x, v
            clear = at
        if stop - begins <= left:
            return NO_CONTACT, begins + clear, 0, 0.0, 0.0
        motion = redraw(c, c.free, end_of(c, c.free, motion, left))
        begins += left
        wall, released = _wall_left(c, motion, x2 + v2 * begins, v2), False


@next_release.register(ScatterConstants)
@loop_njit
def _next_release(c, side, motion, tau, stop):
    begins = 0.0
    while True:
        left = motion[LEFT]
        clear = max(tau - begins, 0.0)
        until = min(stop - begins, left)
        if clear < until:
            code, at, x, v = release_within(c, c.stuck, side, motion, clear, until)
            if code != NO_CONTACT:
                return code, begins + at, x, v
            clear = at
        if stop - begins <= left:
            return NO_CONTACT, begins + clear, 0.0, 0.0
        motion = redraw(c, c.stuck, end_of(c, c.stuck, motion, left))
        begins += left


@law_of.register(ScatterConstants)
@fused_njit
def _law_of(c, closing, number):
    r = c.r - c.r_speed * abs(closing)
    if c.sigma_r > 0.0:
        r += c.sigma_r * normal(c.key, c.stream, 2 * int(number))
    return impact_law_kernel(c.mu, min(max(r, 0.0), 1.0))
