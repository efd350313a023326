"""Motion of the oscillator and of a ball that slides in one sense, or rides, and what is certain of them."""

from __future__ import annotations

import math

from vines.dynamics._flight import (
    ball_flown,
    derivatives,
    drift,
    fifth,
    flight,
    flown,
    forced_fifth,
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
    terms,
    turn,
)
from vines.dynamics._integrals import stays_below
from vines.dynamics._sticking import holds_for
from vines.dynamics.friction._constants import (
    FrictionConstants,
    FrictionFrame,
    HoldConstants,
    Rate,
    RateConstants,
    SlidGap,
    SlidGapConstants,
)
from vines.kernels import fused_njit, njit

__all__ = ["SENSE", "SPEED", "WAY", "draws", "sliding"]

SENSE, WAY, SPEED = 4, 5, 6
"""Places in a motion."""

flown.register(FrictionConstants)(flown.first)
for _name in (pull, free_ball, phase_after):
    _name.register(FrictionConstants)(_name.first)
for _kind in (SlidGapConstants, RateConstants):
    pull.register(_kind)(pull.first)


@fused_njit
def draws(c, x, v, phase):
    """Return (1 + mu) (x1'' + G) of a ball that would ride: it does where this is no larger than (1 + mu) f."""
    return c.A * (math.sin(phase) + c.lam * c.Omega * math.cos(phase)) - c.lam * v - x + c.G


@fused_njit
def sliding(c, o, x, v, v2, phase, sense):
    """Return the motion that begins with x, v and v2 while the ball slides in a sense."""
    ur, ui, gr, gi = phasors(o.own, c.Omega, x + o.load * sense, v, phase)
    return ur, ui, gr, gi, sense, 0.0, v2


@launched.register(FrictionConstants)
@fused_njit
def _launched(c, o, x, v, v2, phase, t):
    closing = v - v2
    if closing == 0.0:
        closing = draws(c, x, v, phase)
    sense = 1.0 if o.rides > 0.0 or closing > 0.0 else -1.0
    return sliding(c, o, x, v, v2, phase, sense)


@flight.register(FrictionConstants)
@fused_njit
def _flight(c, o, x, v, phase, t):
    return launched(c, o, x, v, v, phase, t)


@turn.register(FrictionFrame)
@fused_njit
def _turn(o, Omega, ur, ui, gr, gi, sense, way, v2, tau):
    ur, ui, gr, gi = turn(o.own, Omega, ur, ui, gr, gi, tau)
    a = o.f * sense - o.pull
    return ur, ui, gr, gi, sense, way + tau * (v2 + 0.5 * a * tau), v2 + a * tau


@derivatives.register(FrictionFrame)
@fused_njit
def _derivatives(o, Omega, ur, ui, gr, gi, sense, way, v2):
    x, v, a, j, k = derivatives(o.own, Omega, ur, ui, gr, gi)
    return x - o.load * sense, v, a, j, k


@fifth.register(FrictionFrame)
@fused_njit
def _fifth(o, ur, ui, gr, gi, sense, way, v2):
    return fifth(o.own, ur, ui, gr, gi)


@sixth.register(FrictionFrame)
@fused_njit
def _sixth(o, ur, ui, gr, gi, sense, way, v2):
    return sixth(o.own, ur, ui, gr, gi)


@terms.register(FrictionFrame)
@fused_njit
def _terms(o, ur, ui, gr, gi, sense, way, v2):
    return terms(o.own, ur, ui, gr, gi) + abs(o.load)


@stays_below.register(FrictionFrame)
@fused_njit
def _stays_below(o, Omega, now, end, left, best):
    return stays_below(o.own, Omega, now[:4], end[:4], left, best - abs(o.load))


@forced_fifth.register(FrictionConstants)
@fused_njit
def _forced_fifth(c, ur, ui, gr, gi, sense, way, v2):
    return modulus(gr, gi) * c.Omega5


for _kind in (SlidGapConstants, HoldConstants):
    forced_fifth.register(_kind)(_forced_fifth)


