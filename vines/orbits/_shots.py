"""Flights of an orbit by series: where each ends, how that depends on where it begins, and whether it is admissible."""

from __future__ import annotations

import math

from vines.dynamics.kernels import after_impact_kernel, carry_basis, segment_state
from vines.dynamics.kernels import rows as col
from vines.dynamics.taylor import TaylorConstants
from vines.dynamics.taylor.kernels import W, X, at, bounds, coefficients, derivatives_at, expand, slopes
from vines.kernels import entry_njit, identity, linked_njit, new_matrix, njit, zero_vector
from vines.orbits._budget import orbit_rows
from vines.orbits._survey import NO_TURNING, inspect_row, survey_kernel, survey_rows
from vines.orbits._turnings_of_balls import gap_kernel, turnings_kernel

__all__ = ["shots_kernel", "turnings"]

orbit_rows.register(TaylorConstants)(orbit_rows.first)

THIN = 2.0**-20
"""Part of a step below which w is called flat where neither its velocity nor its acceleration keeps a sign."""


@njit
def _row_after(c, row, side, t, x1, v1, v2):
    """Fill a row with the state just after an impact."""
    row[col.KIND], row[col.SIDE], row[col.TIME] = col.IMPACT, side, t
    row[col.PHASE] = (c.Omega * t) % (2.0 * math.pi)
    row[col.X1], row[col.X2] = x1, x1 - side
    row[col.V1], row[col.V2] = v1, v2
    row[col.A_V1], row[col.A_V2] = after_impact_kernel(c.law, v1, v2)


@entry_njit
def shots_kernel(c, sign, span, side, t, states, defect, slope):
    """Fly from each impact to the time of the next one, the last to the first of the repetition `span` later.

    Parameters
    ----------
    c : TaylorConstants
    sign : float
        -1 where the repetition is the mirror image, else 1.
    span : float
    side : (n,) int array
    t : (n,) float array
        Times of the impacts.
    states : (n, 3) float array
        x1, v1, v2 just before them.
    defect : (4 n,) float array
        Filled with x1, v1, x2, v2 at the ends of the flights less those of the next impacts.
    slope : (4 n, 4 n) float array
        Filled with its derivatives in the times, then in all x1, all v1, all v2.
    """
    n = t.size
    row = zero_vector(col.ROW)
    # The law of impact is linear: what it makes of each velocity alone.
    first, second = after_impact_kernel(c.law, 1.0, 0.0), after_impact_kernel(c.law, 0.0, 1.0)
    for i in range(4 * n):
        for k in range(4 * n):
            slope[i, k] = 0.0
    for j in range(n):
        k = (j + 1) % n
        turned = sign if k == 0 else 1.0
        x1, v1, v2 = states[j, 0], states[j, 1], states[j, 2]
        _row_after(c, row, side[j], t[j], x1, v1, v2)
        tau = (t[0] + span if k == 0 else t[k]) - t[j]
        Y = identity(4)
        a1, a2 = slopes(c.field, x1, row[col.A_V1], 1.0 * side[j], row[col.A_V1] - row[col.A_V2], row[col.PHASE])
        before = row[col.A_V1], a1, row[col.A_V2], a2
        carry_basis(c, row, tau, Y)
        e1, e2, e3, e4, phase = segment_state(c, row, tau)
        b1, b2 = slopes(c.field, e1, e2, e1 - e3, e2 - e4, phase)
        end = e1, e2, e3, e4
        after = e2, b1, e4, b2
        x, v, w = turned * states[k, 0], turned * states[k, 1], turned * states[k, 2]
        goal = x, v, x - turned * side[k], w
        for i in range(4):
            at_row = 4 * j + i
            defect[at_row] = end[i] - goal[i]
            moved = 0.0
            for m in range(4):
                moved += Y[i, m] * before[m]
            slope[at_row, j] -= moved
            slope[at_row, k] += after[i]
            slope[at_row, n + j] += Y[i, 0] + Y[i, 2]
            slope[at_row, 2 * n + j] += first[0] * Y[i, 1] + first[1] * Y[i, 3]
            slope[at_row, 3 * n + j] += second[0] * Y[i, 1] + second[1] * Y[i, 3]
        slope[4 * j, n + k] -= turned
        slope[4 * j + 2, n + k] -= turned
        slope[4 * j + 1, 2 * n + k] -= turned
        slope[4 * j + 3, 3 * n + k] -= turned


