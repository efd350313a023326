"""Flights of an orbit by series: where each ends, how that depends on where it begins, and whether it is admissible."""

from __future__ import annotations

import math

from vines.dynamics.hybrid import HybridConstants
from vines.dynamics.kernels import after_impact_kernel, carry_basis, directions, segment_state
from vines.dynamics.kernels import rows as col
from vines.dynamics.taylor import TaylorConstants
from vines.dynamics.taylor.kernels import W, at, bounds, coefficients, derivatives_at
from vines.kernels import copy_values, entry_njit, identity, linked_njit, new_matrix, zero_vector
from vines.orbits._budget import orbit_rows
from vines.orbits._motions import begin_at, end_at, impact_row, motion, move_on, open_at
from vines.orbits._survey import NO_TURNING, inspect_row, survey_kernel, survey_rows
from vines.orbits._turnings_of_balls import gap_kernel, turnings_kernel

__all__ = ["KINDS", "shots_kernel", "turnings"]

KINDS = (TaylorConstants, HybridConstants)
"""Constants of systems whose flights have no closed form."""

THIN = 2.0**-20
"""Part of a step below which w is called flat where neither its velocity nor its acceleration keeps a sign."""


@entry_njit
def shots_kernel(c, sign, span, side, t, states, defect, slope):
    """Fly from each impact to the time of the next one, the last to the first of the repetition `span` later.

    Parameters
    ----------
    c : TaylorConstants, HybridConstants
    sign : float
        -1 where the repetition is the mirror image, else 1.
    span : float
    side : (n,) int array
    t : (n,) float array
        Times of the impacts.
    states : (n, d - 1) float array
        x1, v1, v2 just before them, and position and velocity of a mass beside the ball.
    defect : (d n,) float array
        Filled with x1, v1, x2, v2, … at the ends of the flights less those of the next impacts.
    slope : (d n, d n) float array
        Filled with its derivatives in the times, then in all x1, all v1, all v2, ….
    """
    n, d = t.size, len(directions(c))
    begin, before, end, after, goal = zero_vector(d), zero_vector(d), zero_vector(d), zero_vector(d), zero_vector(d)
    # The law of impact is linear: what it makes of each velocity alone.
    first, second = after_impact_kernel(c.law, 1.0, 0.0), after_impact_kernel(c.law, 0.0, 1.0)
    for i in range(d * n):
        for k in range(d * n):
            slope[i, k] = 0.0
    for j in range(n):
        k = (j + 1) % n
        turned = sign if k == 0 else 1.0
        row = impact_row(c, side[j], t[j], states[j])
        tau = (t[0] + span if k == 0 else t[k]) - t[j]
        Y = identity(d)
        motion(c, row, begin, before)
        carry_basis(c, row, tau, Y)
        move_on(c, row, tau)
        motion(c, row, end, after)
        for i in range(d):
            # Of what stands before an impact x2 follows from the wall.
            goal[i] = turned * states[k, i if i < 2 else i - 1]
        goal[2] = goal[0] - turned * side[k]
        for i in range(d):
            at_row = d * j + i
            defect[at_row] = end[i] - goal[i]
            moved = 0.0
            for m in range(d):
                moved += Y[i, m] * before[m]
            slope[at_row, j] -= moved
            slope[at_row, k] += after[i]
            slope[at_row, n + j] += Y[i, 0] + Y[i, 2]
            slope[at_row, 2 * n + j] += first[0] * Y[i, 1] + first[1] * Y[i, 3]
            slope[at_row, 3 * n + j] += second[0] * Y[i, 1] + second[1] * Y[i, 3]
            for m in range(4, d):
                slope[at_row, m * n + j] += Y[i, m]
        slope[d * j + 2, n + k] -= turned
        for i in range(d):
            if i != 2:
                slope[d * j + i, (i + 1 if i < 2 else i) * n + k] -= turned


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
    a = coefficients(c.field)
    order = c.field.order
    found = []
    here = begin_at(c, row)
    done = 0.0
    while done < tau:
        h = min(open_at(c, here, row[col.PHASE] + c.Omega * done), tau - done)
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
        here = end_at(c, h)
        done += h
    return found


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


@entry_njit
def _gap_kernel(c, duration, side, t, states, place, number, tau):
    row = _rows(c, duration, side, t, states)[place]
    here, change = zero_vector(len(directions(c))), zero_vector(len(directions(c)))
    move_on(c, row, tau)
    motion(c, row, here, change)
    return here[0] - here[2], here[1] - here[3], change[1] - change[3]


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


@linked_njit
def _survey(c, duration, side, t, states):
    rows = _rows(c, duration, side, t, states)
    jacobians, residual, clearance, violation, wall = survey_rows(c, rows, side)
    here = zero_vector(rows.shape[1])
    # What a row has at its end is position and velocity of a mass beside the ball.
    for j in range(side.size if len(directions(c)) > 4 else 0):
        copy_values(here, rows[j])
        move_on(c, here, rows[j + 1, col.TAU])
        for k in range(rows.shape[1] - 2, rows.shape[1]):
            residual = max(residual, abs(here[k] - rows[j + 1, k]))
    return jacobians, residual, clearance, violation, wall


for _kind in KINDS:
    inspect_row.register(_kind)(_inspect_row)
    gap_kernel.register(_kind)(_gap_kernel)
    turnings_kernel.register(_kind)(_turnings_kernel)
    survey_kernel.register(_kind)(_survey)
