"""Segments of motion in a lane and the parts of its recorded time, one lane at a time.

The lanes take the measures of most flights together (`_lane_measures`). Here is what is left: events of the scalar
kernel, flights in which a part of the recorded time ends, and peaks that need a closer look.
"""

from __future__ import annotations

import math

from vines.dynamics import _advance as col
from vines.dynamics import _lane_fields as f
from vines.dynamics._batches import BATCHES, close_batch
from vines.dynamics._flight import advance_phase
from vines.dynamics._integrals import largest_displacement
from vines.dynamics._lane_measures import MEND_PEAK, lane_energies, lane_peak
from vines.dynamics._lane_motion import flow, forced_motion
from vines.dynamics._sincos import sincos
from vines.dynamics._totals import (
    IMPACTS_LEFT,
    IMPACTS_RIGHT,
    LOSS_LEFT,
    LOSS_RIGHT,
    MAX_ABS_X1,
    T_MAX_ABS_X1,
    TOTALS,
    add_segment,
    count_event,
    segment_state,
)
from vines.kernels import linked_njit, new_vector, njit, zero_vector

__all__ = ["begin_segment", "close_part", "end_segment", "mend", "part_of"]

LARGEST = f.PART + MAX_ABS_X1 * f.STRIDE
WHEN_LARGEST = f.PART + T_MAX_ABS_X1 * f.STRIDE

NOWHERE = 0.0
"""Position of a ball that nothing holds: it has no say in the energies of its flight."""


@linked_njit
def _one_energies(L, i):
    lane_energies(L, i)


@linked_njit
def _one_peak(L, i):
    lane_peak(L, i)


@njit
def _part_ends(batch, length):
    """Return the time left at the end of a part; the last one ends with the run."""
    return length * (1.0 - (batch + 1.0) / BATCHES) if batch < BATCHES - 1 else -1.0


@linked_njit
def begin_segment(L, segment, i, batch, length, since, mode, x1, v1, v2, phase):
    """Begin a segment in a lane whose last event was at `since` before it."""
    sine, cosine = sincos(phase)
    L[f.FROM_X + i], L[f.FROM_V + i], L[f.FROM_COS + i], L[f.FROM_SIN + i] = x1, v1, cosine, sine
    L[f.FROM_TAU + i] = since
    segment[i, 0], segment[i, 1] = mode, v2
    L[f.PART_ENDS + i] = _part_ends(batch, length)


@linked_njit
def part_of(L, i):
    """Return the totals of the running part."""
    part = new_vector(TOTALS)
    for k in range(TOTALS):
        part[k] = L[f.PART + k * f.STRIDE + i]
    return part


@linked_njit
def end_segment(held, L, record, i, length, row):
    """Add the segment that a row ends, cut where a part ends, and what its event costs; begin the next segment."""
    _, _, total, values, batch, segment, _, _ = record
    part = part_of(L, i)
    mode, v2 = segment[i]
    x1, v1 = L[f.FROM_X + i], L[f.FROM_V + i]
    phase = advance_phase(math.atan2(L[f.FROM_SIN + i], L[f.FROM_COS + i]), 0.0)
    lasts = row[col.TAU] - L[f.FROM_TAU + i]
    begins = row[col.TIME] - lasts
    width = length / BATCHES
    gone = 0.0
    first = x1, v1, v2, phase
    while batch[i] < BATCHES - 1 and begins + lasts > (batch[i] + 1) * width:
        cut = min(max((batch[i] + 1) * width - begins, gone), lasts)
        add_segment(held[i], part, mode, begins + gone, x1, v1, NOWHERE, v2, phase, cut - gone)
        close_batch(held[i].mu, part, total[i], values[i, batch[i]])
        batch[i] += 1
        start = zero_vector(col.ROW)
        start[col.MODE] = mode
        start[col.X1], start[col.A_V1], start[col.A_V2], start[col.PHASE] = first
        x1, v1, _, v2, phase = segment_state(held[i], start, cut)
        gone = cut
        part[MAX_ABS_X1], part[T_MAX_ABS_X1] = abs(x1), begins + gone
    add_segment(held[i], part, mode, begins + gone, x1, v1, NOWHERE, v2, phase, lasts - gone)
    if row[col.KIND] == col.IMPACT or row[col.KIND] == col.STICK:
        count_event(held[i], part, row)
    for k in range(TOTALS):
        L[f.PART + k * f.STRIDE + i] = part[k]
    begin_segment(
        L,
        segment,
        i,
        batch[i],
        length,
        0.0,
        row[col.MODE],
        row[col.X1],
        row[col.A_V1],
        row[col.A_V2],
        row[col.PHASE],
    )


