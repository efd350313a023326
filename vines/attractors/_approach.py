"""The periodic orbit that a run is near, solved for from its contacts, and how long the run still needs to it."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._contacts import difference, repetition
from vines.attractors._multipliers import carry_on, multipliers, square_of
from vines.dynamics.drag import DragConstants
from vines.dynamics.friction import FrictionConstants
from vines.dynamics.impact_pair import PairConstants
from vines.dynamics.kernels import Constants, directions, flow_basis, jump_basis, offset
from vines.dynamics.kernels import rows as col
from vines.dynamics.parallel import ParallelConstants
from vines.kernels import (
    by_type,
    cold_njit,
    complex_vector,
    identity,
    integer_vector,
    new_cube,
    new_vector,
    njit,
    zero_vector,
)
from vines.orbits.kernels import mark, newton_kernel

__all__ = [
    "CLOSED_FORM",
    "LARGEST_P",
    "NO_ORBIT",
    "STABLE",
    "UNSTABLE",
    "comes_to_orbit",
    "nearest_orbit",
    "note_coming",
]

NO_ORBIT, STABLE, UNSTABLE = range(3)

CLOSED_FORM = (DragConstants, FrictionConstants, PairConstants, ParallelConstants)
"""Constants of systems judged by the bodies of the VI-NES; where no closed form is, `_stroboscope` has others."""

ITERATIONS = 20
"""Newton steps to the orbit near a run."""

LONGEST = 24
"""Most contacts of an orbit that is solved for; the work grows as their third power."""

LARGEST_P = 8
"""Most forcing periods of an orbit that is solved for."""

BESIDE = 0.1
"""Largest distance from the run at which the orbit found is the one that the run is near."""

DOUBLINGS = 22
"""A transient is predicted up to 2^DOUBLINGS repetitions."""


@by_type(Constants)
@cold_njit
def nearest_orbit(c, rows, kept, p, lag, scale, tolerance):
    """Solve for the orbit near the last repetition of a run, and carry the distance from it on by its linear map.

    Parameters
    ----------
    c : Constants
    rows : ndarray, shape (m, ROW)
    kept : ndarray of int
        Rows that are contacts, `lag` of them in the last p forcing periods.
    p, lag : int
        Forcing periods and contacts of one repetition.
    scale : float
        Size of velocities and displacements.
    tolerance : float
        Distance at which the run counts as settled.

    Returns
    -------
    (found, largest, distance, remaining)
        Whether there is such an orbit; its largest multiplier over p periods; how far the run is from it at its last
        contact (in times, and in states relative to `scale`); forcing periods until that is below the tolerance, inf if
        the orbit is unstable.
    """
    nothing = (False, math.nan, math.inf, math.inf)
    count = kept.shape[0]
    if lag < 1 or lag > LONGEST or count < lag:
        return nothing
    first, end = kept[count - lag], kept[count - 1]
    for i in range(first, end + 1):
        # With sticking the closing equations do not hold.
        if rows[i, col.KIND] == col.STICK:
            return nothing
    duration = p * 2.0 * math.pi / c.Omega
    side = integer_vector(lag)
    guess = new_vector(lag)
    for k in range(lag):
        i = kept[count - lag + k]
        side[k] = mark(rows, i)
        guess[k] = rows[first, col.PHASE] / c.Omega + (rows[i, col.TIME] - rows[first, col.TIME])
        if k > 0 and not guess[k] > guess[k - 1]:
            return nothing
    if not guess[lag - 1] - guess[0] < duration:
        return nothing
    converged, t, _, states = newton_kernel(c, duration, side, guess, ITERATIONS)
    if not converged:
        return nothing
    distance = 0.0
    for k in range(lag):
        i = kept[count - lag + k]
        following = t[k + 1] if k + 1 < lag else t[0] + duration
        if not following > t[k] or not side[k] * (states[k, 1] - states[k, 3]) > 0.0:
            return nothing
        distance = max(distance, abs(t[k] - guess[k]), abs(states[k, 0] - rows[i, col.X1]) / scale)
        distance = max(
            distance, abs(states[k, 1] - rows[i, col.V1]) / scale, abs(states[k, 3] - rows[i, col.V2]) / scale
        )
    if not distance < BESIDE:
        return nothing

    # The tangent map of one repetition, from just after the last contact to just after that of the next one.
    event = zero_vector(rows.shape[1])
    event[col.KIND] = col.IMPACT
    d = len(directions(c))
    Y = identity(d)
    for k in range(lag):
        before = t[k - 1] if k > 0 else t[lag - 1] - duration
        flow_basis(c, 0.0, t[k] - before, Y)
        event[col.X1], event[col.V1], event[col.V2] = states[k, 0], states[k, 1], states[k, 3]
        event[col.PHASE] = c.Omega * t[k] % (2.0 * math.pi)
        if event.shape[0] > col.ROW:
            event[col.ROW] = abs(side[k])
        jump_basis(c, event, Y)
    roots = complex_vector(d)
    largest = multipliers(Y, roots)
    if not largest < 1.0:
        return True, largest, distance, math.inf

    # How far the run is from the orbit at one instant, just after its last contact.
    away = new_vector(d)
    event[col.SIDE] = 1.0 if side[lag - 1] > 0 else -1.0
    offset(c, rows[end], event, guess[lag - 1] - t[lag - 1], scale, away)
    return True, largest, distance, p * _repetitions(Y, away, distance, tolerance)


for _kind in CLOSED_FORM:
    nearest_orbit.register(_kind)(nearest_orbit.first)


@cold_njit
def _repetitions(Y, away, distance, tolerance):
    """Return after how many repetitions a difference `away` to an orbit has shrunk as `distance` has to `tolerance`."""
    if not distance > tolerance:
        return 0.0
    d = away.shape[0]
    powers = new_cube(DOUBLINGS, d, d)
    for i in range(d):
        for j in range(d):
            powers[0, i, j] = Y[i, j]
    for k in range(DOUBLINGS - 1):
        square_of(powers, k)
    later, one, other = new_vector(d), new_vector(d), new_vector(d)
    # The allowance for a state at one instant that goes with the tolerance of the contacts.
    allowed = tolerance * _size(powers, away, one, other) / distance
    repetitions = 1.0
    for k in range(DOUBLINGS - 1, -1, -1):
        carry_on(powers, k, away, later)
        if _size(powers, later, one, other) > allowed:
            away, later = later, away
            repetitions += 2.0**k
    return repetitions


@njit
def _size(powers, away, one, other):
    """Return the largest part of a difference now or at one of the next three returns: it may turn as it shrinks.

    The map of one return is the first of `powers`; `one` and `other` are room.
    """
    size = 0.0
    for i in range(away.shape[0]):
        size = max(size, abs(away[i]))
    size = max(size, carry_on(powers, 0, away, one), carry_on(powers, 0, one, other))
    return max(size, carry_on(powers, 0, other, one))


@cold_njit
def comes_to_orbit(c, rows, kept, scale, near, tolerance, verdict):
    """Look for a stable periodic orbit that a run is near; if there is one, note how long the run still needs to it.

    Parameters
    ----------
    rows, kept, scale, tolerance
        As for `nearest_orbit`.
    near : float
        How well the run must repeat at its end.
    verdict : ndarray
        REMAINING (from the last contact on), REASON and VALUE are set if the orbit is stable.

    Returns
    -------
    int
        NO_ORBIT if none was found, STABLE, or UNSTABLE if only unstable ones are near.
    """
    seen = NO_ORBIT
    for p in range(1, LARGEST_P + 1):
        span = p * 2.0 * math.pi / c.Omega
        lag, filled = repetition(rows, kept, span)
        if filled == 0 or not difference(rows, kept, lag, span, scale, 0) < near:
            continue
        found, largest, _, remaining = nearest_orbit(c, rows, kept, p, lag, scale, tolerance)
        if found and largest < 1.0:
            note_coming(verdict, remaining, largest ** (1.0 / p))
            return STABLE
        if found:
            seen = UNSTABLE
    return seen


@njit
def note_coming(verdict, remaining, rate):
    """Note that a run comes to a periodic orbit: periods that it needs, and what is left of its distance after one."""
    verdict[v.REMAINING], verdict[v.REASON], verdict[v.VALUE] = remaining, v.COMES, rate
