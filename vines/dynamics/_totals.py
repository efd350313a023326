"""Totals over a window of a run: one pass over its rows, every segment in closed form."""

from __future__ import annotations

import numpy as np

from vines.dynamics._advance import (
    A_V1,
    A_V2,
    IMPACT,
    KIND,
    MODE,
    PHASE,
    SIDE,
    STICK,
    TAU,
    TIME,
    V1,
    V2,
    X1,
    X2,
)
from vines.dynamics._constants import Constants
from vines.dynamics._flight import ball_flown, derivatives, flown, launched, phase_after, phasors, turn
from vines.dynamics._integrals import energies_between, peak_between, segment_integrals
from vines.kernels import by_type, entry_njit, linked_njit, njit, zero_matrix, zero_vector

__all__ = [
    "accumulate",
    "add_integrals",
    "add_segment",
    "add_window",
    "ball_mass",
    "base_at",
    "count_event",
    "event_loss",
    "event_work",
    "segment_state",
    "state_energy",
    "stored_energy",
    "window_totals",
]

# Entries of the totals of a window.
(
    DURATION,
    X1_SQUARE,
    V1_SQUARE,
    V2_SQUARE,
    BASE_WORK,
    DAMPER_LOSS,
    LOSS_LEFT,
    LOSS_RIGHT,
    IMPACTS_LEFT,
    IMPACTS_RIGHT,
    STICKS_LEFT,
    STICKS_RIGHT,
    MAX_ABS_X1,
    T_MAX_ABS_X1,
    ENERGY_CHANGE,
    TRAVEL_LOSS,
) = range(16)
TOTALS = 16


@by_type(Constants)
@linked_njit
def segment_state(c, row, tau):
    """Return (x1, v1, x2, v2, phase) at time tau after a row, before the next one."""
    mode = row[MODE]
    o = c.stuck if mode != 0.0 else c.free
    motion = launched(c, o, row[X1], row[A_V1], row[A_V2], row[PHASE], row[TIME])
    x1, v1, _, _, _ = derivatives(o, c.Omega, *flown(c, o, motion, tau))
    phase = phase_after(c, row[PHASE], c.Omega * tau, row[TIME], row[TIME] + tau)
    if mode != 0.0:
        return x1, v1, x1 - mode, v1, phase
    way, v2 = ball_flown(c, motion, row[A_V2], tau)
    return x1, v1, row[X2] + way, v2, phase


@by_type(Constants)
@njit
def base_at(c, phase):
    """Return the displacement of the base at a phase of the forcing."""
    return c.A * np.sin(phase)


@by_type(Constants)
@njit
def ball_mass(c):
    """Return the mass of the ball in the unit of energies and of ratios of masses."""
    return c.mu


@njit
def state_energy(c, x1, v1, v2, phase):
    """Return the energy of mass, ball and spring, in units of M b^2 omega0^2."""
    stretch = x1 - base_at(c, phase)
    return 0.5 * (v1 * v1 + c.mu * v2 * v2 + stretch * stretch)


@by_type(Constants)
@njit
def stored_energy(c, x1, v1, x2, v2, phase):
    """Return the same of all that a system stores."""
    return state_energy(c, x1, v1, v2, phase)


@by_type(Constants)
@njit
def event_work(c, row):
    """Return the work of the base at a row: none on a system whose base acts through a spring."""
    return 0.0


@by_type(Constants)
@njit
def event_loss(c, row):
    """Return the energy lost at a row, from the relative velocities just before and after (impact or merge)."""
    before = row[V1] - row[V2]
    after = row[A_V1] - row[A_V2]
    return 0.5 * c.mu / (1.0 + c.mu) * (before - after) * (before + after)


@njit
def count_event(c, out, row):
    """Add an impact or a merge, and what it costs, to the totals."""
    left = row[SIDE] > 0.0
    out[LOSS_LEFT if left else LOSS_RIGHT] += event_loss(c, row)
    out[BASE_WORK] += event_work(c, row)
    if row[KIND] == IMPACT:
        out[IMPACTS_LEFT if left else IMPACTS_RIGHT] += 1.0
    else:
        out[STICKS_LEFT if left else STICKS_RIGHT] += 1.0


@njit
def add_integrals(out, length, xx, vv, ball, work, loss):
    """Add to the totals what does not depend on where in a segment it comes about."""
    out[DURATION] += length
    out[X1_SQUARE] += xx
    out[V1_SQUARE] += vv
    out[V2_SQUARE] += ball
    out[BASE_WORK] += work
    out[DAMPER_LOSS] += loss


