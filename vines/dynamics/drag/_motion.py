"""Motion of the oscillator and of a ball that is dragged along, and what is certain of them."""

from __future__ import annotations

import math

from vines.dynamics._advance import advance, begin, law_of
from vines.dynamics._contact import CONTACT, contact_within, next_contact
from vines.dynamics._flight import (
    ball_flown,
    decay,
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
from vines.dynamics._sticking import holds_for, next_release
from vines.dynamics._tangent import carry_basis
from vines.dynamics._window import width_of, write_end
from vines.dynamics.drag._constants import DragConstants, DragFrame, DragTable, Gap, GapConstants
from vines.kernels import fused_njit, loop_njit, njit

__all__ = ["ball_velocity", "set_out"]

for _name in (advance, begin, carry_basis, write_end, law_of, next_release, flown, free_ball, phase_after, pull):
    _name.register(DragConstants)(_name.first)

pull.register(GapConstants)(pull.first)

width_of.register(DragTable)(width_of.first)


@fused_njit
def set_out(o, x, v, v2, gr, gi):
    """Return the motion that begins with x, v, v2 under the force G."""
    y = o.flies * (v2 - o.tx * x - o.tv * v - (o.yr * gr - o.yi * gi))
    ur = x - o.kappa * y
    return ur, (gr - o.own.half * ur - (v + o.rho * o.kappa * y)) * o.own.inverse, gr, gi, y, 0.0


@fused_njit
def ball_velocity(o, ur, ui, gr, gi, y, way):
    """Return the velocity of the ball in a motion."""
    return (o.mr * ur - o.mi * ui) + (o.nr * gr - o.ni * gi) + o.by * y


@launched.register(DragConstants)
@fused_njit
def _launched(c, o, x, v, v2, phase, t):
    _, _, gr, gi = phasors(o.own, c.Omega, x, v, phase)
    return set_out(o, x, v, v2, gr, gi)


@flight.register(DragConstants)
@fused_njit
def _flight(c, o, x, v, phase, t):
    return launched(c, o, x, v, 0.0, phase, t)


@turn.register(DragFrame)
@fused_njit
def _turn(o, Omega, ur, ui, gr, gi, y, way, tau):
    vr, vi, hr, hi = turn(o.own, Omega, ur, ui, gr, gi, tau)
    left = decay(o.rho * tau)
    lasts = (1.0 - left) / o.rho if o.rho * tau > 0.03125 else tau * _mean_decay(o.rho * tau)
    # The integrals of G and of u, u' = s u + G.
    dr, di = hr - gr, hi - gi
    forced_r, forced_i = di / Omega, -dr / Omega
    s = complex(-o.own.half, o.own.gamma)
    swung = complex(vr - ur - forced_r, vi - ui - forced_i) / s
    come = o.mr * swung.real - o.mi * swung.imag + (o.nr * forced_r - o.ni * forced_i) + o.by * y * lasts
    return vr, vi, hr, hi, y * left, way + come


@fused_njit
def _mean_decay(x):
    """Return (1 - exp(-x))/x for small x."""
    return 1.0 - x * (1 / 2 - x * (1 / 6 - x * (1 / 24 - x * (1 / 120 - x * (1 / 720 - x * (1 / 5040))))))


@derivatives.register(DragFrame)
@fused_njit
def _derivatives(o, Omega, ur, ui, gr, gi, y, way):
    x, v, a, j, k = derivatives(o.own, Omega, ur, ui, gr, gi)
    part = o.kappa * y
    rho = o.rho
    return (
        x + part,
        v - rho * part,
        a + rho * rho * part,
        j - rho * rho * rho * part,
        k + (rho * rho) * (rho * rho) * part,
    )


@fifth.register(DragFrame)
@fused_njit
def _fifth(o, ur, ui, gr, gi, y, way):
    re, im = fifth(o.own, ur, ui, gr, gi)
    return re - (o.rho * o.rho) * (o.rho * o.rho) * (o.rho * o.kappa * y), im


@sixth.register(DragFrame)
@fused_njit
def _sixth(o, ur, ui, gr, gi, y, way):
    cube = o.rho * o.rho * o.rho
    return sixth(o.own, ur, ui, gr, gi) + cube * cube * o.kappa * y


@terms.register(DragFrame)
@fused_njit
def _terms(o, ur, ui, gr, gi, y, way):
    return terms(o.own, ur, ui, gr, gi) + abs(o.kappa * y)


@forced_fifth.register(DragConstants)
@fused_njit
def _forced_fifth(c, ur, ui, gr, gi, y, way):
    rho = c.free.rho
    # What decays by itself is in the fifth derivative now, and may be gone later.
    return modulus(gr, gi) * c.Omega5 + 2.0 * abs(c.free.kappa * y) * rho**5 / c.window


@stays_below.register(DragFrame)
@fused_njit
def _stays_below(o, Omega, now, end, left, best):
    part = abs(o.kappa * now[4])
    return stays_below(o.own, Omega, now[:4], end[:4], left, best - part)


@ball_flown.register(DragConstants)
@fused_njit
def _ball_flown(c, motion, v2, tau):
    now = turn(c.free, c.Omega, *motion, tau)
    return now[5], ball_velocity(c.free, *now)


@relative.register(DragConstants)
@fused_njit
def _relative(c):
    return c.gap


@free_ball.register(GapConstants)
@fused_njit
def _free_ball(c, v2, tau):
    return 0.0, 0.0


@turn.register(Gap)
@fused_njit
def _turn_gap(o, Omega, ur, ui, gr, gi, y, way, tau):
    return turn(o.frame, Omega, ur, ui, gr, gi, y, way, tau)


@fused_njit
def _seen(o, ur, ui, gr, gi):
    """Return W and its force."""
    return (
        (o.ar * ur - o.ai * ui) + (o.br * gr - o.bi * gi),
        (o.ar * ui + o.ai * ur) + (o.br * gi + o.bi * gr),
        o.zr * gr - o.zi * gi,
        o.zr * gi + o.zi * gr,
    )


@derivatives.register(Gap)
@fused_njit
def _derivatives_of_gap(o, Omega, ur, ui, gr, gi, y, way):
    f = o.frame
    v, a, j, k, _ = derivatives(f.own, Omega, *_seen(f, ur, ui, gr, gi))
    part, rho = f.ey * y, f.rho
    return ur + f.kappa * y - way, v + part, a - rho * part, j + rho * rho * part, k - rho * rho * rho * part


@fifth.register(Gap)
@fused_njit
def _fifth_of_gap(o, ur, ui, gr, gi, y, way):
    f = o.frame
    wr, wi, zr, zi = _seen(f, ur, ui, gr, gi)
    p = f.own
    re = (p.s4r * wr - p.s4i * wi) + (p.c4r * zr - p.c4i * zi)
    im = (p.s4r * wi + p.s4i * wr) + (p.c4r * zi + p.c4i * zr)
    return re + (f.rho * f.rho) * (f.rho * f.rho) * (f.ey * y), im


@sixth.register(Gap)
@fused_njit
def _sixth_of_gap(o, ur, ui, gr, gi, y, way):
    f = o.frame
    re, _ = fifth(f.own, *_seen(f, ur, ui, gr, gi))
    return re - (f.rho * f.rho) * (f.rho * f.rho) * (f.rho * f.ey * y)


@terms.register(Gap)
@fused_njit
def _terms_of_gap(o, ur, ui, gr, gi, y, way):
    return terms(o.frame, ur, ui, gr, gi, y, way) + abs(way)


@forced_fifth.register(GapConstants)
@fused_njit
def _forced_fifth_of_gap(c, ur, ui, gr, gi, y, way):
    f = c.free.frame
    _, _, zr, zi = _seen(f, ur, ui, gr, gi)
    return modulus(zr, zi) * c.Omega4 + 2.0 * abs(f.ey * y) * (f.rho * f.rho) * (f.rho * f.rho) / c.window


@fourth_bound.register(GapConstants)
@fused_njit
def _fourth_bound(c, ur, ui, gr, gi, y, way, window):
    f = c.free.frame
    p = f.own
    wr, wi, zr, zi = _seen(f, ur, ui, gr, gi)
    re = (p.s3r * wr - p.s3i * wi) + (p.c3r * zr - p.c3i * zi)
    im = (p.s3r * wi + p.s3i * wr) + (p.c3r * zi + p.c3i * zr)
    growth = modulus(zr, zi) * (c.Omega * c.Omega * c.Omega) * window
    return modulus(re, im) + growth + abs(f.ey * y) * (f.rho * f.rho * f.rho)


@speed_terms.register(GapConstants)
@njit
def _speed_terms(c, ur, ui, gr, gi, y, way):
    return abs(ur) + abs(ui) + (1.0 + c.Omega) * (abs(gr) + abs(gi)) + abs(y)


@next_contact.register(DragConstants)
@loop_njit
def _next_contact(c, motion, x2, v2, wall, released, tau, stop):
    code, at, side, x, v = contact_within(c.gap, motion, x2, 0.0, wall, released, tau, stop)
    if code == CONTACT:
        x, v, _, _, _ = derivatives(c.free, c.Omega, *turn(c.free, c.Omega, *motion, at))
    return code, at, side, x, v


@holds_for.register(GapConstants)
@fused_njit
def _holds_for(c, ur, ui, gr, gi, y, way):
    return math.inf


@ringing.register(DragConstants)
@njit
def _ringing(c, x1, v1, v2, phase):
    o = c.free.own
    cosine, sine = math.cos(phase), math.sin(phase)
    q_re, q_im = o.qr * cosine - o.qi * sine, o.qr * sine + o.qi * cosine
    swings = math.hypot(x1 - q_re, v1 + c.Omega * q_im)
    if c.delta == 0.0:
        return swings
    return math.hypot(swings, launched(c, c.free, x1, v1, v2, phase, 0.0)[4])


@drift.register(DragConstants)
@njit
def _drift(c, v2):
    # A ball that is dragged comes to swing about a place in the cavity.
    return 0.0 if c.delta > 0.0 else abs(v2)


@rate_alone.register(DragConstants)
@njit
def _rate_alone(c, d, k):
    if k == 0:
        return 0.0
    slow = c.free.rho < c.free.own.half
    return -c.free.rho if k == (1 if slow else 3) else -c.free.own.half
