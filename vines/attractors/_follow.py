"""Run on where nothing repeats, for as long as it takes to tell a slow approach, a torus and chaos apart."""

from __future__ import annotations

import math

import numpy as np

from vines.attractors import _verdict as v
from vines.attractors._contacts import contacts, repetition
from vines.attractors._judge import NEAR, note_approach
from vines.attractors._window import open_window, run_window
from vines.dynamics import _advance as col
from vines.dynamics._advance import shift_time
from vines.dynamics._jit import njit
from vines.dynamics._tangent import lyapunov_blocks

__all__ = ["follow"]

LONGER = (1, 3, 12)
"""How long to run on where nothing repeats, in units of `watch`: each stage only if those before left it open."""

BLOCKS = 16
"""Blocks in a time `watch` from whose scatter the error of an exponent is taken."""

FLAT = 1.5e-3
"""Largest standard error of an exponent that is called zero."""

SURE = 3.0
"""Standard errors by which an exponent must differ from zero to be told from it."""


@njit
def follow(c, state, elapsed, periods, watch, cap, tolerance, verdict):
    """Decide what a window left open; `verdict` is that of the window and is filled on.

    Parameters
    ----------
    c : Constants
    state : ndarray
        The run at the end of the window; left as it is.
    elapsed, periods : float
        Length of the window, in time and in forcing periods.
    watch : float
        Forcing periods of the first stage.
    cap : int
        Most events in one forcing period.
    tolerance : float
        As for `judge_window`.
    verdict : ndarray, shape (VERDICT,)
    """
    period = 2.0 * math.pi / c.Omega
    state = state.copy()
    Y = np.eye(4)
    grown = np.zeros((sum(LONGER) * BLOCKS, 5))
    filled = 0
    rate, error = 0.0, math.inf
    verdict[v.REGIME] = v.UNSETTLED
    rows = np.empty((int(4.0 * watch) + 64, col.ROW))
    for stage in range(len(LONGER)):
        shift_time(state, elapsed)
        length = LONGER[stage] * watch * period
        elapsed = length
        count = open_window(state, rows)
        rows, count, code = run_window(c, state, length, cap, rows, count)
        if code != col.COMPLETE:
            verdict[v.REASON] = v.CAPPED_LATER
            return
        # The first quarter of the first stage is left to the directions to align.
        skip = 0.25 * length if stage == 0 else 0.0
        blocks = LONGER[stage] * BLOCKS if stage else BLOCKS * 3 // 4
        grown[filled : filled + blocks] = lyapunov_blocks(c, rows, count + 1, skip, length, blocks, Y)
        filled += blocks
        rate, error = _spectrum(grown[:filled], verdict)
        if stage == 0 and verdict[v.BEST_P] > 0.0:
            chaotic = rate > SURE * error
            if _comes_or_leaves(c, rows, count + 1, length, periods, watch, chaotic, tolerance, verdict):
                return
        if rate > SURE * error:
            verdict[v.REGIME], verdict[v.SETTLED], verdict[v.REMAINING] = v.CHAOTIC, 1.0, 0.0
            return
        if rate < -SURE * error:
            verdict[v.REMAINING] = math.log(1.0 / tolerance) / -rate / period
            verdict[v.REASON] = v.DECAYS
            return
    if error < FLAT:
        verdict[v.REGIME], verdict[v.SETTLED], verdict[v.REMAINING] = v.QUASIPERIODIC, 1.0, 0.0
    else:
        verdict[v.REASON], verdict[v.VALUE], verdict[v.OTHER] = v.UNDECIDED, rate, error


@njit
def _spectrum(grown, verdict):
    """Write the exponents of growth by blocks; return the largest and its error, that of a finite run included."""
    # Growth is booked with the block in which an event falls: a block without one says nothing.
    grown = grown[grown[:, 4] > 0.0]
    n = grown.shape[0]
    time = grown[:, 4].sum()
    for j in range(4):
        total = grown[:, j].sum()
        verdict[v.EXPONENTS + j] = total / time if math.isfinite(total) else -math.inf
    square = 0.0
    for b in range(n):
        square += (grown[b, 0] / grown[b, 4] - verdict[v.EXPONENTS]) ** 2
    # A finite run cannot tell rates apart that differ by less than about one over its length.
    error = math.hypot(math.sqrt(square / (n - 1) / n), 1.0 / time) if n > 1 else math.inf
    verdict[v.LYAPUNOV_ERROR] = error
    verdict[v.KNOWN] = 1.0
    return verdict[v.EXPONENTS], error


@njit
def _comes_or_leaves(c, rows, n, length, periods, watch, chaotic, tolerance, verdict):
    """Say whether the run comes to, or leaves, a periodic orbit, and if so note how long that will take."""
    period = 2.0 * math.pi / c.Omega
    p = verdict[v.BEST_P]
    kept = contacts(rows, n, length - periods * period)
    before, after = verdict[v.BEST_WORST], math.inf
    if kept.shape[0] > 1:
        blocks = np.empty(kept.shape[0])
        _, filled = repetition(rows, kept, p * period, verdict[v.SCALE], blocks)
        if filled:
            after = blocks[:filled].max()
    if min(before, after) >= NEAR and (chaotic or after >= 0.5 * before):
        return False
    if after < 0.5 * before:
        note_approach(verdict, math.log(before / max(after, 1e-15)) / watch, tolerance)
        return True
    verdict[v.REASON] = v.STAYS_NEAR
    if before < after < math.inf:
        verdict[v.REMAINING] = math.log(1.0 / after) / (math.log(after / before) / watch) if after < 1.0 else 0.0
        verdict[v.REASON] = v.LEAVES
    return True