@by_type(Constants)
@linked_njit
def add_segment(c, out, mode, begins, x1, v1, x2, v2, phase, length):
    """Add the motion of a segment, given by the state at its start, to the totals."""
    o = c.stuck if mode != 0.0 else c.free
    start = phasors(o, c.Omega, x1, v1, phase)
    end = turn(o, c.Omega, *start, length)
    xx, vv, ball, work, loss = energies_between(c, o, mode != 0.0, start, end, v2, length)
    add_integrals(out, length, xx, vv, ball, work, loss)
    best, when = peak_between(c, o, start, end, 0.0, length, out[MAX_ABS_X1])
    if when >= 0.0:
        out[MAX_ABS_X1] = best
        out[T_MAX_ABS_X1] = begins + when


@by_type(Constants)
@linked_njit
def window_totals(c, rows, n, start, stop):
    """Return the totals of the time window (start, stop] of a run of n rows, the last of which ends it.

    Events exactly at `start` count only if they belong to the run's first instant.
    """
    out = zero_vector(TOTALS)
    add_window(c, out, rows, n, start, stop)
    return out


@linked_njit
def add_window(c, out, rows, n, start, stop):
    """Add a window to totals that are all 0 as yet; see `window_totals`."""
    opened = False
    energy = 0.0
    for i in range(n):
        begins = rows[i, TIME]
        if begins > stop:
            break
        kind = rows[i, KIND]
        counted = i > 0 and (begins > start or (begins == start and rows[0, TIME] == start))
        if counted and kind in (IMPACT, STICK):
            count_event(c, out, rows[i])
        if i == n - 1:
            break
        length = rows[i + 1, TAU]
        ends = rows[i + 1, TIME]
        if ends < start:
            continue
        low = start - begins if begins < start else 0.0
        if ends > stop:
            length = stop - begins
        if length < low:
            continue
        x1, v1, x2, v2, phase = rows[i, X1], rows[i, A_V1], rows[i, X2], rows[i, A_V2], rows[i, PHASE]
        if low > 0.0:
            x1, v1, x2, v2, phase = segment_state(c, rows[i], low)
        if not opened:
            opened = True
            first = rows[i]
            if i == 0 and low == 0.0:
                energy = stored_energy(c, first[X1], first[V1], first[X2], first[V2], first[PHASE])
            else:
                energy = stored_energy(c, x1, v1, x2, v2, phase)
            out[MAX_ABS_X1] = abs(x1)
            out[T_MAX_ABS_X1] = begins + low
        add_segment(c, out, rows[i, MODE], begins + low, x1, v1, x2, v2, phase, length - low)
        if ends >= stop or i == n - 2:
            x1, v1, x2, v2, phase = segment_state(c, rows[i], length)
            if i == n - 2 and ends <= stop:
                last = rows[n - 1]
                x1, v1, x2, v2, phase = last[X1], last[A_V1], last[X2], last[A_V2], last[PHASE]
            out[ENERGY_CHANGE] = stored_energy(c, x1, v1, x2, v2, phase) - energy


@entry_njit
def accumulate(c, rows):
    """Return, for each row, base work, damper loss and impact loss from the first row to just after it: (n, 3)."""
    n = rows.shape[0]
    out = zero_matrix(n, 3)
    for i in range(1, n):
        row = rows[i - 1]
        _, _, _, work, loss = segment_integrals(c, row[MODE], row[X1], row[A_V1], row[A_V2], row[PHASE], rows[i, TAU])
        out[i, 0] = out[i - 1, 0] + work + event_work(c, rows[i])
        out[i, 1] = out[i - 1, 1] + loss
        out[i, 2] = out[i - 1, 2] + event_loss(c, rows[i])
    return out


@entry_njit
def sample_rows(c, rows, totals, segment, tau, before, out):
    """Fill out[:, :] with x1, v1, x2, v2, phase, stuck, base work, damper loss, impact loss at given places.

    A place is a segment (the row that begins it) and the time since that row. Where `before` is set the place is the
    end of the segment, and the state is the one stored with the next row, exactly.
    """
    for k in range(segment.shape[0]):
        i = segment[k]
        row = rows[i]
        x1, v1, x2, v2, phase = segment_state(c, row, tau[k])
        if before[k]:
            after = rows[i + 1]
            x1, v1, x2, v2, phase = after[X1], after[V1], after[X2], after[V2], after[PHASE]
        elif tau[k] == 0.0:
            x1, v1, x2, v2, phase = row[X1], row[A_V1], row[X2], row[A_V2], row[PHASE]
        work = 0.0
        loss = 0.0
        if tau[k] > 0.0:
            _, _, _, work, loss = segment_integrals(c, row[MODE], row[X1], row[A_V1], row[A_V2], row[PHASE], tau[k])
        out[k, 0] = x1
        out[k, 1] = v1
        out[k, 2] = x2
        out[k, 3] = v2
        out[k, 4] = phase
        out[k, 5] = row[MODE]
        out[k, 6] = totals[i, 0] + work
        out[k, 7] = totals[i, 1] + loss
        out[k, 8] = totals[i, 2]
