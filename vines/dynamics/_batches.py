"""Standard errors by batch means: measures over equal parts of the recorded time, and their scatter."""

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
from vines.kernels import linked_njit

__all__ = ["BATCHES", "close_batch", "standard_errors"]

BATCHES = 8
"""Equal parts of the recorded time for standard errors, as many as `vines.attractors` takes."""


@linked_njit
def close_batch(mu, part, total, values):
    """Add a part to the totals, keep its kinetic ratio, largest |x1| and rms of x1, and empty it."""
    larger = part[MAX_ABS_X1] > total[MAX_ABS_X1]
    for k in range(TOTALS):
        if k not in (MAX_ABS_X1, T_MAX_ABS_X1):
            total[k] += part[k]
        elif larger:
            total[k] = part[k]
    # Where the oscillator does not move there is no ratio.
    values[0] = mu * part[V2_SQUARE] / part[V1_SQUARE] if part[V1_SQUARE] > 0.0 else math.nan
    values[1] = part[MAX_ABS_X1]
    values[2] = math.sqrt(max(part[X1_SQUARE], 0.0) / part[DURATION])
    for k in range(TOTALS):
        part[k] = 0.0


@linked_njit
def standard_errors(values, errors):
    """Put the standard errors of the means of columns of `values`, one row a batch, into `errors`."""
    n = values.shape[0]
    for k in range(errors.shape[0]):
        mean = 0.0
        for b in range(n):
            mean += values[b, k] / n
        square = 0.0
        for b in range(n):
            square += (values[b, k] - mean) ** 2
        errors[k] = math.sqrt(square / (n * (n - 1.0)))
