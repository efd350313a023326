"""Where the gaps of all balls turn, in an orbit of any system: what a grazing in two parameters is about."""

from __future__ import annotations

from vines.dynamics.impact_pair import PairConstants
from vines.dynamics.kernels import Constants, derivatives, free_ball, launched, pull, relative, turn
from vines.dynamics.kernels import rows as col
from vines.dynamics.parallel import ParallelConstants
from vines.dynamics.parallel.kernels import R_V2, R_X2
from vines.kernels import by_type, entry_njit, new_matrix, njit
from vines.orbits._budget import orbit_rows
from vines.orbits._chains import ball_of
from vines.orbits._turning import turning_points_kernel

__all__ = ["gap_kernel", "rides", "turnings_kernel"]


@by_type(Constants)
@njit
def rides(c, row, number):
    """Return position and velocity of a ball, from 1 on, just after the event of a row."""
    return row[col.X2], row[col.A_V2]


rides.register(PairConstants)(rides.first)


@rides.register(ParallelConstants)
@njit
def _rides_of_several(c, row, number):
    return row[R_X2 + 2 * (number - 1)], row[R_V2 + 2 * (number - 1)]


@njit
def _gap(c, motion, x2, v2, tau):
    """Return w, w', w'' at tau."""
    x, v, a, _, _ = derivatives(c.free, c.Omega, *turn(c.free, c.Omega, *motion, tau))
    way, speed = free_ball(c, v2, tau)
    return x - (x2 + way), v - speed, pull(c, a)


@by_type(Constants)
@entry_njit
def gap_kernel(c, duration, side, t, states, place, number, tau):
    """Return w over half the length of the cavity, w' and w'' of a ball at time tau since the impact of a place.

    Parameters
    ----------
    c : constants of a system
    duration : float
    side : (N,) int array
        The wall times the number of the ball.
    t, states : (N,), (N, 4) float array
        The impacts of the orbit.
    place : int
    number : int
        Of the ball, from 1 on.
    tau : float
    """
    row = orbit_rows(c, duration, side, t, states)[place]
    x2, v2 = rides(c, row, number)
    motion = launched(c, c.free, row[col.X1], row[col.A_V1], v2, row[col.PHASE], 0.0)
    w, speed, bend = _gap(relative(c), motion, x2, v2, tau)
    return w / ball_of(c, number)[3], speed, bend


@by_type(Constants)
@entry_njit
def turnings_kernel(c, duration, side, t, states):
    """Return all turning points of all gaps, rows of flight, time since its start, wall, clearance, w'', ball.

    Parameters
    ----------
    c, duration, side, t, states
        As for `gap_kernel`.
    """
    rows = orbit_rows(c, duration, side, t, states)
    seen = relative(c)
    balls = 0
    for j in range(side.size):
        balls = max(balls, abs(side[j]))
    found = []
    for j in range(side.size):
        row = rows[j]
        tau = rows[j + 1, col.TIME] - row[col.TIME]
        for number in range(1, balls + 1):
            x2, v2 = rides(c, row, number)
            motion = launched(c, c.free, row[col.X1], row[col.A_V1], v2, row[col.PHASE], 0.0)
            for at in turning_points_kernel(seen, motion, v2, tau):
                w, _, bend = _gap(seen, motion, x2, v2, at)
                wall = 1.0 if bend < 0.0 else -1.0
                found.append((float(j), at, wall, ball_of(c, number)[3] - wall * w, bend, float(number)))
    out = new_matrix(len(found), 6)
    for i in range(len(found)):
        for k in range(6):
            out[i, k] = found[i][k]
    return out


for _kind in (PairConstants, ParallelConstants):
    gap_kernel.register(_kind)(gap_kernel.first)
    turnings_kernel.register(_kind)(turnings_kernel.first)
