"""Energy measures and energy budget of a periodic orbit over one period, from the closed forms of its flights."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.dynamics import Measures
from vines.dynamics import _advance as column
from vines.dynamics._constants import Constants
from vines.dynamics._measures import measures_from
from vines.dynamics._totals import window_totals
from vines.model import Params, Word

__all__ = ["orbit_measures"]

Floats = npt.NDArray[np.float64]


def orbit_measures(p: Params, c: Constants, word: Word, t: Floats, states: Floats) -> Measures:
    """Return the measures of one period, from just after the first impact to just after its return.

    `Measures.energy_change` is rounding, and with it `Measures.balance`.
    """
    around = np.append(np.arange(len(t)), 0)
    rows = np.zeros((len(t) + 1, column.ROW))
    rows[:, column.KIND] = column.IMPACT
    rows[0, column.KIND] = column.START
    rows[:, column.SIDE] = np.array(word.sides)[around]
    rows[:, column.TIME] = np.append(t, t[0] + word.p * p.period)
    rows[1:, column.TAU] = np.diff(rows[:, column.TIME])
    rows[:, column.PHASE] = (p.Omega * t[around]) % (2 * np.pi)
    x1, v1, x2, v2 = states[around].T
    rows[:, column.X1], rows[:, column.V1], rows[:, column.X2], rows[:, column.V2] = x1, v1, x2, v2
    rows[:, column.A_V1] = c.keep1 * v1 + c.pass1 * v2
    rows[:, column.A_V2] = c.pass2 * v1 + c.keep2 * v2
    # The window begins just after the first impact, which is counted where it returns.
    rows[0, [column.V1, column.V2]] = rows[0, [column.A_V1, column.A_V2]]
    return measures_from(p, window_totals(c, rows, len(rows), rows[0, column.TIME], rows[-1, column.TIME]))
