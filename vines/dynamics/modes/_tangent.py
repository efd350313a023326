"""Disturbances of (x1, v1, x2, v2) and of each mode from the second on, at fixed time.

As the base moves as it does, those of x1 and v1 are sums over the modes; between events they are carried mode by mode.
"""

from __future__ import annotations

from vines.dynamics._advance import IMPACT, KIND, PHASE, STICK, V1, V2
from vines.dynamics._flight import decay
from vines.dynamics._impact_law import after_impact_kernel
from vines.dynamics._sincos import sincos
from vines.dynamics._tangent import carry_basis, directions, flow_basis, jump_basis, swing_of
from vines.dynamics.modes._constants import LAM, PHI, ModesConstants, of_mode
from vines.dynamics.modes._layout import R_MODAL
from vines.dynamics.modes._motion import acceleration
from vines.dynamics.modes._structure import oscillator_at
from vines.kernels import doubles_at, linked_njit, njit, zero_vector

__all__: list[str] = []

carry_basis.register(ModesConstants)(carry_basis.first)


@directions.register(ModesConstants)
@njit
def _directions(c):
    return range(2 + 2 * c.modes)


@njit
def _place(k):
    """Return where a disturbance has the amplitude of mode k, which stands for x1 where k is 0."""
    return 2 * k + 2 if k > 0 else 0


@linked_njit
def _to_modes(c, Y, sign):
    """Put the first mode in the place of x1, with sign -1, or x1 back in the place of the first mode, with sign 1."""
    own = of_mode(c.each, 0, PHI)
    for i in range(2):
        for j in range(Y.shape[1]):
            others = 0.0
            for k in range(1, c.modes):
                others += of_mode(c.each, k, PHI) * Y[_place(k) + i, j]
            Y[i, j] = own * Y[i, j] + others if sign > 0.0 else (Y[i, j] - others) / own


@linked_njit
def _swing(c, tau, Y):
    """Carry the disturbances of all modes of the structure alone."""
    for k in range(c.modes):
        p = oscillator_at(c.free.table, k)
        at = _place(k)
        sine, cosine = swing_of(p, tau)
        for j in range(Y.shape[1]):
            z, z_dot = Y[at, j], Y[at + 1, j]
            Y[at, j] = (cosine + p.half * sine) * z + sine * z_dot
            Y[at + 1, j] = -p.stiffness * sine * z + (cosine - p.half * sine) * z_dot


@linked_njit
def _swing_loaded(c, tau, Y):
    """Carry the disturbances of all modes with the ball riding on the structure."""
    o = c.stuck
    n = 2 * o.n
    to, back = doubles_at(o.to, (n + 1) * n), doubles_at(o.back, n * (o.n + 1) * 2)
    own = zero_vector(n)
    for j in range(Y.shape[1]):
        for i in range(n):
            own[i] = 0.0
        for m in range(o.n):
            p = oscillator_at(o.table, m)
            at = 2 * (n + 1) * m
            re = im = 0.0
            for k in range(o.n):
                for i in range(2):
                    re += to[at + 2 * (2 * k + i)] * Y[_place(k) + i, j]
                    im += to[at + 2 * (2 * k + i) + 1] * Y[_place(k) + i, j]
            size = decay(p.half * tau)
            sine, cosine = sincos(p.gamma * tau)
            re, im = size * (re * cosine - im * sine), size * (re * sine + im * cosine)
            for i in range(n):
                at = 2 * (o.n + 1) * i + 2 * m
                own[i] += back[at] * re - back[at + 1] * im
        for k in range(o.n):
            Y[_place(k), j], Y[_place(k) + 1, j] = own[2 * k], own[2 * k + 1]


@flow_basis.register(ModesConstants)
@linked_njit
def _flow_basis(c, mode, tau, Y):
    _to_modes(c, Y, -1.0)
    if mode != 0.0:
        _swing_loaded(c, tau, Y)
    else:
        _swing(c, tau, Y)
    _to_modes(c, Y, 1.0)
    for j in range(Y.shape[1]):
        if mode != 0.0:
            Y[2, j], Y[3, j] = Y[0, j], Y[1, j]
        else:
            Y[2, j] += tau * Y[3, j]


@jump_basis.register(ModesConstants)
@linked_njit
def _jump_basis(c, row, Y):
    if row[KIND] == IMPACT:
        v1, v2 = row[V1], row[V2]
        after1, after2 = after_impact_kernel(c.law, v1, v2)
        impulse = -c.mu * (after2 - v2)
        damped = 0.0
        for k in range(c.modes):
            damped += of_mode(c.each, k, LAM) * of_mode(c.each, k, PHI) * of_mode(c.each, k, PHI)
        a = acceleration(c, row, R_MODAL, row[PHASE]) + damped * impulse
        closing = v1 - v2
        for j in range(Y.shape[1]):
            # The disturbed run hits earlier by `shift`; before that it has the one motion, after it the other.
            shift = (Y[0, j] - Y[2, j]) / closing if closing != 0.0 else 0.0
            w1, w2 = Y[1, j] - a * shift, Y[3, j]
            more1, more2 = after_impact_kernel(c.law, w1, w2)
            _push(c, impulse * shift, -c.mu * (more2 - w2), Y, j)
            Y[0, j] += (after1 - v1) * shift
            Y[1, j] = more1 + (a - damped * impulse) * shift
            Y[2, j] += (after2 - v2) * shift
            Y[3, j] = more2
    elif row[KIND] == STICK:
        damped = 0.0
        for k in range(c.modes):
            damped += of_mode(c.each, k, LAM) * of_mode(c.each, k, PHI) * of_mode(c.each, k, PHI)
        share = c.mu / (1.0 + c.law.ratio)
        for j in range(Y.shape[1]):
            # What is left of the chatter closes the gap of a disturbed run, and the dampers act meanwhile.
            moved = -share * (Y[0, j] - Y[2, j])
            pushed = -share * (Y[1, j] - Y[3, j] - damped * moved)
            _push(c, moved, pushed, Y, j)
            Y[0, j] += c.mobility * moved
            Y[1, j] += c.mobility * pushed - damped * moved
            Y[2, j], Y[3, j] = Y[0, j], Y[1, j]


@njit
def _push(c, moved, pushed, Y, j):
    """Displace the modes from the second on as an impulse at the cavity does, and its moment; dampers act on that."""
    for k in range(1, c.modes):
        phi = of_mode(c.each, k, PHI)
        Y[_place(k), j] += phi * moved
        Y[_place(k) + 1, j] += phi * (pushed - of_mode(c.each, k, LAM) * moved)
