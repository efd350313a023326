"""Run many trajectories in lanes: load, tick, hand what is rare to the scalar kernel, record, refill.

A trajectory is first run for some forcing periods of which nothing is kept, then for those that are recorded. Lanes do
not know of each other, so a result does not depend on which trajectories run beside it.
"""

from __future__ import annotations

from vines.dynamics import _advance as col
from vines.dynamics import _lane_fields as f
from vines.dynamics._advance import advance, set_state, state_now
from vines.dynamics._constants import constants_kernel
from vines.dynamics._lane_measures import measure, renew
from vines.dynamics._lane_record import close_record, digest, keep_row, new_record, open_record
from vines.dynamics._lane_segments import end_segment, mend
from vines.dynamics._lane_state import fill_lane, may_fly, row_of, take_lane
from vines.dynamics._lanes import tick
from vines.dynamics._totals import state_energy
from vines.kernels import copy_values, entry_njit, linked_njit, njit, zero_matrix, zero_vector

__all__ = ["CAP", "DONE", "FINAL", "LIMIT", "OVERFLOW", "WITH_EXPONENTS", "WITH_IMPACTS", "WITH_MEASURES", "run_block"]

LANES = f.LANES
FINAL, WITH_MEASURES, WITH_IMPACTS, WITH_EXPONENTS = 0, 1, 2, 4
"""What is recorded beside the final states; they add up."""

DONE, CAP, LIMIT, OVERFLOW = 0, 1, 2, 3
"""How a trajectory ended: at its time, at the cap of events in a period, at that of steps, with the buffer full."""

UNHURRIED = 4
"""Ticks between two looks for waiting lanes when no event is recorded."""

STAGE, WHO, PHASE0 = 0, 1, 2


@njit
def _constants_of(parameters):
    return constants_kernel(parameters[0], parameters[1], parameters[2], parameters[3], parameters[4])


