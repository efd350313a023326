"""What is done with a run that is taken as it is: its errors, how long it was watched, and whether its motion lasts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors import _verdict as v
from vines.attractors._errors import RunOn, run_on
from vines.attractors._look import is_regular_block
from vines.attractors._patience import Patience
from vines.dynamics.kernels import rows as col

__all__ = ["REGULAR", "note_conserving", "watch_on"]

REGULAR = (v.PERIODIC, v.NO_IMPACT)
"""Regimes of runs that need not be watched on."""

SURE = 5.0
"""Standard errors by which a window must differ from what came after it for the motion to have become another one."""

SAME = 1e-6
"""Relative difference that is none, however small the errors."""

Floats = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]


def note_conserving(verdicts: Floats, conserves: npt.NDArray[np.bool_]) -> None:
    """Note of runs in which nothing is lost that they are on no attractor."""
    rows = np.flatnonzero(conserves & (verdicts[:, v.SETTLED] > 0))
    verdicts[rows, v.SETTLED] = 0.0
    verdicts[rows, v.REMAINING] = np.nan
    verdicts[rows, v.REASON] = v.CONSERVES


def watch_on(
    table: Callable[[Numbers], Any],
    states: Floats,
    period: Floats,
    measured: Floats,
    verdicts: Floats,
    how: Patience,
) -> npt.NDArray[np.bool_]:
    """Watch runs whose motion never repeated on from the ends of their windows, and note the errors of their measures.

    Parameters
    ----------
    table : callable
        Returns the table of parameters of some of the runs.
    states : ndarray, shape (n, STATE)
        The runs at time 0; of those that never repeated moved to where they were watched to.
    period : ndarray, shape (n,)
        Forcing periods.
    measured : ndarray, shape (n, 3)
        K2/K1, largest |x1| and rms x1 of the windows.
    verdicts : ndarray, shape (n, VERDICT)
        Filled on.
    how : Patience

    Returns
    -------
    ndarray of bool, shape (n,)
        Which runs have become regular, or of other means than in their windows: what was seen there was a transient,
        and they are to be looked at again from where they are.
    """
    ended = np.zeros(len(verdicts), dtype=bool)
    regime = verdicts[:, v.REGIME]
    wild = (regime == v.CHAOTIC) | (regime == v.QUASIPERIODIC)
    wild |= (regime == v.UNSETTLED) & (verdicts[:, v.REASON] == v.UNDECIDED)
    wild &= (verdicts[:, v.STATUS] == col.COMPLETE) & (verdicts[:, v.REASON] != v.CONSERVES)
    rows = np.flatnonzero(wild)
    if not len(rows):
        return ended
    moved = states[rows]
    found: RunOn = run_on(lambda some: table(rows[some]), moved, period[rows], how.window, how.patience, how.cap)
    states[rows] = moved
    for k, column in enumerate((v.KINETIC_RATIO_ERROR, v.MAX_ABS_X1_ERROR, v.RMS_X1_ERROR)):
        verdicts[rows, column] = found.errors[:, k]
    watched = verdicts[rows, v.RECORDED] + found.periods
    beyond = watched > verdicts[rows, v.WATCHED]
    verdicts[rows, v.WATCHED] = np.fmax(verdicts[rows, v.WATCHED], watched)
    silent = rows[found.remembers & (verdicts[rows, v.REASON] == v.NOTHING)]
    verdicts[silent, v.REASON], verdicts[silent, v.VALUE] = v.REMEMBERS, found.periods[np.isin(rows, silent)]
    # What was watched for longer already was looked at there.
    again = rows[beyond & (verdicts[rows, v.REGIME] != v.QUASIPERIODIC)]
    regular = np.zeros(len(again), dtype=bool)
    is_regular_block(table(again), states[again], how.window, how.cap, how.tolerance, how.longest, regular)
    ended[again] = regular
    changed = np.abs(measured[rows] - found.means) > SURE * found.errors + SAME * np.abs(found.means)
    ended[rows] |= np.any(changed, axis=1)
    return ended
