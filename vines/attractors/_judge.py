"""Say what a recorded window shows: a repetition, no impact, or nothing yet (docs/dynamics.md)."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._approach import CLOSED_FORM, nearest_orbit
from vines.attractors._coming import comes
from vines.attractors._contacts import difference, mirror_difference, repetition
from vines.attractors._multipliers import multipliers
from vines.dynamics.kernels import Constants, directions, drift, rate_alone, ringing, tangent_product
from vines.dynamics.kernels import rows as col
from vines.kernels import by_type, byte_vector, cold_njit, complex_vector, new_vector, njit, zero_integers
from vines.orbits.kernels import STUCK, completes, contacts, mark

__all__ = ["NEAR", "ROUNDING", "UNSTABLE", "clear", "judge_unstruck", "judge_window", "note_drift", "without_impact"]

UNSTABLE = 1e-5
"""How far the largest multiplier must lie outside the unit circle for a repeating orbit to be called unstable."""

NEAR = 1e-3
"""Runs that repeat to within this, but not to the tolerance, come to or leave a periodic orbit; they are no torus."""

CLEAR = 16.0
"""Shortest window, in forcing periods, in which a decay of these differences is believed."""

HALVED = 1e-6
"""A run that repeats, and to within this in half the time, comes to an orbit of half the period or leaves it: that
closely beside a period doubling no parameter can be set."""

ROUNDING = 1e-12
"""Differences of repetitions below this are rounding: the run comes no nearer."""

FOREVER = 1e6
"""A ball that would take more than this many forcing periods to the next wall is called without impact."""


@cold_njit
def clear(verdict):
    """Make a verdict say nothing yet."""
    for k in range(verdict.shape[0]):
        verdict[k] = math.nan if k >= v.EXPONENTS else 0.0
    verdict[v.NUDGED] = math.nan
    verdict[v.LYAPUNOV_ERROR] = math.nan


@cold_njit
def judge_window(c, rows, n, periods, tolerance, longest, verdict):
    """Fill a verdict with what a window shows; its regime is OPEN where nothing repeats within the tolerance.

    Parameters
    ----------
    c : Constants
    rows : ndarray, shape (m, ROW)
        The first n of them are the window, from time 0 to the row of its end.
    n : int
    periods : float
        Length of the window in forcing periods; repetitions of at most half of it are looked for.
    tolerance : float
        Largest distance from the periodic orbit (velocities relative to the largest speed, times absolute).
    longest : int
        Largest number of forcing periods over which a repetition is looked for.
    verdict : ndarray, shape (VERDICT,)
        Overwritten.

    Returns
    -------
    ndarray of int8
        Sides of the contacts in one repetition, in order of time, that of a complete chatter larger by STUCK; empty if
        there is none.
    """
    clear(verdict)
    kept = contacts(rows, n, 0.0)
    if kept.shape[0] == 0:
        without_impact(c, rows, n, tolerance, verdict)
        return byte_vector(0)
    period = 2.0 * math.pi / c.Omega
    scale = _largest_speed(rows, n)
    verdict[v.SCALE] = scale
    lasts = new_vector(longest + 1)
    lags = zero_integers(longest + 1)
    best, best_filled = 0, 0
    for p in range(1, min(longest, int(periods / 2.0 + 1e-9)) + 1):
        lasts[p] = math.inf
        lag, filled = repetition(rows, kept, p * period)
        if filled == 0:
            continue
        lags[p], lasts[p] = lag, difference(rows, kept, lag, p * period, scale, 0)
        # A run within the tolerance of its orbit repeats to twice that.
        if lasts[p] <= 2.5 * tolerance:
            least = p
            while least % 2 == 0 and 2 * lags[least // 2] == lags[least] and lasts[least // 2] < HALVED:
                least //= 2
            return _repeats(c, rows, n, kept, least, lags[least], lasts[least], tolerance, verdict)
        if best == 0 or lasts[p] < 0.5 * lasts[best]:
            best, best_filled = p, filled
    verdict[v.REGIME] = v.OPEN
    verdict[v.REMAINING] = math.nan
    if periods >= CLEAR and best > 0 and lasts[best] < NEAR:
        oldest = difference(rows, kept, lags[best], best * period, scale, best_filled - 1)
        if lasts[best] < oldest and comes(
            c, rows, kept, best, lags[best], best_filled, lasts[best], oldest, scale, NEAR, tolerance, verdict
        ):
            verdict[v.REGIME] = v.UNSETTLED
        else:
            verdict[v.REMAINING], verdict[v.REASON], verdict[v.VALUE] = math.nan, v.NOTHING, 0.0
    return byte_vector(0)


@njit
def note_drift(verdict, period, speed):
    """Note how many forcing periods a ball of that speed needs from wall to wall; return whether that is forever."""
    verdict[v.REMAINING] = 2.0 / (speed * period) if speed > 0.0 else math.inf
    verdict[v.REASON] = v.DRIFTS
    return not verdict[v.REMAINING] < FOREVER


@cold_njit
def judge_unstruck(verdict, p, largest, gap, nearest, tolerance):
    """Say what a motion without impacts is that repeats after p periods.

    It may sit on an unstable orbit, creep towards one that attracts, or have settled; `largest` is the size of its
    multipliers, `gap` the least distance of one from 1, `nearest` the difference of two repetitions.
    """
    if largest > 1.0 + UNSTABLE:
        verdict[v.REGIME], verdict[v.UNSTABLE] = v.UNSETTLED, 1.0
        verdict[v.REMAINING], verdict[v.REASON], verdict[v.VALUE] = math.inf, v.ON_UNSTABLE, largest
        return
    distance = nearest / gap if largest < 1.0 else math.inf
    if distance > tolerance and nearest > ROUNDING:
        verdict[v.REASON], verdict[v.VALUE], verdict[v.OTHER] = v.CREEPS, distance, largest
        verdict[v.REMAINING] = p * math.log(distance / tolerance) / -math.log(largest) if largest < 1.0 else math.inf
        return
    verdict[v.SETTLED], verdict[v.P], verdict[v.REMAINING] = 1.0, p, 0.0


@cold_njit
def _largest_speed(rows, n):
    """Return the scale of velocities and displacements, at least 1e-3 so that rest is no special case."""
    speed = 1e-3
    for i in range(n):
        if rows[i, col.KIND] == col.IMPACT:
            speed = max(speed, abs(rows[i, col.V1]), abs(rows[i, col.V2]))
    return speed


@cold_njit
def _repeats(c, rows, n, kept, p, lag, last, tolerance, verdict):
    """Judge a run that repeats: it may still be creeping towards its orbit, or sit on an unstable one."""
    count = kept.shape[0]
    span = p * 2.0 * math.pi / c.Omega
    first, end = kept[count - 1 - lag], kept[count - 1]
    d = len(directions(c))
    roots = complex_vector(d)
    largest = multipliers(tangent_product(c, rows, first, end), roots)
    for i in range(first + 1, end + 1):
        if rows[i, col.KIND] == col.STICK:
            # After a merge two directions are gone, those of the ball against the wall; what shows is rounding.
            roots[d - 2] = roots[d - 1] = 0.0
            break
    nearest = math.inf
    for k in range(d):
        size = abs(roots[k])
        nearest = min(nearest, abs(1.0 - roots[k]))
        verdict[v.EXPONENTS + d + k] = roots[k].real
        verdict[v.EXPONENTS + 2 * d + k] = roots[k].imag
        verdict[v.EXPONENTS + k] = math.log(size) / span if size > 0.0 else -math.inf
    verdict[v.LYAPUNOV_ERROR] = 0.0
    if largest > 1.0 + UNSTABLE:
        verdict[v.UNSTABLE] = 1.0
        verdict[v.REMAINING] = p * math.log(NEAR / max(last, 1e-15)) / math.log(largest)
        verdict[v.REASON], verdict[v.VALUE] = v.ON_UNSTABLE, largest
        return byte_vector(0)
    # The difference of one repetition is |1 - multiplier| of the distance that is left, or less.
    distance = last / nearest if largest < 1.0 else math.inf
    if distance > tolerance and last > ROUNDING:
        remaining = math.inf
        if largest < 1.0:
            remaining = p * math.log(distance / tolerance) / -math.log(largest)
        found, sharper, away, needed = nearest_orbit(c, rows, kept, p, lag, verdict[v.SCALE], tolerance)
        if found:
            largest, distance, remaining = sharper, away, needed
        if distance > tolerance:
            verdict[v.REASON], verdict[v.VALUE], verdict[v.OTHER] = v.CREEPS, distance, largest
            verdict[v.REMAINING] = max(remaining, 1.0 * p)
            return byte_vector(0)
    sides = byte_vector(lag)
    for k in range(lag):
        # The oldest of them: what a chatter at the end of the window becomes may not be seen any more.
        i = kept[count - 1 - lag + k]
        sides[k] = mark(rows, i)
        if sides[k] != 0:
            verdict[v.LEFT if sides[k] > 0 else v.RIGHT] += 1.0
        completed = sides[k] != 0 and completes(rows, n, i)
        if rows.shape[1] > col.ROW and not completed and count - 1 - 2 * lag + k >= 0:
            # Other balls may have hit since.
            completed = completes(rows, n, kept[count - 1 - 2 * lag + k])
        if completed:
            sides[k] += STUCK if sides[k] > 0 else -STUCK
    verdict[v.REGIME], verdict[v.SETTLED] = v.PERIODIC, 1.0
    verdict[v.P], verdict[v.LAG] = p, lag
    mirrored = mirror_difference(rows, kept, lag, span, verdict[v.SCALE])
    verdict[v.SYMMETRIC] = 1.0 if mirrored <= 1e3 * max(tolerance, distance) else 0.0
    return sides


@by_type(Constants)
@cold_njit
def without_impact(c, rows, n, tolerance, verdict):
    """Judge a run without impacts: a drifting ball will hit a wall one day; the oscillator's start must die out."""
    last = n - 1
    period = 2.0 * math.pi / c.Omega
    verdict[v.REGIME], verdict[v.LYAPUNOV_ERROR] = v.NO_IMPACT, 0.0
    d = len(directions(c))
    for k in range(d):
        verdict[v.EXPONENTS + k] = rate_alone(c, d, k)
    if not note_drift(verdict, period, drift(c, rows[last, col.A_V2]) if rows[last, col.MODE] == 0.0 else 0.0):
        verdict[v.REGIME] = v.UNSETTLED
        return
    verdict[v.REASON], verdict[v.REMAINING] = v.NOTHING, 0.0
    excess = ringing(c, rows[last, col.X1], rows[last, col.V1], rows[last, col.V2], rows[last, col.PHASE])
    if excess > max(tolerance, 1e-15):
        verdict[v.REASON], verdict[v.VALUE] = v.RINGS, excess
        verdict[v.REMAINING] = math.inf
        slowest = 0.0
        for k in range(d):
            rate = -rate_alone(c, d, k)
            slowest = rate if slowest == 0.0 or 0.0 < rate < slowest else slowest
        if slowest > 0.0:
            verdict[v.REMAINING] = math.log(excess / tolerance) / (slowest * period)
        return
    verdict[v.SETTLED] = 1.0


for _kind in CLOSED_FORM:
    without_impact.register(_kind)(without_impact.first)