@linked_njit
def _room():
    """Return room for the lanes that begins where a line of the cache begins."""
    room = zero_vector(f.SIZE + 8)
    skip = (-(room.ctypes.data // 8)) % 8
    return room[skip : skip + f.SIZE]


@entry_njit
def run_block(
    parameters,
    starts,
    first,
    lengths,
    cap,
    what,
    finals,
    totals,
    errors,
    growths,
    growth_errors,
    counts,
    status,
    events,
):
    """Run a block of trajectories.

    Parameters
    ----------
    parameters : ndarray, shape (n, 5)
        mu, A, Omega, r, lam of each.
    starts : ndarray, shape (n, 5)
        x1, v1, x2, v2 and phase of each.
    first, lengths : ndarray, shape (n,)
        Time to run first, and time to record after it.
    cap : int
        Most events in one forcing period.
    what : int
        Sum of WITH_MEASURES, WITH_IMPACTS, WITH_EXPONENTS.
    finals : ndarray, shape (n, 6)
        Receives x1, v1, x2, v2, phase and the wall stuck to.
    totals : ndarray, shape (n or 0, TOTALS)
        Receives the totals of the time recorded, from which measures follow.
    errors : ndarray, shape (n or 0, 3)
        Receives the standard errors of kinetic_ratio, max_abs_x1, rms_x1.
    growths, growth_errors : ndarray, shapes (n or 0, 5), (n or 0, 4)
        Receive the logarithmic growth of four orthogonal disturbances in the time recorded, and that time; and the
        standard errors of the rates.
    counts, status : ndarray of int64, shape (n,)
        Receive the number of impacts in all, and DONE, CAP, LIMIT or OVERFLOW.
    events : ndarray, shape (m, ROW + 1)
        Receives the impacts of the time recorded, the number of the trajectory last.

    Returns
    -------
    int
        Impacts filled.
    """
    n = parameters.shape[0]
    L = _room()
    L[f.WAITS : f.WAITS + LANES] = 1.0
    state = zero_vector(col.STATE)
    row = zero_matrix(1, col.ROW)
    last = zero_vector(col.ROW)
    energies = what & WITH_MEASURES != 0
    rates = what & WITH_EXPONENTS != 0
    impacts = what & WITH_IMPACTS != 0
    keeps = impacts or rates
    record = new_record(LANES, keeps, energies, rates)
    rows, waiting, segment = record[0], record[1], record[5]
    run = zero_matrix(LANES, 3)
    run[:, :] = -1.0
    # The constants of the trajectory in each lane.
    held = [_constants_of(parameters[0]) for _ in range(LANES)]
    x1 = v1 = x2 = v2 = phase = since = 0.0
    next_one = 0
    active = 0
    filled = 0
    looks = 1 if keeps else UNHURRIED
    while True:
        for i in range(LANES):
            if keeps and L[f.HIT + i] > 0.0 and run[i, STAGE] == 1.0:
                who = int(run[i, WHO])
                row_of(L, i, rows[i, waiting[i]], lengths[who], run[i, PHASE0])
                if keep_row(rows, waiting, i):
                    filled = digest(held[i], record, i, lengths[who], rates, impacts, events, filled, who)
                    if filled < 0:
                        status[who] = OVERFLOW
                        return events.shape[0]
            if L[f.WAITS + i] == 0.0:
                continue
            # A waiting lane: with a new trajectory, or with one that the scalar kernel has to see to.
            while True:
                if run[i, WHO] < 0.0:
                    if next_one >= n:
                        break
                    who = next_one
                    next_one += 1
                    active += 1
                    c = _constants_of(parameters[who])
                    held[i] = c
                    s = starts[who]
                    set_state(state, s[0], s[1], s[2], s[3], s[4], 0.0)
                    run[i, WHO] = who
                    run[i, STAGE] = 0.0 if first[who] > 0.0 else 1.0
                    run[i, PHASE0] = state[col.S_PHASE]
                    counts[who] = 0
                    status[who] = DONE
                    L[f.IMPACTS + i] = 0.0
                    length = lengths[who] if run[i, STAGE] == 1.0 else first[who]
                    if run[i, STAGE] == 1.0:
                        open_record(c, L, record, i, length, 0.0, 0.0, s[0], s[1], s[2], s[3], s[4])
                    if may_fly(c, state) and fill_lane(held, state, L, i, length):
                        break
                else:
                    who = int(run[i, WHO])
                    c = held[i]
                    length = lengths[who] if run[i, STAGE] == 1.0 else first[who]
                    take_lane(held, L, i, state, length, run[i, PHASE0])
                    segment[i, 0], segment[i, 1] = 0.0, L[f.SPEED + i]
                flies = False
                while True:
                    length = lengths[who] if run[i, STAGE] == 1.0 else first[who]
                    _, code = advance(c, state, length, cap, row, 0)
                    happened = code in (col.BUFFER_FULL, col.EVENT_CAP)
                    if happened and row[0, col.KIND] == col.IMPACT:
                        L[f.IMPACTS + i] += 1.0
                    if code == col.COMPLETE and run[i, STAGE] == 0.0:
                        # On with the part that is kept: the same flight, its time counted from here.
                        x1, v1, x2, v2, phase, since = state_now(c, state, length)
                        state[col.S_T] -= length
                        state[col.S_PERIOD_START] -= length
                        run[i, STAGE] = 1.0
                        run[i, PHASE0] = phase
                        kept = lengths[who]
                        open_record(c, L, record, i, kept, since, state[col.S_MODE], x1, v1, x2, v2, phase)
                        if may_fly(c, state) and fill_lane(held, state, L, i, lengths[who]):
                            flies = True
                            break
                        continue
                    ended = code != col.BUFFER_FULL
                    end = length if code == col.COMPLETE else state[col.S_T] + state[col.S_T_LOW]
                    if ended:
                        x1, v1, x2, v2, phase, since = state_now(c, state, end)
                    if what and run[i, STAGE] == 1.0:
                        if happened and energies:
                            end_segment(held, L, record, i, length, row[0])
                        full = False
                        if happened and keeps:
                            copy_values(rows[i, waiting[i]], row[0])
                            full = keep_row(rows, waiting, i)
                        if code == col.COMPLETE:
                            last[:] = 0.0
                            last[col.KIND], last[col.TIME], last[col.TAU] = col.END, length, since
                            last[col.PHASE], last[col.X1], last[col.X2] = phase, x1, x2
                            last[col.V1], last[col.V2], last[col.A_V1], last[col.A_V2] = v1, v2, v1, v2
                            last[col.MODE] = state[col.S_MODE]
                            if energies:
                                end_segment(held, L, record, i, length, last)
                        if keeps and (full or ended):
                            filled = digest(c, record, i, length, rates, impacts, events, filled, who)
                        if filled >= 0 and code == col.COMPLETE and rates:
                            copy_values(rows[i, waiting[i]], last)
                            keep_row(rows, waiting, i)
                            filled = digest(c, record, i, length, rates, impacts, events, filled, who)
                        if filled >= 0 and ended:
                            energy = state_energy(c, x1, v1, v2, phase)
                            close_record(c, L, record, i, energy, who, totals, errors, growths, growth_errors)
                        if filled < 0:
                            status[who] = OVERFLOW
                            return events.shape[0]
                    if not ended:
                        if may_fly(c, state) and fill_lane(held, state, L, i, length):
                            flies = True
                            break
                        continue
                    if code != col.COMPLETE:
                        status[who] = CAP if code == col.EVENT_CAP else LIMIT
                    finals[who, 0], finals[who, 1], finals[who, 2], finals[who, 3] = x1, v1, x2, v2
                    finals[who, 4], finals[who, 5] = phase, state[col.S_MODE]
                    counts[who] = int(L[f.IMPACTS + i])
                    run[i, WHO] = -1.0
                    active -= 1
                    break
                if flies:
                    break
        if active == 0 and next_one >= n:
            return filled
        for _ in range(looks):
            tick(L, cap)
            if energies:
                measure(L)
                for i in range(LANES):
                    if L[f.MEND + i] > 0.0:
                        mend(held, L, record, i, lengths[int(run[i, WHO])])
                renew(L)
