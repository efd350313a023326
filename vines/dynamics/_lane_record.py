"""What is kept of a trajectory in a lane: its rows wait in a buffer and are then digested together.

Totals and growth are also formed over equal parts of the recorded time, whose scatter gives the standard errors
(`_batches`).
"""

from __future__ import annotations

import math

from vines.dynamics import _advance as col
from vines.dynamics import _lane_fields as f
from vines.dynamics._batches import BATCHES, GROWTHS, PART, errors_of_rates, standard_errors
from vines.dynamics._lane_measures import open_measures
from vines.dynamics._lane_segments import begin_segment, close_part, part_of
from vines.dynamics._tangent import DEAD, directions, flow_basis, jump_basis, log_growth, orthonormalise
from vines.dynamics._totals import DURATION, ENERGY_CHANGE, TOTALS, state_energy
from vines.kernels import (
    copy_values,
    entry_njit,
    fused_njit,
    linked_njit,
    new_vector,
    zero_cube,
    zero_integers,
    zero_matrix,
)

__all__ = ["DEPTH", "arrange", "close_record", "digest", "keep_row", "new_record", "open_record"]

DEPTH = 16
"""Rows of a lane that wait until they are digested; those of all lanes stay in the second cache."""


@linked_njit
def new_record(lanes, what_rows, what_totals, what_growth):
    """Return room for the records of all lanes, as a tuple of arrays.

    Rows and how many wait; totals, what errors are taken of by batch, number of the running batch, mode and ball of the
    running segment; disturbances and their growth by batch.
    """
    k = lanes if what_rows else 0
    n = lanes if what_totals else 0
    m = lanes if what_growth else 0
    return (
        zero_cube(k, DEPTH + 1, col.ROW),
        zero_integers(lanes),
        zero_matrix(n, TOTALS),
        zero_cube(n, BATCHES, PART),
        zero_integers(lanes),
        zero_matrix(lanes, 2),
        zero_cube(m, 4, 4),
        zero_cube(m, GROWTHS, 5),
    )


@linked_njit
def open_record(c, L, record, i, length, since, mode, x1, v1, x2, v2, phase):
    """Begin the part of a run that is kept, `since` after the last event."""
    rows, count, total, values, batch, segment, basis, growth = record
    if rows.shape[0]:
        row = rows[i, 0]
        row[:] = 0.0
        row[col.KIND] = col.START
        row[col.PHASE] = phase
        row[col.X1], row[col.V1], row[col.A_V1] = x1, v1, v1
        row[col.X2], row[col.V2], row[col.A_V2] = x2, v2, v2
        row[col.MODE] = mode
        count[i] = 1
    batch[i] = 0
    if total.shape[0]:
        total[i, :] = 0.0
        total[i, ENERGY_CHANGE] = -state_energy(c, x1, v1, v2, phase)
        values[i, :, :] = 0.0
        open_measures(c, L, i, length, x1)
        begin_segment(L, segment, i, 0, length, since, mode, x1, v1, v2, phase)
    if basis.shape[0]:
        basis[i, :, :] = 0.0
        for k in range(4):
            basis[i, k, k] = 1.0
        growth[i, :, :] = 0.0


@fused_njit
def keep_row(rows, count, i):
    """Take in the row that has been written to the first free place; say whether the buffer is now full."""
    k = count[i]
    # The flight in which the recording began is older than it.
    if rows[i, k - 1, col.KIND] == col.START:
        rows[i, k, col.TAU] = rows[i, k, col.TIME] - rows[i, k - 1, col.TIME]
    count[i] = k + 1
    return k == DEPTH


@linked_njit
def _digest_growth(c, rows, n, Y, growth, width):
    """Carry disturbances over n rows; their growth goes to the batch in which a row lies."""
    gains = new_vector(4)
    product = new_vector(4)
    product[:] = 1.0
    running = min(int(rows[1, col.TIME] / width), GROWTHS - 1)
    for j in range(1, n):
        batch = min(int(rows[j, col.TIME] / width), GROWTHS - 1)
        if batch != running:
            log_growth(product, growth[running])
            running = batch
        flow_basis(c, rows[j - 1, col.MODE], rows[j, col.TAU], Y)
        jump_basis(c, rows[j], Y)
        orthonormalise(directions(c), Y, gains)
        growth[running, 4] += rows[j, col.TAU]
        for k in range(4):
            product[k] *= gains[k]
            if not DEAD < product[k] < 1.0 / DEAD:
                log_growth(product, growth[running])
    log_growth(product, growth[running])


@linked_njit
def digest(c, record, i, length, what_growth, what_impacts, events, filled, who):
    """Digest the rows that wait in a lane; return how much of `events` is filled, -1 if it is full."""
    rows, count, _, _, _, _, basis, growth = record
    n = count[i]
    if n > 1:
        if what_growth:
            _digest_growth(c, rows[i], n, basis[i], growth[i], length / GROWTHS)
        if what_impacts:
            for j in range(1, n):
                if rows[i, j, col.KIND] != col.IMPACT:
                    continue
                if filled >= events.shape[0]:
                    return -1
                copy_values(events[filled], rows[i, j])
                events[filled, col.ROW] = who
                filled += 1
        copy_values(rows[i, 0], rows[i, n - 1])
        count[i] = 1
    return filled


@linked_njit
def close_record(c, L, record, i, energy, who, totals, errors, growths, growth_errors):
    """Write what a record has gathered to row `who`; standard errors are nan if the run ended before its time."""
    _, _, total, values, batch, _, _, growth = record
    L[f.RECORDED + i] = 0.0
    if total.shape[0]:
        part = part_of(L, i)
        whole = batch[i] == BATCHES - 1 and part[DURATION] > 0.0
        close_part(c.mu, L, record, i, part)
        total[i, ENERGY_CHANGE] += energy
        copy_values(totals[who], total[i])
        errors[who, :] = math.nan
        if whole:
            standard_errors(c.lam, values[i], total[i], errors[who])
    if growth.shape[0]:
        growths[who, :] = 0.0
        for b in range(GROWTHS):
            for k in range(5):
                growths[who, k] += growth[i, b, k]
        errors_of_rates(growth[i], growth_errors[who])


@entry_njit
def arrange(events, runs, start, out):
    """Sort impacts, the number of their run last, by run, keeping the order of time, into records of RUN_IMPACT."""
    begins = zero_integers(runs + 1)
    for k in range(events.shape[0]):
        begins[int(events[k, col.ROW]) + 1] += 1
    for run in range(runs):
        begins[run + 1] += begins[run]
    place = begins.copy()
    for k in range(events.shape[0]):
        row = events[k]
        run = int(row[col.ROW])
        one = out[place[run]]
        one.run = run + start
        one.index = place[run] - begins[run]
        place[run] += 1
        one.t, one.side, one.phase = row[col.TIME], int(row[col.SIDE]), row[col.PHASE]
        one.x1, one.v1, one.x2, one.v2 = row[col.X1], row[col.V1], row[col.X2], row[col.V2]
        one.v1_after, one.v2_after, one.w_dot = row[col.A_V1], row[col.A_V2], row[col.V1] - row[col.V2]