@ball_flown.register(FrictionConstants)
@fused_njit
def _ball_flown(c, motion, v2, tau):
    now = turn(c.free, c.Omega, *motion, tau)
    return now[WAY], now[SPEED]


@relative.register(FrictionConstants)
@fused_njit
def _relative(c):
    return c.gap


@free_ball.register(SlidGapConstants)
@fused_njit
def _rests(c, v2, tau):
    return 0.0, 0.0


for _kind in (RateConstants, HoldConstants):
    free_ball.register(_kind)(_rests)


@holds_for.register(SlidGapConstants)
@fused_njit
def _holds_for(c, ur, ui, gr, gi, sense, way, v2):
    return math.inf


@turn.register(SlidGap)
@fused_njit
def _turn_gap(o, Omega, ur, ui, gr, gi, sense, way, v2, tau):
    return turn(o.frame, Omega, ur, ui, gr, gi, sense, way, v2, tau)


@derivatives.register(SlidGap)
@fused_njit
def _derivatives_of_gap(o, Omega, ur, ui, gr, gi, sense, way, v2):
    x, v, a, j, k = derivatives(o.frame, Omega, ur, ui, gr, gi, sense, way, v2)
    return x - way, v - v2, a - (o.frame.f * sense - o.frame.pull), j, k


@fifth.register(SlidGap)
@fused_njit
def _fifth_of_gap(o, ur, ui, gr, gi, sense, way, v2):
    return fifth(o.frame.own, ur, ui, gr, gi)


@sixth.register(SlidGap)
@fused_njit
def _sixth_of_gap(o, ur, ui, gr, gi, sense, way, v2):
    return sixth(o.frame.own, ur, ui, gr, gi)


@terms.register(SlidGap)
@fused_njit
def _terms_of_gap(o, ur, ui, gr, gi, sense, way, v2):
    return terms(o.frame, ur, ui, gr, gi, sense, way, v2) + abs(way)


turn.register(Rate)(_turn_gap)


@derivatives.register(Rate)
@fused_njit
def _derivatives_of_rate(o, Omega, ur, ui, gr, gi, sense, way, v2):
    x, v, a, j, _ = derivatives(o.frame, Omega, ur, ui, gr, gi, sense, way, v2)
    return x, v, v - v2, a - (o.frame.f * sense - o.frame.pull), j


@fifth.register(Rate)
@fused_njit
def _fourth(o, ur, ui, gr, gi, sense, way, v2):
    p = o.frame.own
    re = (p.s4r * ur - p.s4i * ui) + (p.c4r * gr - p.c4i * gi)
    return re, (p.s4r * ui + p.s4i * ur) + (p.c4r * gi + p.c4i * gr)


@sixth.register(Rate)
@fused_njit
def _fifth_real(o, ur, ui, gr, gi, sense, way, v2):
    return fifth(o.frame.own, ur, ui, gr, gi)[0]


@forced_fifth.register(RateConstants)
@fused_njit
def _forced_fourth(c, ur, ui, gr, gi, sense, way, v2):
    return modulus(gr, gi) * c.Omega4


@pull.register(HoldConstants)
@fused_njit
def _pull_from_place(c, a):
    return a + c.offset


@ringing.register(FrictionConstants)
@njit
def _ringing(c, x1, v1, v2, phase):
    o = c.stuck if v1 == v2 else c.free
    cosine, sine = math.cos(phase), math.sin(phase)
    q_re, q_im = o.own.qr * cosine - o.own.qi * sine, o.own.qr * sine + o.own.qi * cosine
    return math.hypot(x1 + o.load - q_re, v1 + c.Omega * q_im)


@drift.register(FrictionConstants)
@njit
def _drift(c, v2):
    # Friction brakes a ball that nothing moves.
    return 0.0 if c.friction > 0.0 else abs(v2)


@rate_alone.register(FrictionConstants)
@njit
def _rate_alone(c, d, k):
    if c.friction == 0.0:
        return 0.0 if k < 2 else -0.5 * c.lam
    # It rides: where it does so makes no difference, and no velocity of its own is left.
    if k == 0:
        return 0.0
    return -math.inf if k == 3 else -0.5 * c.lam / (1.0 + c.mu)
