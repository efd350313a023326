"""The state at any time of a run by series, with what has been gained and lost until then."""

from __future__ import annotations

from vines.dynamics import _advance as col
from vines.dynamics import _totals as entry
from vines.dynamics._totals import add_segment, event_loss, segment_state
from vines.dynamics.taylor._constants import TaylorConstants
from vines.dynamics.taylor._energies import VISCOUS_LOSS
from vines.kernels import by_type, copy_values, entry_njit, linked_njit, zero_vector

__all__ = ["OF_ONE_BALL", "add_and_carry", "sample_flights"]

OF_ONE_BALL = 10
"""Columns of a sample; behind them is what rows have at their ends."""


@by_type(TaylorConstants)
@linked_njit
def add_and_carry(c, sums, row, tau):
    """Add the motion over tau after a row to totals of a window, and let the row be what it is then."""
    add_segment(
        c, sums, row[col.MODE], 0.0, row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2], row[col.PHASE], tau
    )
    x1, v1, x2, v2, phase = segment_state(c, row, tau)
    row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2], row[col.PHASE] = x1, v1, x2, v2, phase


@entry_njit
def sample_flights(c, rows, segment, tau, before, sums, out):
    """Fill out[:, :] with x1, v1, x2, v2, phase, stuck, base work, damper, impact and viscous loss at given places.

    Places are as in `vines.dynamics._totals.sample_rows`, in ascending order: each flight is followed once. `sums` is
    room for the totals of a window, all 0; what `out` has further columns for are the last ones of rows.
    """
    more = out.shape[1] - OF_ONE_BALL
    lost = 0.0
    done = 0
    gone = 0.0
    here = zero_vector(rows.shape[1])
    copy_values(here, rows[0])
    for k in range(segment.shape[0]):
        i = segment[k]
        while done < i:
            rest = rows[done + 1, col.TAU] - gone
            if rest > 0.0:
                add_and_carry(c, sums, here, rest)
            done += 1
            gone = 0.0
            copy_values(here, rows[done])
            if rows[done, col.KIND] in (col.IMPACT, col.STICK):
                lost += event_loss(c, rows[done])
        if tau[k] > gone:
            add_and_carry(c, sums, here, tau[k] - gone)
            gone = tau[k]
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = here[col.X1], here[col.A_V1], here[col.X2], here[col.A_V2]
        out[k, 4] = here[col.PHASE]
        if before[k]:
            after = rows[i + 1]
            out[k, 0], out[k, 1], out[k, 2], out[k, 3] = after[col.X1], after[col.V1], after[col.X2], after[col.V2]
            out[k, 4] = after[col.PHASE]
        out[k, 5] = here[col.MODE]
        out[k, 6], out[k, 7], out[k, 8] = sums[entry.BASE_WORK], sums[entry.DAMPER_LOSS], lost
        out[k, 9] = sums[VISCOUS_LOSS]
        for j in range(more):
            out[k, OF_ONE_BALL + j] = here[here.shape[0] - more + j]
