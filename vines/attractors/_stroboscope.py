"""What a run on a cubic spring comes to: a stroboscope where it meets no barrier, no closing equations beside it."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._approach import nearest_orbit
from vines.attractors._judge import ROUNDING, UNSTABLE, without_impact
from vines.attractors._multipliers import multipliers
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import tangent_product
from vines.dynamics.taylor import TaylorConstants
from vines.kernels import cold_njit, complex_vector, njit

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


@without_impact.register(TaylorConstants)
@cold_njit
def _without_impact(c, rows, n, tolerance, verdict):
    """Judge a run without impacts by its states once a period, where its flights are started afresh."""
    verdict[v.REGIME], verdict[v.LYAPUNOV_ERROR] = v.NO_IMPACT, 0.0
    verdict[v.REMAINING] = math.nan
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
    largest = multipliers(tangent_product(c, rows, last - best, last), roots)
    gap = math.inf
    for k in range(4):
        size = abs(roots[k])
        gap = min(gap, abs(1.0 - roots[k]))
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
