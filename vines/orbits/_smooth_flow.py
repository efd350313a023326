"""Motions without impacts: where they are after a time, how that depends on where they begin, where the gap turns."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics import Measures
from vines.dynamics.kernels import carry_basis, directions, segment_state, window_totals
from vines.dynamics.kernels import rows as col
from vines.dynamics.runs import measures_from
from vines.dynamics.taylor.kernels import slopes
from vines.kernels import entry_njit, new_matrix, zero_vector
from vines.orbits._shots import turnings
from vines.orbits._survey import inspect_row

__all__ = ["Flown", "fly", "gap_at", "measures_of", "nearest_turnings", "passages", "seen"]

Floats = npt.NDArray[np.float64]


@entry_njit
def _flow(c, start, phase, span, end, Y):
    """Fill `end` with the state after a time, and Y with what it makes of disturbances; walls are not looked at."""
    row = zero_vector(col.ROW)
    row[col.PHASE] = phase
    row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2] = start[0], start[1], start[2], start[3]
    for i in range(len(directions(c))):
        for j in range(len(directions(c))):
            Y[i, j] = 1.0 if i == j else 0.0
    carry_basis(c, row, span, Y)
    end[0], end[1], end[2], end[3], _ = segment_state(c, row, span)


@entry_njit
def _pass(c, points, period):
    """Fill the rows of `points` behind the first with the states that follow it, a time `period` apart each."""
    row = zero_vector(col.ROW)
    for k in range(1, points.shape[0]):
        row[col.X1], row[col.A_V1] = points[k - 1, 0], points[k - 1, 1]
        row[col.X2], row[col.A_V2] = points[k - 1, 2], points[k - 1, 3]
        points[k, 0], points[k, 1], points[k, 2], points[k, 3], _ = segment_state(c, row, period)


@entry_njit
def _seen(c, start, span):
    """Return least clearance of a turning point, time and wall of the first contact, over a time from phase 0 on."""
    row = zero_vector(col.ROW)
    row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2] = start[0], start[1], start[2], start[3]
    return inspect_row(c, 0, row, span)


@entry_njit
def _turned(c, start, span):
    """Return the turning points of the gap over a time from phase 0 on: time, wall, clearance, w''."""
    row = zero_vector(col.ROW)
    row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2] = start[0], start[1], start[2], start[3]
    found = turnings(c, row, span)
    out = new_matrix(len(found), 4)
    for i in range(len(found)):
        when, w, bend = found[i]
        wall = 1.0 if bend < 0.0 else -1.0
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = when, wall, 1.0 - wall * w, bend
    return out


@entry_njit
def _gap(c, start, when):
    """Return w, w' and w'' at a time after phase 0."""
    row = zero_vector(col.ROW)
    row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2] = start[0], start[1], start[2], start[3]
    x1, v1, x2, v2, phase = segment_state(c, row, when)
    a1, a2 = slopes(c.field, x1, v1, x1 - x2, v1 - v2, phase)
    return x1 - x2, v1 - v2, a1 - a2


class Flown(NamedTuple):
    """Where a motion is after a time, and its tangent map."""

    end: Floats
    map: Floats


def fly(c: Any, start: Floats, span: float, phase: float = 0.0) -> Flown:
    """Return where a motion from a state at a phase is after a time, not finite where it has gone for ever."""
    d = len(start)
    found = Flown(np.empty(d), np.empty((d, d)))
    _flow(c, np.array(start, dtype=np.float64), phase, span, *found)
    return found


def passages(p: Any, c: Any, start: Floats, periods: int) -> Floats:
    """Return the states at phase 0 once a forcing period, the first included, shape (periods + 1, d)."""
    found = np.empty((periods + 1, len(start)))
    found[0] = start
    _pass(c, found, p.period)
    return found


def seen(c: Any, start: Floats, span: float) -> tuple[float, float, int]:
    """Return least clearance of a turning point, time and wall of the first contact, over a time from phase 0 on."""
    clearance, violation, wall = _seen(c, np.array(start, dtype=np.float64), span)
    return float(clearance), float(violation), int(wall)


def nearest_turnings(c: Any, start: Floats, span: float) -> Floats:
    """Return all turning points of the gap over a time from phase 0 on: rows of time, wall, clearance, w''."""
    return _turned(c, np.array(start, dtype=np.float64), span)


def gap_at(c: Any, start: Floats, when: float) -> tuple[float, float, float]:
    """Return w, w' and w'' at a time after phase 0."""
    return _gap(c, np.array(start, dtype=np.float64), when)


def measures_of(p: Any, c: Any, points: Floats) -> Measures:
    """Return the measures of a closed motion from its states once a forcing period, the last one that of the first."""
    rows = np.zeros((len(points), col.ROW))
    for k, point in enumerate(points):
        row = rows[k]
        row[col.KIND], row[col.TIME] = col.START if k < len(points) - 1 else col.END, k * p.period
        row[col.X1], row[col.V1], row[col.X2], row[col.V2] = point
        row[col.A_V1], row[col.A_V2] = point[1], point[3]
    for before, after in pairwise(rows):
        after[col.TAU] = after[col.TIME] - before[col.TIME]
    return measures_from(p, window_totals(c, rows, len(rows), 0.0, float(rows[-1, col.TIME])))
