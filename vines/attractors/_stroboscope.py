"""What a run by series comes to: a stroboscope where nothing is struck, no closing equations beside it."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._approach import nearest_orbit
from vines.attractors._judge import ROUNDING, UNSTABLE, note_drift, without_impact
from vines.attractors._multipliers import multipliers
from vines.dynamics.duffing import DuffingField
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import tangent_product
from vines.dynamics.taylor import Field, TaylorConstants
from vines.kernels import by_type, cold_njit, complex_vector, new_matrix, njit

__all__: list[str] = []

LONGEST = 32
"""Most forcing periods over which a repetition without impacts is looked for."""


@nearest_orbit.register(TaylorConstants)
@cold_njit
def _nearest_orbit(c, rows, kept, p, lag, scale, tolerance):
    # Its orbits are shot for, from Python; here the last repetitions tell how far a run is from one.
    return False, math.nan, math.inf, math.inf


@njit
def _apart(rows, i, j, scale):
    """Return how far the states just after two rows are from each other."""
    away = max(abs(rows[i, col.X1] - rows[j, col.X1]), abs(rows[i, col.A_V1] - rows[j, col.A_V1]))
    away = max(away, abs(rows[i, col.X2] - rows[j, col.X2]))
    return max(away, abs(rows[i, col.A_V2] - rows[j, col.A_V2])) / scale


@by_type(Field)
@njit
def drifts(f, period, speed, verdict):
    """Say whether the mass will meet a wall one day though nothing is struck as yet, and note when."""
    return False


@drifts.register(DuffingField)
@njit
def _drifts(f, period, speed, verdict):
    if note_drift(verdict, period, abs(speed)):
        verdict[v.REASON], verdict[v.REMAINING] = v.NOTHING, math.nan
        return False
    verdict[v.REGIME] = v.UNSETTLED
    return True


@by_type(Field)
@njit
def neighbours(f, Y, roots):
    """Fill the multipliers of a repetition, the largest first.

    Returns
    -------
    (largest, gap)
        Of those that tell how far a run is from it: the largest modulus, and the least distance from 1.
    """
    largest = multipliers(Y, roots)
    gap = math.inf
    for k in range(4):
        gap = min(gap, abs(1.0 - roots[k]))
    return largest, gap


@neighbours.register(DuffingField)
@njit
def _neighbours(f, Y, roots):
    # A ball at rest may be anywhere, and stays where it is put: only the frame comes to something.
    frame = new_matrix(2, 2)
    for i in range(2):
        for j in range(2):
            frame[i, j] = Y[i, j]
    largest = multipliers(frame, roots)
    gap = min(abs(1.0 - roots[0]), abs(1.0 - roots[1]))
    first = 2 if largest <= 1.0 else 0
    roots[first], roots[first + 1] = roots[0], roots[1]
    roots[2 - first] = roots[3 - first] = 1.0
    return largest, gap


@without_impact.register(TaylorConstants)
@cold_njit
def _without_impact(c, rows, n, tolerance, verdict):
    """Judge a run without impacts by its states once a period, where its flights are started afresh."""
    verdict[v.REGIME], verdict[v.LYAPUNOV_ERROR] = v.NO_IMPACT, 0.0
    verdict[v.REMAINING] = math.nan
    if drifts(c.field, c.period, rows[n - 1, col.A_V2], verdict):
        return
    last = n - 2
    scale = 1e-3
    for i in range(last + 1):
        scale = max(scale, abs(rows[i, col.A_V1]), abs(rows[i, col.A_V2]))
    best, nearest = 0, math.inf
    for p in range(1, min(LONGEST, last // 2) + 1):
        away = _apart(rows, last, last - p, scale)
        if away < 0.5 * nearest:
            best, nearest = p, away
        if away <= 2.5 * tolerance:
            break
    if best == 0:
        return
    if nearest > 2.5 * tolerance:
        # Whether it comes nearer, and when it will be there.
        before = last // 2
        earlier = _apart(rows, before, before - best, scale) if before >= best else math.inf
        if nearest < 0.9 * earlier < math.inf:
            rate = (nearest / earlier) ** (1.0 / (last - before))
            verdict[v.REGIME] = v.UNSETTLED
            verdict[v.REMAINING], verdict[v.REASON], verdict[v.VALUE] = (
                math.log(nearest / tolerance) / -math.log(rate), v.COMES, rate,
            )  # fmt: skip
        return
    roots = complex_vector(4)
    largest, gap = neighbours(c.field, tangent_product(c, rows, last - best, last), roots)
    for k in range(4):
        size = abs(roots[k])
        verdict[v.EXPONENTS + k] = math.log(size) / (best * c.period) if size > 0.0 else -math.inf
        verdict[v.EXPONENTS + 4 + k], verdict[v.EXPONENTS + 8 + k] = roots[k].real, roots[k].imag
    if largest > 1.0 + UNSTABLE:
        verdict[v.REGIME], verdict[v.UNSTABLE] = v.UNSETTLED, 1.0
        verdict[v.REMAINING], verdict[v.REASON], verdict[v.VALUE] = math.inf, v.ON_UNSTABLE, largest
        return
    distance = nearest / gap if largest < 1.0 else math.inf
    if distance > tolerance and nearest > ROUNDING:
        verdict[v.REASON], verdict[v.VALUE], verdict[v.OTHER] = v.CREEPS, distance, largest
        verdict[v.REMAINING] = best * math.log(distance / tolerance) / -math.log(largest) if largest < 1.0 else math.inf
        return
    verdict[v.SETTLED], verdict[v.P], verdict[v.REMAINING] = 1.0, best, 0.0
