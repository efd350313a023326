"""What the kernels of one ball take of a motion of the cavity, and what forces and blows do to the modes.

A motion is what `jet` says at a time: that time, x1 and its first six derivatives, bounds of the fourth and the fifth,
and three sizes.
"""

from __future__ import annotations

import math

from vines.dynamics._flight import (
    derivatives,
    drift,
    fifth,
    forced_fifth,
    fourth_bound,
    free_ball,
    launched,
    phase_after,
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
from vines.dynamics._sincos import sincos
from vines.dynamics._sticking import holds_for
from vines.dynamics.modes._constants import GAMMA, LAM, PHI, RATE, STIFFNESS, ModesConstants, of_mode
from vines.dynamics.modes._jet import jet, launch
from vines.dynamics.modes._layout import R_MODAL
from vines.dynamics.modes._structure import Structure, oscillator_at
from vines.kernels import doubles_at, fused_njit, linked_njit, njit

__all__ = ["acceleration", "base", "kick", "note", "place_first"]


@fused_njit
def base(c, phase):
    """Return the displacement of the base, its velocity and its acceleration at a phase."""
    sine, cosine = sincos(phase)
    return c.A * sine, c.A * c.Omega * cosine, -c.A * c.Omega * c.Omega * sine


@linked_njit
def acceleration(c, values, first, phase):
    """Return x1'' of the structure without the ball where modes are as `values` say, from place `first` on."""
    e, rate, bend = base(c, phase)
    found = c.direct * bend
    for k in range(c.modes):
        z, z_dot = values[first + 2 * k], values[first + 1 + 2 * k]
        gamma = of_mode(c.each, k, GAMMA)
        spring = of_mode(c.each, k, STIFFNESS) * (gamma * e - z)
        found += of_mode(c.each, k, PHI) * (spring + of_mode(c.each, k, LAM) * (gamma * rate - z_dot))
    return found


@fused_njit
def kick(c, impulse, values, first):
    """Add an impulse on the structure at the cavity to the modes in `values`, from place `first` on."""
    for k in range(c.modes):
        values[first + 1 + 2 * k] += of_mode(c.each, k, PHI) * impulse


@linked_njit
def place_first(c, x1, v1, phase, values, first):
    """Write amplitude and velocity of the first mode where x1, v1 and the other modes are given."""
    e, rate, _ = base(c, phase)
    z, z_dot = x1 - c.direct * e, v1 - c.direct * rate
    for k in range(1, c.modes):
        z -= of_mode(c.each, k, PHI) * values[first + 2 * k]
        z_dot -= of_mode(c.each, k, PHI) * values[first + 1 + 2 * k]
    values[first], values[first + 1] = z / of_mode(c.each, 0, PHI), z_dot / of_mode(c.each, 0, PHI)


@linked_njit
def note(c, row):
    """Note the modes just after a row for what kernels launch from there by x1 and v1 alone."""
    noted = doubles_at(c.noted, 2 * c.modes)
    for i in range(2 * c.modes):
        noted[i] = row[R_MODAL + i]


@launched.register(ModesConstants)
@fused_njit
def _launched(c, o, x, v, v2, phase, t):
    return launch(c, o, doubles_at(c.noted, 2 * c.modes), 0, phase)


@turn.register(Structure)
@fused_njit
def _turn(o, Omega, t, x, v, a, j, k, d5, d6, fourth, bound, size, most, grows, tau):
    return jet(o, Omega, t + tau)


@derivatives.register(Structure)
@fused_njit
def _derivatives(o, Omega, t, x, v, a, j, k, d5, d6, fourth, bound, size, most, grows):
    return x, v, a, j, k


@fifth.register(Structure)
@fused_njit
def _fifth(o, t, x, v, a, j, k, d5, d6, fourth, bound, size, most, grows):
    # Who asks wants the fifth derivative or, as a modulus, what it may come to be.
    return d5, math.sqrt(max(bound * bound - d5 * d5, 0.0))


@sixth.register(Structure)
@fused_njit
def _sixth(o, t, x, v, a, j, k, d5, d6, fourth, bound, size, most, grows):
    return d6


@terms.register(Structure)
@fused_njit
def _terms(o, t, x, v, a, j, k, d5, d6, fourth, bound, size, most, grows):
    return 1.0 + size


@stays_below.register(Structure)
@fused_njit
def _stays_below(o, Omega, now, end, left, best):
    return now[11] + now[12] * left <= best


@forced_fifth.register(ModesConstants)
@fused_njit
def _forced_fifth(c, t, x, v, a, j, k, d5, d6, fourth, bound, size, most, grows):
    return max(c.free.forced, c.stuck.forced) * c.Omega5


@fourth_bound.register(ModesConstants)
@fused_njit
def _fourth_bound(c, t, x, v, a, j, k, d5, d6, fourth, bound, size, most, grows, window):
    return fourth + c.free.forced * c.Omega4 * window


@speed_terms.register(ModesConstants)
@njit
def _speed_terms(c, t, x, v, a, j, k, d5, d6, fourth, bound, size, most, grows):
    return size * 2.0 / c.window


@holds_for.register(ModesConstants)
@fused_njit
def _holds_for(c, t, x, v, a, j, k, d5, d6, fourth, bound, size, most, grows):
    return math.inf


for _name in (drift, free_ball, phase_after, pull, relative):
    _name.register(ModesConstants)(_name.first)


@ringing.register(ModesConstants)
@njit
def _ringing(c, x1, v1, v2, phase):
    noted = doubles_at(c.noted, 2 * c.modes)
    square = 0.0
    cosine, sine = math.cos(phase), math.sin(phase)
    for k in range(c.modes):
        p = oscillator_at(c.free.table, k)
        re, im = p.qr * cosine - p.qi * sine, p.qr * sine + p.qi * cosine
        away, speed = noted[2 * k] - re, noted[1 + 2 * k] + c.Omega * im
        square += away * away + speed * speed
    return math.sqrt(square)


@rate_alone.register(ModesConstants)
@njit
def _rate_alone(c, d, k):
    return 0.0 if k < 2 else of_mode(c.each, (k - 2) // 2, RATE)
