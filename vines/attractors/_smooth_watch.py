"""Run on where a motion without impacts does not repeat, and tell a torus, chaos and a slow decay apart."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._follow import BLOCKS, FLAT, LONGER, SURE, spectrum
from vines.attractors._judge import NEAR
from vines.dynamics.duffing import DuffingField
from vines.dynamics.hybrid import HybridConstants
from vines.dynamics.hybrid.kernels import HYBRID_STATE, R_V3, R_X3, set_hybrid
from vines.dynamics.kernels import directions, lyapunov_blocks, open_window, run_window, shift_time
from vines.dynamics.kernels import rows as col
from vines.dynamics.taylor import Field, TaylorConstants
from vines.dynamics.taylor.kernels import TAYLOR_STATE, set_mass
from vines.kernels import by_type, cold_njit, identity, new_matrix, njit, zero_vector

__all__ = ["LONGEST", "apart", "held", "watch_smooth"]

LONGEST = 32
"""Most forcing periods over which a repetition without impacts is looked for; a shorter window is not watched on."""

WATCH = 512
"""Forcing periods of the first stage."""

CAP = 1000
"""Most events in one forcing period: the first impact ends the watch."""


@njit
def _differs(rows, i, j, columns):
    """Return the largest difference of two rows in some columns."""
    away = 0.0
    for k in columns:
        away = max(away, abs(rows[i, k] - rows[j, k]))
    return away


@by_type(TaylorConstants)
@njit
def apart(c, rows, i, j):
    """Return how far the states just after two rows are from each other."""
    return _differs(rows, i, j, (col.X1, col.A_V1, col.X2, col.A_V2))


@apart.register(HybridConstants)
@njit
def _apart_beside(c, rows, i, j):
    # The ball stays where it is.
    return _differs(rows, i, j, (col.X1, col.A_V1, R_X3, R_V3))


@cold_njit
def _ends(c, rows, count, scale, tolerance, verdict):
    """Say whether chaos has ended before the last of the rows, once a period, and the run comes to an orbit."""
    last = count - 1
    for p in range(1, LONGEST + 1):
        newest, before = apart(c, rows, last, last - p) / scale, apart(c, rows, last - p, last - 2 * p) / scale
        if newest < NEAR and newest < before:
            rate = max(newest / before, 1e-300) ** (1.0 / p)
            verdict[v.REASON], verdict[v.VALUE] = v.COMES, rate
            verdict[v.REMAINING] = max(math.log(max(newest, 1e-300) / tolerance) / -math.log(rate), 0.0)
            return True
    return False


@by_type(TaylorConstants)
@njit
def held(c):
    """Return how many directions are those of what forces hold; a ball that nothing hits keeps any place and speed."""
    return _held_of(c.field)


@held.register(HybridConstants)
@njit
def _held_beside(c):
    return 4


@by_type(Field)
@njit
def _held_of(f):
    return 4


@_held_of.register(DuffingField)
@njit
def _held_of_a_frame(f):
    return 2


@by_type(TaylorConstants)
@cold_njit
def _all_directions(c):
    """Return every direction, those of what forces hold first."""
    return identity(len(directions(c)))


@_all_directions.register(HybridConstants)
@cold_njit
def _all_beside(c):
    # In x1, v1, x2, v2, x3, v3: the ball is the second.
    Y = new_matrix(6, 6)
    for i in range(6):
        for k in range(6):
            Y[i, k] = 0.0
    for k in range(6):
        Y[k if k < 2 else (k + 2 if k < 4 else k - 2), k] = 1.0
    return Y


@by_type(TaylorConstants)
@cold_njit
def _resumed(c, end):
    """Return the state of a run at a row."""
    own = zero_vector(TAYLOR_STATE)
    set_mass(c, own, end[col.X1], end[col.A_V1], end[col.X2], end[col.A_V2], end[col.PHASE], 0.0)
    return own


@_resumed.register(HybridConstants)
@cold_njit
def _resumed_beside(c, end):
    own = zero_vector(HYBRID_STATE)
    set_hybrid(
        c, own, end[col.X1], end[col.A_V1], end[col.X2], end[col.A_V2], end[R_X3], end[R_V3], end[col.PHASE], 0.0
    )
    return own


@njit
def _descending(verdict, d):
    """Put the exponents in order: those of the ball stood last."""
    for i in range(1, d):
        for k in range(i, 0, -1):
            one, other = verdict[v.EXPONENTS + k - 1], verdict[v.EXPONENTS + k]
            if one < other:
                verdict[v.EXPONENTS + k - 1], verdict[v.EXPONENTS + k] = other, one


@cold_njit
def watch_smooth(c, end, tolerance, verdict):
    """Decide what a window without impacts left open, from the row of its end on; fill the verdict on.

    Where an impact comes after all the run is not settled, and REMAINING tells when to look again. The exponents that
    decide are those of what forces hold. Without impacts a ball acts on nothing, so that they stay in their own space.
    """
    period = c.period
    own = _resumed(c, end)
    d = len(directions(c))
    Y = _all_directions(c)
    grown = new_matrix(sum(LONGER) * BLOCKS, d + 1)
    rows = new_matrix(2 * WATCH, end.shape[0])
    filled, passed = 0, 0.0
    rate, error = 0.0, math.inf
    verdict[v.REGIME], verdict[v.REMAINING] = v.UNSETTLED, math.nan
    for stage in range(len(LONGER)):
        length = LONGER[stage] * WATCH * period
        count = open_window(c, own, rows)
        rows, count, code = run_window(c, own, length, CAP, rows, count)
        passed += LONGER[stage] * WATCH
        if code != col.COMPLETE:
            verdict[v.REASON] = v.CAPPED_LATER
            return
        for i in range(1, count):
            if rows[i, col.KIND] == col.IMPACT:
                verdict[v.REASON], verdict[v.REMAINING] = v.DRIFTS, rows[i, col.TIME] / period
                return
        shift_time(own, length)
        # The first quarter of the first stage is left to the directions to align.
        skip = 0.25 * length if stage == 0 else 0.0
        blocks = LONGER[stage] * BLOCKS if stage else BLOCKS * 3 // 4
        part = lyapunov_blocks(c, rows, count + 1, skip, length, blocks, Y)
        for b in range(blocks):
            for j in range(d + 1):
                grown[filled, j] = part[b, j]
            filled += 1
        rate, error = spectrum(grown, filled, verdict)
        _descending(verdict, d)
        verdict[v.WATCHED] = passed
        if rate > SURE * error:
            if _ends(c, rows, count, verdict[v.SCALE], tolerance, verdict):
                verdict[v.REMAINING] += passed
                return
            verdict[v.REGIME], verdict[v.SETTLED], verdict[v.REMAINING] = v.CHAOTIC, 1.0, 0.0
            return
        if rate < -SURE * error:
            verdict[v.REMAINING] = math.log(1.0 / tolerance) / -rate / period
            verdict[v.REASON], verdict[v.VALUE] = v.DECAYS, LONGEST
            return
    if error < FLAT:
        verdict[v.REGIME], verdict[v.SETTLED], verdict[v.REMAINING] = v.QUASIPERIODIC, 1.0, 0.0
    else:
        verdict[v.REASON], verdict[v.VALUE], verdict[v.OTHER] = v.UNDECIDED, rate, error
