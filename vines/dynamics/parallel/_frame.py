"""Motion of the frame, with what rides on it, and of free balls, and what is certain of them."""

from __future__ import annotations

import math

from vines.dynamics._flight import (
    derivatives,
    drift,
    fifth,
    flight,
    flown,
    forced_fifth,
    fourth_bound,
    free_ball,
    launched,
    modulus,
    phase_after,
    phasors,
    pull,
    rate_alone,
    relative,
    ringing,
    sixth,
    speed_terms,
    terms,
    turn,
)
from vines.dynamics._integrals import stays_below
from vines.dynamics._sticking import holds_for
from vines.dynamics._tilt import falling_ball, pull_of_tilt
from vines.dynamics.parallel._constants import Frame, ParallelConstants
from vines.kernels import fused_njit, njit

__all__: list[str] = []


@flight.register(ParallelConstants)
@fused_njit
def _flight(c, o, x, v, phase, t):
    return phasors(o.own, c.Omega, x + o.sag, v, phase)


@flown.register(ParallelConstants)
@fused_njit
def _flown(c, o, motion, tau):
    return turn(o.own, c.Omega, *motion, tau)


@turn.register(Frame)
@fused_njit
def _turn(o, Omega, ur, ui, gr, gi, tau):
    return turn(o.own, Omega, ur, ui, gr, gi, tau)


@derivatives.register(Frame)
@fused_njit
def _derivatives(o, Omega, ur, ui, gr, gi):
    x, v, a, j, k = derivatives(o.own, Omega, ur, ui, gr, gi)
    return x - o.sag, v, a, j, k


@fifth.register(Frame)
@fused_njit
def _fifth(o, ur, ui, gr, gi):
    return fifth(o.own, ur, ui, gr, gi)


@sixth.register(Frame)
@fused_njit
def _sixth(o, ur, ui, gr, gi):
    return sixth(o.own, ur, ui, gr, gi)


@terms.register(Frame)
@fused_njit
def _terms(o, ur, ui, gr, gi):
    return terms(o.own, ur, ui, gr, gi) + abs(o.sag)


@stays_below.register(Frame)
@fused_njit
def _stays_below(o, Omega, now, end, left, best):
    return stays_below(o.own, Omega, now, end, left, best - abs(o.sag))


@forced_fifth.register(ParallelConstants)
@fused_njit
def _forced_fifth(c, ur, ui, gr, gi):
    return modulus(gr, gi) * c.Omega5


@fourth_bound.register(ParallelConstants)
@fused_njit
def _fourth_bound(c, ur, ui, gr, gi, window):
    o = c.free.own
    re = (o.s4r * ur - o.s4i * ui) + (o.c4r * gr - o.c4i * gi)
    im = (o.s4r * ui + o.s4i * ur) + (o.c4r * gi + o.c4i * gr)
    return modulus(re, im) + modulus(gr, gi) * c.Omega4 * window


@speed_terms.register(ParallelConstants)
@njit
def _speed_terms(c, ur, ui, gr, gi):
    return abs(ur) + abs(ui) + (1.0 + c.Omega) * (abs(gr) + abs(gi)) + abs(c.G)


for _name in (drift, holds_for, launched, phase_after, rate_alone, relative):
    _name.register(ParallelConstants)(_name.first)

free_ball.register(ParallelConstants)(falling_ball)
pull.register(ParallelConstants)(pull_of_tilt)


@ringing.register(ParallelConstants)
@njit
def _ringing(c, x1, v1, v2, phase):
    o = c.free.own
    cosine, sine = math.cos(phase), math.sin(phase)
    q_re, q_im = o.qr * cosine - o.qi * sine, o.qr * sine + o.qi * cosine
    return math.hypot(x1 - q_re, v1 + c.Omega * q_im)
