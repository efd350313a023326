"""Energies of the frame and of several balls over a window, and what each ball takes.

While balls ride, x1 = y - sag with y the motion of the loaded oscillator: the base then does
``(1 + mass) int e' y'' + sag (e1 - e0)``, and the mean of x1 follows from the equation of motion.
"""

from __future__ import annotations

import math

from vines.dynamics import _totals as entry
from vines.dynamics._advance import A_V1, A_V2, IMPACT, KIND, MODE, PHASE, SIDE, STICK, TAU, TIME, V1, V2, X1
from vines.dynamics._flight import advance_phase, derivatives, flight, flown, free_ball
from vines.dynamics._integrals import frame_energies, peak_between
from vines.dynamics._totals import TOTALS, ball_mass, base_at, event_loss, event_work, window_totals
from vines.dynamics.parallel._constants import BETA, MU, ParallelConstants, frame_with, of_ball, riding
from vines.dynamics.parallel._layout import BALL, R_V2, R_X2, TIES
from vines.kernels import by_type, linked_njit, njit, zero_vector

__all__ = [
    "EACH",
    "IMPACTS_LEFT",
    "IMPACTS_RIGHT",
    "LOSS_LEFT",
    "LOSS_RIGHT",
    "S_TIES",
    "V2_SQUARE",
    "add_motion",
    "add_rows",
    "count_row",
    "row_energy",
]

S_TIES = TOTALS
"""Entry of the totals of a window behind those of one ball: impacts that came together with another."""

V2_SQUARE, LOSS_LEFT, LOSS_RIGHT, IMPACTS_LEFT, IMPACTS_RIGHT = range(TOTALS + 1, TOTALS + 6)
"""Entries of the first ball; those of the next begin EACH later. V2_SQUARE is without its mass."""

EACH = 5


@ball_mass.register(ParallelConstants)
@njit
def _ball_mass(c):
    # The masses are in the totals of V2_SQUARE already.
    return 1.0


@base_at.register(ParallelConstants)
@njit
def _base_at(c, phase):
    return c.A * math.sin(phase)


@event_loss.register(ParallelConstants)
@njit
def _event_loss(c, row):
    # What a contact takes is its impulse times the mean relative velocity, however many act together.
    impulse = of_ball(c.each, int(row[BALL]) - 1, MU) * (row[A_V2] - row[V2])
    return 0.5 * impulse * ((row[V1] - row[V2]) + (row[A_V1] - row[A_V2]))


@event_work.register(ParallelConstants)
@njit
def _event_work(c, row):
    return 0.0


@by_type(ParallelConstants)
@linked_njit
def add_motion(c, out, row, begins, low, length):
    """Add the motion from `low` to `length` after a row to the totals."""
    mode = row[MODE]
    o = frame_with(c, mode)
    mass = riding(c, mode)
    start = flight(c, o, row[X1], row[A_V1], row[PHASE], row[TIME])
    phase = row[PHASE]
    if low > 0.0:
        start = flown(c, o, start, low)
        phase = advance_phase(phase, c.Omega * low)
    lasts = length - low
    end = flown(c, o, start, lasts)
    y_square, v_square, work, loss = frame_energies(c, o.own, start, end, lasts)
    x0, v0, _, _, _ = derivatives(o, c.Omega, *start)
    x1, v1, _, _, _ = derivatives(o, c.Omega, *end)
    later = phase + c.Omega * lasts
    if o.sag != 0.0:
        force = c.A * (c.lam * (math.sin(later) - math.sin(phase)) - (math.cos(later) - math.cos(phase)) / c.Omega)
        y_mean = force - (1.0 + mass) * (v1 - v0) - c.lam * (x1 - x0)
        y_square += o.sag * (o.sag * lasts - 2.0 * y_mean)
    out[entry.DURATION] += lasts
    out[entry.X1_SQUARE] += y_square
    out[entry.V1_SQUARE] += v_square
    out[entry.BASE_WORK] += (1.0 + mass) * work + o.sag * c.A * (math.sin(later) - math.sin(phase))
    out[entry.DAMPER_LOSS] += loss
    ride = int(abs(mode))
    for i in range(c.balls):
        if ride & (1 << i):
            square = v_square
        else:
            v2 = free_ball(c, row[R_V2 + 2 * i], low)[1]
            fall = c.G * lasts
            square = lasts * (v2 * v2 - fall * (v2 - fall / 3.0))
        out[V2_SQUARE + EACH * i] += square
        out[entry.V2_SQUARE] += of_ball(c.each, i, MU) * square
    if out[entry.MAX_ABS_X1] < abs(x0):
        out[entry.MAX_ABS_X1], out[entry.T_MAX_ABS_X1] = abs(x0), begins + low
    best, when = peak_between(c, o, start, end, 0.0, lasts, out[entry.MAX_ABS_X1])
    if when >= 0.0:
        out[entry.MAX_ABS_X1], out[entry.T_MAX_ABS_X1] = best, begins + low + when