@linked_njit
def close_part(mu, L, record, i, part):
    """Add the running part of a lane to its totals."""
    close_batch(mu, part, record[2][i], record[3][i, record[4][i]])


@linked_njit
def _at(L, i, h):
    """Return free displacement and velocity and the phasor a time h after the start of a segment."""
    cosine, sine = L[f.FROM_COS + i], L[f.FROM_SIN + i]
    xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], L[f.OMEGA + i], cosine, sine)
    xh, vh = L[f.FROM_X + i] - xq, L[f.FROM_V + i] - vq
    steps = int(h / L[f.LIMIT + i]) + 1
    h /= steps
    for _ in range(steps):
        xh, vh, cosine, sine = flow(
            L[f.HALF + i], L[f.GAMMA + i], L[f.INVERSE + i], L[f.OMEGA + i], xh, vh, cosine, sine, h
        )
    return xh, vh, cosine, sine


@njit
def _end_of(L, i):
    """Return what the measures of a flight take from its end."""
    return (
        L[f.X_FREE + i],
        L[f.COS + i],
        L[f.SIN + i],
        L[f.BEFORE1 + i],
        L[f.FLIGHT + i],
        L[f.LEFT + i],
        L[f.WALL + i],
    )


@njit
def _set_end(L, i, end):
    L[f.X_FREE + i], L[f.COS + i], L[f.SIN + i], L[f.BEFORE1 + i], L[f.FLIGHT + i], L[f.LEFT + i], L[f.WALL + i] = end


@linked_njit
def _end_at(L, i, h, left):
    """Let a flight end, without an impact, a time h after the start of its segment; return x1 and v1 there."""
    xh, vh, cosine, sine = _at(L, i, h)
    xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], L[f.OMEGA + i], cosine, sine)
    _set_end(L, i, (xh, cosine, sine, vh + vq, L[f.FROM_TAU + i] + h, left, 0.0))
    return xh + xq, vh + vq


@linked_njit
def _from_end(L, i, x1, v1):
    """Begin a segment where the last one ended, in flight."""
    L[f.FROM_X + i], L[f.FROM_V + i] = x1, v1
    L[f.FROM_COS + i], L[f.FROM_SIN + i] = L[f.COS + i], L[f.SIN + i]
    L[f.FROM_TAU + i] = L[f.FLIGHT + i]


@linked_njit
def _peak_in_halves(L, i):
    """Search each half of a flight for its peak, as the lanes do; say whether that was enough."""
    begin = L[f.FROM_X + i], L[f.FROM_V + i], L[f.FROM_COS + i], L[f.FROM_SIN + i], L[f.FROM_TAU + i]
    end = _end_of(L, i)
    half = 0.5 * (L[f.FLIGHT + i] - L[f.FROM_TAU + i])
    x1, v1 = _end_at(L, i, half, L[f.LEFT + i] + half)
    if abs(x1) > L[LARGEST + i]:
        L[LARGEST + i], L[WHEN_LARGEST + i] = abs(x1), L[f.LENGTH + i] - L[f.LEFT + i]
    L[f.SEEK + i], L[f.MEND + i] = 1.0, 0.0
    _one_peak(L, i)
    _from_end(L, i, x1, v1)
    _set_end(L, i, end)
    if L[f.MEND + i] == 0.0:
        _one_peak(L, i)
    L[f.FROM_X + i], L[f.FROM_V + i], L[f.FROM_COS + i], L[f.FROM_SIN + i], L[f.FROM_TAU + i] = begin
    return L[f.MEND + i] == 0.0


