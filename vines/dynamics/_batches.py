"""Standard errors from inside a run: totals of equal parts of the recorded time, and what their scatter says.

The error of a mean over n parts is their scatter over the root of n if they are independent. Whether they are is asked
of the parts themselves, by the initial monotone sequence of their correlations (Geyer 1992); where they are not the
recorded time holds too few memories of the motion for any estimate from inside it, and the error is nan. So it is where
a part is shorter than twice what the oscillator remembers. An error from so few parts is uncertain itself: it is the
standard deviation of Student's law, which is wider (docs/dynamics.md).
"""

from __future__ import annotations

import math

from vines.dynamics._totals import (
    DURATION,
    MAX_ABS_X1,
    T_MAX_ABS_X1,
    TOTALS,
    V1_SQUARE,
    V2_SQUARE,
    X1_SQUARE,
)
from vines.kernels import linked_njit, new_vector

__all__ = [
    "BATCHES",
    "GROWTHS",
    "KNOWN_CORRELATION",
    "PART",
    "close_batch",
    "error_of_mean",
    "errors_of_rates",
    "spread_of_mean",
    "standard_errors",
]

BATCHES = 8
"""Equal parts of the recorded time: flights are cut where one ends, so they cost."""

GROWTHS = 32
"""The same for the growth of disturbances, which is booked where an event falls: their ends cost nothing."""

PART = 4
"""What is kept of each: integrals of x1^2, v1^2 and mu v2^2, and the largest |x1|."""

LEAST_FREEDOM = 6.0
"""Fewest degrees of freedom of an error; eight parts without any correlation have seven."""

KNOWN_CORRELATION = 2.0 / 3.0
"""Degrees of freedom of an exponent's error over those that it had if the correlation of its parts were known and not
estimated from them: so the mean square of z of random chaotic points is nearest to 1 (benchmarks/errors.py)."""

MEMORIES = 4.0
"""Least length of a part in units of 1/lam, twice the memory of the oscillator: eight parts show no longer one."""

ALIKE = 1e-8
"""Relative scatter of parts that is no scatter: those of a periodic motion, whatever they say of correlation."""


@linked_njit
def close_batch(mu, part, total, values):
    """Add a part to the totals, keep what its errors are taken of, and empty it."""
    larger = part[MAX_ABS_X1] > total[MAX_ABS_X1]
    for k in range(TOTALS):
        if k not in (MAX_ABS_X1, T_MAX_ABS_X1):
            total[k] += part[k]
        elif larger:
            total[k] = part[k]
    values[0], values[1], values[2] = part[X1_SQUARE], part[V1_SQUARE], mu * part[V2_SQUARE]
    values[3] = part[MAX_ABS_X1]
    for k in range(TOTALS):
        part[k] = 0.0


