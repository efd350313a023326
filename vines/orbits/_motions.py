"""What multiple shooting asks of motions by series, for each kind of constants: rows, rates of states, steps."""

from __future__ import annotations

import math

from vines.dynamics.drag import DragConstants
from vines.dynamics.friction import FrictionConstants
from vines.dynamics.hybrid import HybridConstants
from vines.dynamics.hybrid.kernels import R_V3, R_X3, Z, accelerations, carry, expand_both, fill, of_row
from vines.dynamics.kernels import after_impact_kernel, segment_state
from vines.dynamics.kernels import rows as col
from vines.dynamics.taylor import TaylorConstants
from vines.dynamics.taylor.kernels import W, X, at, coefficients, expand, slopes
from vines.kernels import by_type, copy_values, linked_njit, njit, zero_matrix, zero_vector
from vines.orbits._budget import orbit_rows

__all__ = ["begin_at", "end_at", "impact_row", "motion", "move_on", "open_at"]

orbit_rows.register(TaylorConstants)(orbit_rows.first)

_orbit_rows_of_one = orbit_rows.first


@orbit_rows.register(HybridConstants)
@linked_njit
def _orbit_rows(c, duration, side, t, states):
    rows = _orbit_rows_of_one(c, duration, side, t, states)
    wider = zero_matrix(rows.shape[0], R_V3 + 1)
    for k in range(rows.shape[0]):
        for j in range(rows.shape[1]):
            wider[k, j] = rows[k, j]
        fill(wider[k], 0.0, states[k % t.size, 4], states[k % t.size, 5])
    return wider


@njit
def _fill_impact(c, row, side, t, x1, v1, v2):
    row[col.KIND], row[col.SIDE], row[col.TIME] = col.IMPACT, side, t
    row[col.PHASE] = (c.Omega * t) % (2.0 * math.pi)
    row[col.X1], row[col.X2] = x1, x1 - side
    row[col.V1], row[col.V2] = v1, v2
    row[col.A_V1], row[col.A_V2] = after_impact_kernel(c.law, v1, v2)


@by_type(TaylorConstants)
@linked_njit
def impact_row(c, side, t, state):
    """Return the row of an impact, from its wall, its time, and x1, v1, v2, … just before it."""
    row = zero_vector(col.ROW)
    _fill_impact(c, row, side, t, state[0], state[1], state[2])
    return row


@impact_row.register(HybridConstants)
@linked_njit
def _impact_row_beside(c, side, t, state):
    row = zero_vector(R_V3 + 1)
    _fill_impact(c, row, side, t, state[0], state[1], state[2])
    fill(row, 0.0, state[3], state[4])
    return row


@njit
def _in_flight(row, state, change, a1, a2):
    """Fill in what oscillator and ball are, and how that changes."""
    state[0], state[1], state[2], state[3] = row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2]
    change[0], change[1], change[2], change[3] = row[col.A_V1], a1, row[col.A_V2], a2


@by_type(TaylorConstants)
@linked_njit
def motion(c, row, state, change):
    """Fill in the state of a flight just after the event of a row, x1, v1, x2, v2, …, and its rate."""
    x1, v1 = row[col.X1], row[col.A_V1]
    a1, a2 = slopes(c.field, x1, v1, x1 - row[col.X2], v1 - row[col.A_V2], row[col.PHASE])
    _in_flight(row, state, change, a1, a2)


@motion.register(HybridConstants)
@linked_njit
def _motion_beside(c, row, state, change):
    x1, v1, _, _, z, y = of_row(row)
    a1, a3 = accelerations(c.field, 0.0, x1, v1, z, y, row[col.PHASE])
    _in_flight(row, state, change, a1, 0.0)
    state[4], state[5] = row[R_X3], row[R_V3]
    change[4], change[5] = row[R_V3], a3


@by_type(TaylorConstants)
@linked_njit
def move_on(c, row, tau):
    """Let a row be what it is a time tau later, at which the next event may be."""
    x1, v1, x2, v2, phase = segment_state(c, row, tau)
    row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2], row[col.PHASE] = x1, v1, x2, v2, phase


move_on.register(DragConstants)(move_on.first)
move_on.register(FrictionConstants)(move_on.first)


@move_on.register(HybridConstants)
@linked_njit
def _move_on_beside(c, row, tau):
    carry(c, row, tau)


@segment_state.register(HybridConstants)
@linked_njit
def _segment_state(c, row, tau):
    here = zero_vector(row.shape[0])
    copy_values(here, row)
    carry(c, here, tau)
    return here[col.X1], here[col.A_V1], here[col.X2], here[col.A_V2], here[col.PHASE]


@by_type(TaylorConstants)
@njit
def begin_at(c, row):
    """Return where the first step of the flight after an impact begins."""
    v = row[col.A_V1]
    # On a wall the gap is exact; at phase 0 of a motion without impacts it is what the positions say.
    w = row[col.SIDE] if row[col.SIDE] != 0.0 else row[col.X1] - row[col.X2]
    return row[col.X1], v, w, v - row[col.A_V2]


@begin_at.register(HybridConstants)
@njit
def _begin_beside(c, row):
    x, v, _, u, z, y = of_row(row)
    return x, v, row[col.SIDE], u, z, y


@by_type(TaylorConstants)
@njit
def open_at(c, here, phase):
    """Expand the series of a step from where it begins; return its length."""
    x, v, w, u = here
    return expand(c.field, x, v, w, u, phase)


@open_at.register(HybridConstants)
@njit
def _open_beside(c, here, phase):
    x, v, w, u, z, y = here
    return expand_both(c.field, 0.0, x, v, w, u, z, y, phase)


@by_type(TaylorConstants)
@njit
def end_at(c, h):
    """Return where the step ends that the room holds."""
    a, order = coefficients(c.field), c.field.order
    x, v = at(a, X, order, h)
    w, u = at(a, W, order, h)
    return x, v, w, u


@end_at.register(HybridConstants)
@njit
def _end_beside(c, h):
    a, order = coefficients(c.field), c.field.order
    x, v = at(a, X, order, h)
    w, u = at(a, W, order, h)
    z, y = at(a, Z, order, h)
    return x, v, w, u, z, y
