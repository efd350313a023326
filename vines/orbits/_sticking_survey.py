"""One pass over the events of a closed orbit that sticks: Jacobians, and how far it is from ceasing to be one."""

from __future__ import annotations

import math

from vines.dynamics.kernels import (
    after_impact_kernel,
    derivatives,
    flight,
    flow_basis,
    free_ball,
    jump_basis,
    pull,
    turn,
)
from vines.dynamics.kernels import rows as col
from vines.kernels import copy_values, linked_njit, new_cube, new_matrix, njit, zero_matrix
from vines.orbits._sticking_map import force_slope
from vines.orbits._survey import NO_TURNING
from vines.orbits._turning import turning_points_kernel

__all__ = ["FALLS", "LEAST_FORCE", "RESOLVED", "SLOWEST", "least_force", "round_turnings", "survey_sticking"]

SLOWEST, LEAST_FORCE, FALLS = range(3)
"""Margins of a spell: least speed of an impact of its chatter that a faster one follows; least contact force at a
minimum within the spell; rate at which the force falls at the release. The first two are inf where there is none."""

_SHORT = 1e-4
"""Flights shorter than this turn once, away from the wall, and their end at an impact is certain."""

RESOLVED = 1e-4
"""Speed of an impact beside which one before it counts as slow: the last ones of a chatter are in order to rounding."""

_PARTS = 64
"""Parts of a spell in which a minimum of the contact force is looked for."""


@linked_njit
def round_turnings(c, rows):
    """Return all turning points of the flights of a round: row, time since it, wall it points at, clearance, w''.

    Parameters
    ----------
    c : vines.dynamics._constants.Constants
    rows : (M, ROW) float array

    Returns
    -------
    ndarray, shape (k, 5)
    """
    found = []
    for i in range(rows.shape[0] - 1):
        row, tau = rows[i], rows[i + 1, col.TAU]
        if row[col.MODE] != 0.0 or tau <= _SHORT:
            continue
        motion = flight(c, c.free, row[col.X1], row[col.A_V1], row[col.PHASE], 0.0)
        for at in turning_points_kernel(c, motion, row[col.A_V2], tau):
            if at < _SHORT:
                # Just after a release the ball has hardly left the wall, and rounding turns it.
                continue
            x, _, a, _, _ = derivatives(c.free, c.Omega, *turn(c.free, c.Omega, *motion, at))
            way, _ = free_ball(c, row[col.A_V2], at)
            wall = 1.0 if pull(c, a) < 0.0 else -1.0
            found.append((float(i), at, wall, 1.0 - wall * (x - (row[col.X2] + way)), a))
    out = new_matrix(len(found), 5)
    for i in range(len(found)):
        for k in range(5):
            out[i, k] = found[i][k]
    return out


@njit
def _force(c, side, motion, tau):
    """Return the contact force of a spell at tau and its derivative."""
    _, _, a, j, _ = derivatives(c.stuck, c.Omega, *turn(c.stuck, c.Omega, *motion, tau))
    return (1.0 + c.mu) * side * a, (1.0 + c.mu) * side * j


@linked_njit
def least_force(c, row, tau):
    """Return the least contact force at a minimum within a spell, inf if it has none, and when it is."""
    side = row[col.MODE]
    motion = flight(c, c.stuck, row[col.X1], row[col.A_V1], row[col.PHASE], 0.0)
    least, when = math.inf, math.nan
    before = _force(c, side, motion, 0.0)[1]
    for k in range(1, _PARTS + 1):
        here = _force(c, side, motion, tau * k / _PARTS)[1]
        if before < 0.0 <= here:
            low, high = tau * (k - 1) / _PARTS, tau * k / _PARTS
            for _ in range(60):
                middle = 0.5 * (low + high)
                if _force(c, side, motion, middle)[1] < 0.0:
                    low = middle
                else:
                    high = middle
            force = _force(c, side, motion, 0.5 * (low + high))[0]
            if force < least:
                least, when = force, 0.5 * (low + high)
        before = here
    return least, when


