"""The state of structure, modes and ball at any time of a run, with what has been gained and lost until then."""

from __future__ import annotations

from vines.dynamics import _advance as col
from vines.dynamics import _totals as entry
from vines.dynamics._totals import event_loss, event_work, segment_state
from vines.dynamics.modes._energies import of_row
from vines.dynamics.modes._jet import modal_at
from vines.dynamics.modes._layout import EACH, R_MODAL
from vines.dynamics.parallel._energies import add_motion
from vines.kernels import entry_njit, zero_vector

__all__ = ["FIRST_MODE", "sample_modes"]

FIRST_MODE = 9
"""Column of a sample with the amplitude of the first mode; its velocity follows, then the next mode."""


@entry_njit
def sample_modes(c, rows, segment, tau, before, out):
    """Fill out[:, :] with x1, v1, x2, v2, phase, stuck, base work, damper loss, impact loss, and the modes.

    Places are as in `vines.dynamics._totals.sample_rows`, in ascending order. Where `before` is set the state is the
    one just before the next row, exactly.
    """
    n = 2 * c.modes
    sums, part = zero_vector(entry.TOTALS + EACH * c.modes), zero_vector(entry.TOTALS + EACH * c.modes)
    done = 0
    lost = 0.0
    for k in range(segment.shape[0]):
        i = segment[k]
        while done < i:
            if rows[done + 1, col.TAU] > 0.0:
                add_motion(c, sums, rows[done], 0.0, 0.0, rows[done + 1, col.TAU])
            done += 1
            if rows[done, col.KIND] in (col.IMPACT, col.STICK):
                lost += event_loss(c, rows[done])
                sums[entry.BASE_WORK] += event_work(c, rows[done])
        row = rows[i]
        x1, v1, x2, v2, phase = row[col.X1], row[col.A_V1], row[col.X2], row[col.A_V2], row[col.PHASE]
        for m in range(n):
            out[k, FIRST_MODE + m] = row[R_MODAL + m]
        out[k, 6], out[k, 7], out[k, 8] = sums[entry.BASE_WORK], sums[entry.DAMPER_LOSS], lost
        if tau[k] > 0.0:
            x1, v1, x2, v2, phase = segment_state(c, row, tau[k])
            for m in range(part.shape[0]):
                part[m] = 0.0
            add_motion(c, part, row, 0.0, 0.0, tau[k])
            out[k, 6] += part[entry.BASE_WORK]
            out[k, 7] += part[entry.DAMPER_LOSS]
            o, _ = of_row(c, row)
            modal_at(c, o, tau[k], out[k], FIRST_MODE)
        if before[k]:
            after = rows[i + 1]
            x1, v1, x2, v2, phase = after[col.X1], after[col.V1], after[col.X2], after[col.V2], after[col.PHASE]
        out[k, 0], out[k, 1], out[k, 2], out[k, 3], out[k, 4], out[k, 5] = x1, v1, x2, v2, phase, row[col.MODE]