@by_type(ParallelConstants)
@linked_njit
def row_energy(c, row, tau):
    """Return what is stored a time tau after a row."""
    mode = row[MODE]
    o = frame_with(c, mode)
    x, v = row[X1], row[A_V1]
    if tau > 0.0:
        motion = flown(c, o, flight(c, o, x, v, row[PHASE], row[TIME]), tau)
        x, v, _, _, _ = derivatives(o, c.Omega, *motion)
    stretch = x - base_at(c, row[PHASE] + c.Omega * tau)
    total = 0.5 * (v * v + stretch * stretch)
    ride = int(abs(mode))
    for i in range(c.balls):
        if ride & (1 << i):
            x2, v2 = x - math.copysign(of_ball(c.each, i, BETA), mode), v
        else:
            way, v2 = free_ball(c, row[R_V2 + 2 * i], tau)
            x2 = row[R_X2 + 2 * i] + way
        total += of_ball(c.each, i, MU) * (0.5 * v2 * v2 + c.G * x2)
    return total


@by_type(ParallelConstants)
@linked_njit
def count_row(c, out, row):
    """Count an impact or a merge, and what it took."""
    loss = event_loss(c, row)
    left = row[SIDE] > 0.0
    at = EACH * (int(row[BALL]) - 1)
    out[entry.LOSS_LEFT if left else entry.LOSS_RIGHT] += loss
    out[(LOSS_LEFT if left else LOSS_RIGHT) + at] += loss
    if row[KIND] == IMPACT:
        out[entry.IMPACTS_LEFT if left else entry.IMPACTS_RIGHT] += 1.0
        out[(IMPACTS_LEFT if left else IMPACTS_RIGHT) + at] += 1.0
        out[S_TIES] += 1.0 if row[TIES] > 0.0 else 0.0
    else:
        out[entry.STICKS_LEFT if left else entry.STICKS_RIGHT] += 1.0


@linked_njit
def add_rows(c, out, rows, n, start, stop):
    """Add a window to totals that are all 0 as yet, of a system whose rows hold more than the state of one ball."""
    opened = False
    energy = 0.0
    for i in range(n):
        begins = rows[i, TIME]
        if begins > stop:
            break
        counted = i > 0 and (begins > start or (begins == start and rows[0, TIME] == start))
        if counted and rows[i, KIND] in (IMPACT, STICK):
            count_row(c, out, rows[i])
        if i == n - 1:
            break
        ends = rows[i + 1, TIME]
        length = stop - begins if ends > stop else rows[i + 1, TAU]
        low = start - begins if begins < start else 0.0
        if ends < start or length < low:
            continue
        if not opened:
            opened = True
            energy = row_energy(c, rows[i], low)
        add_motion(c, out, rows[i], begins, low, length)
        if ends >= stop or i == n - 2:
            # An event that ends the window belongs to it.
            whole = i == n - 2 and ends <= stop
            out[entry.ENERGY_CHANGE] = (
                row_energy(c, rows[n - 1], 0.0) if whole else row_energy(c, rows[i], length)
            ) - energy


@window_totals.register(ParallelConstants)
@linked_njit
def _window_totals(c, rows, n, start, stop):
    out = zero_vector(TOTALS + 1 + EACH * c.balls)
    add_rows(c, out, rows, n, start, stop)
    return out