@njit
def _just_after(c, row, Y):
    """Fill Y with the disturbances just after an impact, at its time, by those of (v1, v2, x2, t) just before it."""
    after1, after2 = row[col.A_V1], row[col.A_V2]
    motion = flight(c, c.free, row[col.X1], after1, row[col.PHASE], 0.0)
    _, _, a, _, _ = derivatives(c.free, c.Omega, *motion)
    Y[0, 2] = Y[2, 2] = 1.0
    Y[1, 0], Y[3, 0] = after_impact_kernel(c.law, 1.0, 0.0)
    Y[1, 1], Y[3, 1] = after_impact_kernel(c.law, 0.0, 1.0)
    Y[0, 3], Y[1, 3], Y[2, 3] = -after1, -a, -after2


@njit
def _to_contact(c, rows, first, last, J):
    """Fill J with the Jacobian in (v1, v2, x2, t) from just before one contact to just before another."""
    Y = zero_matrix(4, 4)
    _just_after(c, rows[first], Y)
    for i in range(first + 1, last):
        flow_basis(c, rows[i - 1, col.MODE], rows[i, col.TAU], Y)
        jump_basis(c, rows[i], Y)
    flow_basis(c, rows[last - 1, col.MODE], rows[last, col.TAU], Y)
    row = rows[last]
    motion = flight(c, c.free, row[col.X1], row[col.V1], row[col.PHASE], 0.0)
    _, _, a, _, _ = derivatives(c.free, c.Omega, *motion)
    for j in range(4):
        shift = (Y[0, j] - Y[2, j]) / (row[col.V1] - row[col.V2])
        J[0, j] = Y[1, j] - a * shift
        J[1, j] = Y[3, j]
        J[2, j] = Y[2, j] - row[col.V2] * shift
        J[3, j] = -shift


@linked_njit
def survey_sticking(c, rows, contacts, spells):
    """Survey a closed orbit, given by its events.

    Parameters
    ----------
    c : vines.dynamics._constants.Constants
    rows : (M, ROW) float array
        Two periods, from a release on.
    contacts : (N + 1,) int array
        Rows of the contacts of a period, of a chatter the first impact, and of the first one of the next.
    spells : (K, 3) float array
        Filled with the margins of each spell of a period, in order of time.

    Returns
    -------
    (jacobians, clearance)
        Jacobians from each contact to the next, shape (N, 4, 4), and the least distance of a turning point to the wall
        that it points at.
    """
    N = contacts.shape[0] - 1
    jacobians = new_cube(N, 4, 4)
    J = zero_matrix(4, 4)
    for k in range(N):
        _to_contact(c, rows, contacts[k], contacts[k + 1], J)
        for i in range(4):
            copy_values(jacobians[k, i], J[i])
    clearance = NO_TURNING
    turnings = round_turnings(c, rows[contacts[0] : contacts[N] + 1])
    for k in range(turnings.shape[0]):
        clearance = min(clearance, turnings[k, 3])
    spell = 0
    for i in range(contacts[0], contacts[N]):
        if rows[i, col.MODE] == 0.0:
            continue
        if rows[i, col.KIND] != col.STICK:
            continue
        fastest, slowest = 0.0, math.inf
        j = i - 1
        for _ in range(int(rows[i, col.RUN])):
            while rows[j, col.KIND] != col.IMPACT:
                j -= 1
            speed = abs(rows[j, col.V1] - rows[j, col.V2])
            if speed < fastest and fastest > RESOLVED:
                slowest = min(slowest, speed)
            fastest = max(fastest, speed)
            j -= 1
        ends = i + 1
        while rows[ends, col.KIND] != col.RELEASE:
            ends += 1
        spells[spell, SLOWEST] = slowest
        spells[spell, LEAST_FORCE], _ = least_force(c, rows[i], rows[ends, col.TIME] - rows[i, col.TIME])
        spells[spell, FALLS] = abs(force_slope(c, rows[ends, col.PHASE]) - rows[ends, col.V1])
        spell += 1
    return jacobians, clearance
