"""Standard errors of what a recorded window measures, where the motion never repeats.

A window may be shorter than the memory of the motion, and the largest displacement grows with it. So the error of what
is reported is the scatter of what windows of the same length give, along the same motion run on (docs/dynamics.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._series import BALL_SQUARE, COLUMNS, MAX_ABS_X1, V1_SQUARE, X1_SQUARE, series_block

__all__ = ["MEASURES", "RunOn", "errors_of", "run_on"]

Floats = npt.NDArray[np.float64]


MEASURES = 3
"""Measures that have errors: K2/K1, the largest |x1| and rms x1, in this order."""

PARTS = 8
"""Parts of a window, by which it is shifted along the motion."""

WINDOWS = 9
"""Windows that a run goes on for at first."""

LEAST_FREEDOM = 8.0
"""Fewest degrees of freedom with which an error is told."""

ALIKE = 1e-9
"""Relative scatter that is rounding."""

LONG = 20_000
"""Forcing periods that a run goes on for, even where less patience is asked for."""


@dataclass(frozen=True)
class RunOn:
    """What became of runs after their windows.

    Attributes
    ----------
    errors : ndarray, shape (n, MEASURES)
        Standard errors of the measures of their windows, nan where none can be told.
    means : ndarray, shape (n, MEASURES)
        Means of these measures over windows along the way.
    periods : ndarray, shape (n,)
        Forcing periods that each went on for, nan where it had to stop.
    remembers : ndarray of bool, shape (n,)
        Whether an error is missing because the motion remembers longer than that.
    """

    errors: Floats
    means: Floats
    periods: Floats
    remembers: npt.NDArray[np.bool_]


def run_on(
    table: Callable[[npt.NDArray[np.int64]], Any],
    states: Floats,
    period: Floats,
    record: float,
    patience: float,
    cap: int,
) -> RunOn:
    """Let runs go on from the ends of their windows until the errors of what these measured mean something.

    Parameters
    ----------
    table : callable
        Returns the table of parameters of some of the runs.
    states : ndarray, shape (n, STATE)
        The runs at time 0, moved to where they end.
    period : ndarray, shape (n,)
        Forcing period of each.
    record : float
        Forcing periods of a window.
    patience : float
        Forcing periods that a run may go on for.
    cap : int
        Most events in one forcing period.
    """
    n = len(states)
    # A window longer than that is judged by shorter ones, of which it holds many.
    window = min(record, max(patience, LONG) / WINDOWS)
    fresh = np.full((n, WINDOWS * PARTS, COLUMNS), np.nan)
    ahead = WINDOWS * window
    everyone = np.arange(n)
    series_block(table(everyone), states, window / PARTS * period, cap, fresh)
    series: dict[int, Floats] = dict(enumerate(fresh))
    means, found, freedom = errors_of(fresh, PARTS, window * period)
    periods = np.where(np.isnan(fresh[:, -1, 0]), np.nan, ahead)
    while True:
        short = np.flatnonzero(np.isfinite(periods) & (periods == ahead) & np.any(freedom < LEAST_FREEDOM, axis=1))
        if not len(short) or 2.0 * ahead > patience:
            break
        before = np.stack([series[k] for k in short.tolist()])
        fresh = np.full_like(before, np.nan)
        moved = states[short]
        series_block(table(short), moved, window / PARTS * period[short], cap, fresh)
        states[short] = moved
        joined = np.concatenate([before, fresh], axis=1)
        series.update(zip(short.tolist(), joined, strict=True))
        ahead *= 2.0
        means[short], found[short], freedom[short] = errors_of(joined, PARTS, window * period[short])
        periods[short] = np.where(np.isnan(fresh[:, -1, 0]), np.nan, ahead)
    remembers = freedom < LEAST_FREEDOM
    with np.errstate(invalid="ignore"):
        wider = np.sqrt(freedom / (freedom - 2.0))
    errors = np.where(remembers, np.nan, found * np.where(np.isinf(freedom), 1.0, wider))
    if window < record:
        errors *= math.sqrt(window / record)
        # How the largest of a window grows with its length is not known.
        errors[:, 1] = np.where(np.isinf(freedom[:, 1]), errors[:, 1], np.nan)
    return RunOn(errors, means, periods, np.any(remembers, axis=1))


def errors_of(series: Floats, parts: int, duration: Floats) -> tuple[Floats, Floats, Floats]:
    """Return mean and scatter of the measures of windows along series, and the degrees of freedom of the scatter.

    Parameters
    ----------
    series : ndarray, shape (n, m, COLUMNS)
        As `series_block` fills it.
    parts : int
        Parts of a window.
    duration : ndarray, shape (n,)
        Time of a window.

    Returns
    -------
    mean, scatter, freedom : ndarray, shape (n, MEASURES)
        nan where a series is not whole; infinite freedom where all windows measure the same.
    """
    sums = np.cumsum(np.concatenate([np.zeros((len(series), 1, COLUMNS)), series], axis=1), axis=1)
    total = sums[:, parts:] - sums[:, :-parts]
    largest = np.lib.stride_tricks.sliding_window_view(series[:, :, MAX_ABS_X1], parts, axis=1).max(axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = total[:, :, BALL_SQUARE] / total[:, :, V1_SQUARE]
    rms = np.sqrt(np.maximum(total[:, :, X1_SQUARE], 0.0) / duration[:, None])
    values = np.stack([ratio, largest, rms], axis=-1)
    count = values.shape[1]
    mean = values.mean(axis=1, keepdims=True)
    away = values - mean
    power = np.abs(np.fft.rfft(away, 2 * count, axis=1)) ** 2
    products = np.fft.irfft(power, axis=1)[:, :count]
    with np.errstate(invalid="ignore", divide="ignore"):
        like = products / products[:, :1]
    # Correlations up to where they first vanish; what lies beyond is the noise of a finite series.
    like = np.where(np.cumprod(like > 0.0, axis=1), like, 0.0)
    memory, of_squares = (2.0 * np.sum(each, axis=1) - 1.0 for each in (like, like**2))
    with np.errstate(invalid="ignore", divide="ignore"):
        # The mean over the series is not that of the motion: its own variance is missing in the scatter around it.
        square = products[:, 0] / count / (1.0 - np.minimum(memory / count, 0.5))
        freedom = count / of_squares
    scatter = np.sqrt(square)
    still = scatter <= ALIKE * np.abs(mean[:, 0])
    return mean[:, 0], scatter, np.where(still, np.inf, freedom)
