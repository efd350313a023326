"""Energy measures and energy budget of a periodic orbit over one period, from the closed forms of its flights."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import Measures
from vines.dynamics.kernels import Constants, after_impact_kernel, window_totals
from vines.dynamics.kernels import rows as column
from vines.dynamics.runs import measures_from
from vines.kernels import by_type, entry_njit, linked_njit, zero_matrix
from vines.model import Word
from vines.orbits._values import marks_of

__all__ = ["orbit_measures", "orbit_rows"]

Floats = npt.NDArray[np.float64]


@by_type(Constants)
@linked_njit
def orbit_rows(c, duration, side, t, states):
    """Return the rows of events from just after the first impact of a closed orbit to just after its return."""
    N = t.size
    rows = zero_matrix(N + 1, column.ROW)
    for k in range(N + 1):
        j = k % N
        row = rows[k]
        x1, v1, x2, v2 = states[j, 0], states[j, 1], states[j, 2], states[j, 3]
        row[column.KIND] = column.IMPACT
        row[column.SIDE] = side[j]
        row[column.TIME] = t[j] if k < N else t[0] + duration
        row[column.PHASE] = (c.Omega * t[j]) % (2.0 * math.pi)
        row[column.X1], row[column.V1], row[column.X2], row[column.V2] = x1, v1, x2, v2
        row[column.A_V1], row[column.A_V2] = after_impact_kernel(c.law, v1, v2)
        if k > 0:
            row[column.TAU] = row[column.TIME] - rows[k - 1, column.TIME]
    # The window begins just after the first impact, which is counted where it returns.
    rows[0, column.KIND] = column.START
    rows[0, column.V1] = rows[0, column.A_V1]
    rows[0, column.V2] = rows[0, column.A_V2]
    return rows


@entry_njit
def _totals(c, duration, side, t, states):
    """Return the totals of the window that these rows are."""
    return window_totals(c, orbit_rows(c, duration, side, t, states), t.size + 1, t[0], t[0] + duration)


def orbit_measures(p: Any, c: Any, word: Word, t: Floats, states: Floats) -> Measures:
    """Return the measures of one period, from just after the first impact to just after its return.

    `Measures.energy_change` is rounding, and with it `Measures.balance`.
    """
    side = marks_of(word)
    return measures_from(p, _totals(c, word.p * p.period, side, t, states))
