"""What the closing equations need to know of a structure of several modes: a kick is answered by their sum."""

from __future__ import annotations

import math

from vines.dynamics.kernels import after_impact_kernel, segment_state
from vines.dynamics.kernels import rows as col
from vines.dynamics.modes import ModesConstants
from vines.dynamics.modes.kernels import BALL, BEFORE, PHI, R_MODAL, modal_at, note, of_mode, of_row, oscillator_at
from vines.kernels import linked_njit, njit, zero_matrix
from vines.orbits._budget import orbit_rows
from vines.orbits._chains import ball_of, chain_closing, gravity, response, response_of, steady, steady_of
from vines.orbits._equations import closing_kernel, closing_unit, prepared
from vines.orbits._motions import move_on
from vines.orbits._survey import inspect_row, survey_kernel, survey_rows
from vines.orbits._turnings_of_balls import gap_kernel, rides, turnings_kernel

__all__: list[str] = []

_rows_of_one = orbit_rows.first
_inspected = inspect_row.first


@prepared.register(ModesConstants)
@njit
def _prepared(c):
    return c


@closing_unit.register(ModesConstants)
@njit
def _closing_unit(c):
    size = abs(c.direct) * c.A
    for k in range(c.modes):
        o = oscillator_at(c.free.table, k)
        size += abs(of_mode(c.each, k, PHI)) * math.hypot(o.qr, o.qi)
    return 1.0, 1.0 + size


closing_kernel.register(ModesConstants)(chain_closing)


@steady.register(ModesConstants)
@njit
def _steady(c, t):
    sine, cosine = math.sin(c.Omega * t), math.cos(c.Omega * t)
    x = c.direct * c.A * sine
    v, a = c.direct * c.A * c.Omega * cosine, -c.Omega * c.Omega * x
    for k in range(c.modes):
        phi = of_mode(c.each, k, PHI)
        xk, vk, ak = steady_of(oscillator_at(c.free.table, k), c.Omega, t)
        x += phi * xk
        v += phi * vk
        a += phi * ak
    return x, v, a


@response.register(ModesConstants)
@njit
def _response(c, duration, tau):
    x = v = a = 0.0
    for k in range(c.modes):
        phi = of_mode(c.each, k, PHI)
        xk, vk, ak = response_of(oscillator_at(c.free.table, k), duration, tau)
        # A kick that changes the velocity of the cavity by 1.
        share = phi * phi / c.mobility
        x += share * xk
        v += share * vk
        a += share * ak
    return x, v, a


@ball_of.register(ModesConstants)
@njit
def _ball_of(c, number):
    return c.law.pass1, c.law.pass2, c.law.keep2, 1.0


@gravity.register(ModesConstants)
@njit
def _gravity(c):
    return 0.0


@orbit_rows.register(ModesConstants)
@linked_njit
def _orbit_rows(c, duration, side, t, states):
    N = t.size
    own = _rows_of_one(c, duration, side, t, states)
    rows = zero_matrix(N + 1, R_MODAL + 2 * c.modes)
    for i in range(N + 1):
        for j in range(col.ROW):
            rows[i, j] = own[i, j]
        rows[i, BALL] = 1.0
        rows[i, BEFORE] = 0.0
    # Each mode is its steady motion with what all kicks have made of it, the one just given among them.
    for k in range(c.modes):
        o = oscillator_at(c.free.table, k)
        share = of_mode(c.each, k, PHI) / c.mobility
        for j in range(N):
            z, z_dot, _ = steady_of(o, c.Omega, t[j])
            for i in range(N):
                tau = t[j] - t[i] if i <= j else t[j] - t[i] + duration
                after, _ = after_impact_kernel(c.law, states[i, 1], states[i, 3])
                x, v, _ = response_of(o, duration, tau)
                z += share * (after - states[i, 1]) * x
                z_dot += share * (after - states[i, 1]) * v
            rows[j, R_MODAL + 2 * k], rows[j, R_MODAL + 1 + 2 * k] = z, z_dot
        rows[N, R_MODAL + 2 * k], rows[N, R_MODAL + 1 + 2 * k] = rows[0, R_MODAL + 2 * k], rows[0, R_MODAL + 1 + 2 * k]
    return rows


@move_on.register(ModesConstants)
@linked_njit
def _move_on(c, row, tau):
    x1, v1, x2, v2, phase = segment_state(c, row, tau)
    o, _ = of_row(c, row)
    modal_at(c, o, tau, row, R_MODAL)
    row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2], row[col.PHASE] = x1, v1, x2, v2, phase


@rides.register(ModesConstants)
@njit
def _rides(c, row, number):
    # Who asks launches from this row.
    note(c, row)
    return row[col.X2], row[col.A_V2]


@inspect_row.register(ModesConstants)
@njit
def _inspect_row(c, side, row, tau):
    note(c, row)
    return _inspected(c, side, row, tau)


gap_kernel.register(ModesConstants)(gap_kernel.first)
turnings_kernel.register(ModesConstants)(turnings_kernel.first)


@survey_kernel.register(ModesConstants)
@linked_njit
def _survey(c, duration, side, t, states):
    return survey_rows(c, orbit_rows(c, duration, side, t, states), side)