@linked_njit
def _mend_peak(held, L, i):
    """Search a flight, which the lanes could not, for its peak."""
    if _peak_in_halves(L, i):
        return
    lasts = L[f.FLIGHT + i] - L[f.FROM_TAU + i]
    phase = advance_phase(math.atan2(L[f.FROM_SIN + i], L[f.FROM_COS + i]), 0.0)
    x1, v1 = L[f.FROM_X + i], L[f.FROM_V + i]
    L[LARGEST + i], when = largest_displacement(held[i], 0.0, x1, v1, phase, 0.0, lasts, L[LARGEST + i])
    if when >= 0.0:
        L[WHEN_LARGEST + i] = L[f.LENGTH + i] - L[f.LEFT + i] - lasts + when
    L[f.MEND + i] = 0.0


@linked_njit
def _one_by_scalar(held, L, i):
    """Take the measures of a flight by the scalar functions."""
    part = part_of(L, i)
    lasts = L[f.FLIGHT + i] - L[f.FROM_TAU + i]
    phase = advance_phase(math.atan2(L[f.FROM_SIN + i], L[f.FROM_COS + i]), 0.0)
    begins = L[f.LENGTH + i] - L[f.LEFT + i] - lasts
    add_segment(held[i], part, 0.0, begins, L[f.FROM_X + i], L[f.FROM_V + i], NOWHERE, L[f.BEFORE2 + i], phase, lasts)
    wall, closing = L[f.WALL + i], L[f.BEFORE1 + i] - L[f.BEFORE2 + i]
    if wall != 0.0:
        part[LOSS_LEFT if wall > 0.0 else LOSS_RIGHT] += L[f.LOSS + i] * closing * closing
        part[IMPACTS_LEFT if wall > 0.0 else IMPACTS_RIGHT] += 1.0
    for k in range(TOTALS):
        L[f.PART + k * f.STRIDE + i] = part[k]
    L[f.MEND + i] = 0.0


@linked_njit
def _measure_one(held, L, i):
    _one_energies(L, i)
    if L[f.MEND + i] != 0.0:
        _one_by_scalar(held, L, i)
        return
    _one_peak(L, i)
    if L[f.MEND + i] == MEND_PEAK:
        _mend_peak(held, L, i)


@linked_njit
def _cut(held, L, record, i, length):
    """Take the measures of a flight in which parts end, up to each of these ends and from the last one on."""
    end = _end_of(L, i)
    while end[5] < L[f.PART_ENDS + i]:
        ends = L[f.PART_ENDS + i]
        lasts = end[4] - L[f.FROM_TAU + i]
        x1, v1 = _end_at(L, i, min(max(lasts - (ends - end[5]), 0.0), lasts), ends)
        _measure_one(held, L, i)
        close_part(held[i].mu, L, record, i, part_of(L, i))
        record[4][i] += 1
        for k in range(TOTALS):
            L[f.PART + k * f.STRIDE + i] = 0.0
        L[LARGEST + i], L[WHEN_LARGEST + i] = abs(x1), length - ends
        L[f.PART_ENDS + i] = _part_ends(record[4][i], length)
        _from_end(L, i, x1, v1)
        _set_end(L, i, end)
    _measure_one(held, L, i)


@linked_njit
def mend(held, L, record, i, length):
    """Do for the impact of a lane what `measure` has left to do; `held` are the constants of all lanes.

    Where they are needed they are taken from there: each call that hands them on copies a hundred numbers.
    """
    if L[f.MEND + i] == MEND_PEAK:
        _mend_peak(held, L, i)
    else:
        _cut(held, L, record, i, length)
    L[f.MEND + i] = 0.0