@linked_njit
def _crossing(c, row, side, inside, outside):
    """Return the time after a row, in [inside, outside], at which a gap that only grows passes a barrier."""
    while True:
        middle = 0.5 * (inside + outside)
        if not inside < middle < outside:
            return outside
        x1, _, x2, _, _ = segment_state(c, row, middle)
        if side * (x1 - x2) < 1.0:
            inside = middle
        else:
            outside = middle


@linked_njit
def _turning(a, order, low, high):
    """Return where w' vanishes between two times, -1 where its sign does not change."""
    below = at(a, W, order, low)[1]
    if below * at(a, W, order, high)[1] > 0.0:
        return -1.0
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return middle
        if at(a, W, order, middle)[1] * below > 0.0:
            low = middle
        else:
            high = middle


@linked_njit
def turnings(c, row, tau):
    """Return the turning points of the gap in the flight after a row: time since then, w, w''."""
    f = c.field
    a = coefficients(f)
    order = f.order
    found = []
    x, v = row[col.X1], row[col.A_V1]
    # On a wall the gap is exact; at phase 0 of a motion without impacts it is what the positions say.
    w, u = row[col.SIDE] if row[col.SIDE] != 0.0 else x - row[col.X2], v - row[col.A_V2]
    done = 0.0
    while done < tau:
        h = min(expand(f, x, v, w, u, row[col.PHASE] + f.Omega * done), tau - done)
        _, third, _ = bounds(a, W, order, h)
        s, width = 0.0, h
        while s < h:
            width = min(width, h - s)
            half = 0.5 * width
            _, speed, curve, _, _, _, _ = derivatives_at(a, W, order, s + half)
            if abs(speed) <= half * (abs(curve) + half * third):
                if abs(curve) <= third * half and width > THIN * h:
                    width = half
                    continue
                place = _turning(a, order, s, s + width)
                if done + place > 0.0 and place >= 0.0:
                    here, _, bend, _, _, _, _ = derivatives_at(a, W, order, place)
                    found.append((done + place, here, bend))
            s += width
            width *= 2.0
        x, v = at(a, X, order, h)
        w, u = at(a, W, order, h)
        done += h
    return found


@inspect_row.register(TaylorConstants)
@linked_njit
def _inspect_row(c, side, row, tau):
    clearance, violation, wall = NO_TURNING, math.nan, 0
    if side * (row[col.A_V1] - row[col.A_V2]) > 0.0:
        violation, wall = 0.0, side
    before = 0.0
    for when, w, bend in turnings(c, row, tau):
        towards = 1 if bend < 0.0 else -1
        clearance = min(clearance, 1.0 - towards * w)
        if towards * w >= 1.0 and wall == 0:
            wall, violation = towards, _crossing(c, row, towards, before, when)
        before = when
    return clearance, violation, wall


@linked_njit
def _rows(c, duration, side, t, states):
    """Return the rows of an orbit, each with its wall."""
    rows = orbit_rows(c, duration, side, t, states)
    rows[0, col.SIDE] = side[0]
    return rows


@gap_kernel.register(TaylorConstants)
@entry_njit
def _gap_kernel(c, duration, side, t, states, place, number, tau):
    x1, v1, x2, v2, phase = segment_state(c, _rows(c, duration, side, t, states)[place], tau)
    a1, a2 = slopes(c.field, x1, v1, x1 - x2, v1 - v2, phase)
    return x1 - x2, v1 - v2, a1 - a2


@turnings_kernel.register(TaylorConstants)
@entry_njit
def _turnings_kernel(c, duration, side, t, states):
    rows = _rows(c, duration, side, t, states)
    found = []
    for j in range(side.size):
        for when, w, bend in turnings(c, rows[j], rows[j + 1, col.TAU]):
            wall = 1.0 if bend < 0.0 else -1.0
            found.append((float(j), when, wall, 1.0 - wall * w, bend, 1.0))
    out = new_matrix(len(found), 6)
    for i in range(len(found)):
        for k in range(6):
            out[i, k] = found[i][k]
    return out


@survey_kernel.register(TaylorConstants)
@linked_njit
def _survey(c, duration, side, t, states):
    return survey_rows(c, _rows(c, duration, side, t, states), side)