@linked_njit
def spread_of_mean(series):
    """Return the standard error of the mean of a series, correlations of its members included, and its freedom.

    Parameters
    ----------
    series : ndarray, shape (n,)
        Means over equal parts of time, in order.

    Returns
    -------
    (alone, together, freedom)
        The error if the members were independent, that which their correlation makes of it, and how many degrees of
        freedom that has.
    """
    n = series.shape[0]
    mean = 0.0
    for i in range(n):
        mean += series[i] / n
    square = 0.0
    for i in range(n):
        square += (series[i] - mean) ** 2
    alone = math.sqrt(square / (n * (n - 1.0)))
    if not square > 0.0:
        return alone, alone, n - 1.0
    # Correlations of neighbours, in pairs whose sum falls and is positive for what is stationary and reversible.
    memory, before = -1.0, math.inf
    for m in range((n - 1) // 2):
        pair = 0.0
        for lag in (2 * m, 2 * m + 1):
            for i in range(n - lag):
                pair += (series[i] - mean) * (series[i + lag] - mean) / square
        if not pair > 0.0:
            break
        before = min(before, pair)
        memory += 2.0 * before
    memory = max(memory, 1.0)
    return alone, alone * math.sqrt(memory), n / memory - 1.0


@linked_njit
def error_of_mean(series, size):
    """Return the standard error of the mean of a series, nan where its members are not independent.

    Parameters
    ----------
    series : ndarray, shape (n,)
        Means over equal parts of time, in order.
    size : float
        What a scatter is small against.
    """
    alone, together, freedom = spread_of_mean(series)
    if alone <= ALIKE * abs(size):
        return alone
    if not freedom >= LEAST_FREEDOM:
        return math.nan
    return together * math.sqrt(freedom / (freedom - 2.0))


@linked_njit
def standard_errors(lam, values, total, errors):
    """Put the standard errors of K2/K1, of the largest |x1| and of rms x1 into `errors`.

    The largest of a time has no error from inside it: how it would grow over a longer one is not known. It is nan
    unless all parts have the same.

    Parameters
    ----------
    lam : float
        Damping.
    values : ndarray, shape (n, PART)
        Parts of the recorded time.
    total : ndarray, shape (TOTALS,)
        Totals of all of it.
    errors : ndarray, shape (3,)
    """
    n = values.shape[0]
    series = new_vector(n)
    ball, frame, x_square = 0.0, 0.0, 0.0
    for b in range(n):
        x_square += values[b, 0]
        frame += values[b, 1]
        ball += values[b, 2]
    # The ratio of two means, and the root of one, to first order in their deviations.
    ratio = ball / frame if frame > 0.0 else math.nan
    for b in range(n):
        series[b] = values[b, 2] - ratio * values[b, 1]
    errors[0] = error_of_mean(series, ball / n) / (frame / n) if frame > 0.0 else math.nan
    for b in range(n):
        series[b] = values[b, 3]
    spread = error_of_mean(series, total[MAX_ABS_X1])
    errors[1] = spread if spread <= ALIKE * total[MAX_ABS_X1] else math.nan
    for b in range(n):
        series[b] = values[b, 0]
    rms = math.sqrt(max(x_square, 0.0) / total[DURATION])
    error = error_of_mean(series, x_square / n)
    errors[2] = 0.5 * error * n / total[DURATION] / rms if rms > 0.0 else error
    if lam * total[DURATION] < MEMORIES * n:
        if not errors[0] <= ALIKE * ratio:
            errors[0] = math.nan
        if not errors[2] <= ALIKE * rms:
            errors[2] = math.nan


@linked_njit
def _error_of_rate(series, size):
    """Return what `error_of_mean` does, the correlation of more and shorter parts being an estimate."""
    alone, together, freedom = spread_of_mean(series)
    if alone <= ALIKE * abs(size):
        return alone
    if not freedom >= LEAST_FREEDOM:
        return math.nan
    freedom = (freedom + 1.0) * KNOWN_CORRELATION
    return together * math.sqrt(freedom / (freedom - 2.0))


@linked_njit
def errors_of_rates(growth, errors):
    """Put the standard errors of rates of growth into `errors`.

    A part in which no event fell has neither growth nor time, and the next one has the time of both: so what is
    taken of each part is its growth less that at the mean rate.

    Parameters
    ----------
    growth : ndarray, shape (n, d + 1)
        Growth in each of equal parts of time, and the time that it took.
    errors : ndarray, shape (d,)
        0 for directions that have died.
    """
    n, d = growth.shape[0], errors.shape[0]
    series = new_vector(n)
    time = 0.0
    for b in range(n):
        time += growth[b, d]
    for k in range(d):
        total = 0.0
        for b in range(n):
            total += growth[b, k]
        if not time > 0.0:
            errors[k] = math.nan
        elif total == -math.inf:
            errors[k] = 0.0
        else:
            for b in range(n):
                series[b] = growth[b, k] - total / time * growth[b, d]
            errors[k] = _error_of_rate(series, total / n) * n / time
