"""What a run on a cubic spring comes to: a stroboscope where it meets no barrier, no closing equations beside it."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._approach import nearest_orbit
from vines.attractors._judge import NEAR, ROUNDING, UNSTABLE, without_impact
from vines.attractors._multipliers import multipliers
from vines.attractors._smooth_watch import LONGEST, apart, watch_smooth
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import tangent_product
from vines.dynamics.taylor import TaylorConstants
from vines.kernels import cold_njit, complex_vector

__all__: list[str] = []


@nearest_orbit.register(TaylorConstants)
@cold_njit
def _nearest_orbit(c, rows, kept, p, lag, scale, tolerance):
    # Its orbits are shot for, from Python; here the last repetitions tell how far a run is from one.
    return False, math.nan, math.inf, math.inf


@without_impact.register(TaylorConstants)
@cold_njit
def _without_impact(c, rows, n, tolerance, verdict):
    """Judge a run without impacts by its states once a period, where its flights are started afresh."""
    verdict[v.REGIME], verdict[v.LYAPUNOV_ERROR] = v.NO_IMPACT, 0.0
    verdict[v.REMAINING] = math.nan
    last = n - 2
    told = last >= LONGEST
    scale = 1e-3
    for i in range(last + 1):
        scale = max(scale, abs(rows[i, col.A_V1]), abs(rows[i, col.A_V2]))
    best, nearest = 0, math.inf
    for p in range(1, min(LONGEST, last // 2) + 1):
        away = apart(rows, last, last - p, scale)
        if away < 0.5 * nearest:
            best, nearest = p, away
        if away <= 2.5 * tolerance:
            break
    if best == 0:
        return
    if nearest > 2.5 * tolerance:
        # Whether it comes nearer, and when it will be there.
        before = last // 2
        earlier = apart(rows, before, before - best, scale) if before >= best else math.inf
        first = max(best, last // 4)
        # A torus may come nearer by chance, but neither steadily nor near.
        steady = not told or (nearest < NEAR and earlier < apart(rows, first, first - best, scale))
        if nearest < 0.9 * earlier < math.inf and steady:
            rate = (nearest / earlier) ** (1.0 / (last - before))
            verdict[v.REGIME] = v.UNSETTLED
            verdict[v.REMAINING], verdict[v.REASON], verdict[v.VALUE] = (
                math.log(nearest / tolerance) / -math.log(rate), v.COMES, rate,
            )  # fmt: skip
        elif told:
            verdict[v.SCALE] = scale
            watch_smooth(c, rows[n - 1], tolerance, verdict)
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
