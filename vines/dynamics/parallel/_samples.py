"""The state of the frame and of several balls at any time of a run, with what has been gained and lost until then."""

from __future__ import annotations

import math

from vines.dynamics import _advance as col
from vines.dynamics import _totals as entry
from vines.dynamics._flight import advance_phase, derivatives, flight, flown, free_ball
from vines.dynamics._totals import event_loss
from vines.dynamics.parallel._constants import BETA, frame_with, of_ball
from vines.dynamics.parallel._energies import EACH, add_motion
from vines.dynamics.parallel._layout import BALL, R_V2, R_X2
from vines.kernels import entry_njit, zero_vector

__all__ = ["FIRST_BALL", "sample_balls"]

FIRST_BALL = 7
"""Column of a sample with x2 of the first ball; v2 follows, then the next ball."""


@entry_njit
def sample_balls(c, rows, segment, tau, before, out):
    """Fill out[:, :] with x1, v1, phase, riding balls, base work, damper loss, impact loss, and x2, v2 of each ball.

    Places are as in `sample_rows`, in ascending order. Where `before` is set the state is the one just before the next
    row, exactly.
    """
    balls = c.balls
    sums = zero_vector(entry.TOTALS + 1 + EACH * balls)
    lost = 0.0
    done = 0
    for k in range(segment.shape[0]):
        i = segment[k]
        while done < i:
            if rows[done + 1, col.TAU] > 0.0:
                add_motion(c, sums, rows[done], 0.0, 0.0, rows[done + 1, col.TAU])
            done += 1
            if rows[done, col.KIND] in (col.IMPACT, col.STICK):
                lost += event_loss(c, rows[done])
        row = rows[i]
        modes = row[col.MODE]
        x, v, phase = row[col.X1], row[col.A_V1], row[col.PHASE]
        work, loss = sums[entry.BASE_WORK], sums[entry.DAMPER_LOSS]
        if tau[k] > 0.0:
            o = frame_with(c, modes)
            motion = flown(c, o, flight(c, o, x, v, phase, row[col.TIME]), tau[k])
            x, v, _, _, _ = derivatives(o, c.Omega, *motion)
            phase = advance_phase(phase, c.Omega * tau[k])
            part = zero_vector(len(sums))
            add_motion(c, part, row, 0.0, 0.0, tau[k])
            work += part[entry.BASE_WORK]
            loss += part[entry.DAMPER_LOSS]
        if before[k]:
            x, v, phase = rows[i + 1, col.X1], rows[i + 1, col.V1], rows[i + 1, col.PHASE]
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = x, v, phase, modes
        out[k, 4], out[k, 5], out[k, 6] = work, loss, lost
        ride = int(abs(modes))
        for j in range(balls):
            if ride & (1 << j):
                x2, v2 = x - math.copysign(of_ball(c.each, j, BETA), modes), v
            else:
                way, v2 = free_ball(c, row[R_V2 + 2 * j], tau[k])
                x2 = row[R_X2 + 2 * j] + way
            if before[k] and int(rows[i + 1, BALL]) - 1 == j:
                x2, v2 = rows[i + 1, col.X2], rows[i + 1, col.V2]
            out[k, FIRST_BALL + 2 * j], out[k, FIRST_BALL + 1 + 2 * j] = x2, v2
