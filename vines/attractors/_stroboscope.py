"""What a run by series comes to: a stroboscope where it hits nothing, no closing equations beside it."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._approach import nearest_orbit
from vines.attractors._judge import NEAR, judge_unstruck, note_drift, without_impact
from vines.attractors._multipliers import multipliers
from vines.attractors._smooth_watch import LONGEST, apart, held, watch_smooth
from vines.dynamics.duffing import DuffingField
from vines.dynamics.hybrid import HybridConstants
from vines.dynamics.kernels import directions, tangent_product
from vines.dynamics.kernels import rows as col
from vines.dynamics.taylor import Field, TaylorConstants
from vines.kernels import by_type, cold_njit, complex_vector, new_matrix, njit

__all__: list[str] = []


@nearest_orbit.register(TaylorConstants)
@cold_njit
def _nearest_orbit(c, rows, kept, p, lag, scale, tolerance):
    # Its orbits are shot for, from Python; here the last repetitions tell how far a run is from one.
    return False, math.nan, math.inf, math.inf


nearest_orbit.register(HybridConstants)(_nearest_orbit)


@by_type(TaylorConstants)
@cold_njit
def _roots(c, rows, first, last, roots):
    """Fill the multipliers from one row to another, those first that are 1 for any motion; return their number."""
    return _roots_of(c.field, tangent_product(c, rows, first, last), roots)


@by_type(Field)
@cold_njit
def _roots_of(f, Y, roots):
    multipliers(Y, roots)
    return 0


@_roots_of.register(DuffingField)
@cold_njit
def _roots_of_a_frame(f, Y, roots):
    # The ball acts on nothing, and keeps what it is given.
    frame = new_matrix(2, 2)
    for i in range(2):
        for k in range(2):
            frame[i, k] = Y[i, k]
    multipliers(frame, roots[2:])
    roots[0] = roots[1] = 1.0
    return 2


@_roots.register(HybridConstants)
@cold_njit
def _roots_beside(c, rows, first, last, roots):
    Y = tangent_product(c, rows, first, last)
    # The ball acts on nothing, and keeps what it is given in position and velocity.
    own = new_matrix(4, 4)
    for i in range(4):
        for k in range(4):
            own[i, k] = Y[i if i < 2 else i + 2, k if k < 2 else k + 2]
    multipliers(own, roots[2:])
    roots[0] = roots[1] = 1.0
    return 2


@by_type(TaylorConstants)
@njit
def _stays(c, rows, last, verdict):
    """Say whether what flies freely, if anything does, comes to no wall within sight."""
    rides = rows[last, col.MODE] != 0.0
    return _stays_free(c.field, c.period, 0.0 if rides else abs(rows[last, col.A_V2]), verdict)


@by_type(Field)
@njit
def _stays_free(f, period, speed, verdict):
    return True


@_stays_free.register(DuffingField)
@njit
def _ball_stays_free(f, period, speed, verdict):
    return note_drift(verdict, period, speed)


@_stays.register(HybridConstants)
@njit
def _ball_stays(c, rows, last, verdict):
    rides = rows[last, col.MODE] != 0.0
    return note_drift(verdict, c.period, 0.0 if rides else abs(rows[last, col.A_V2]))


@without_impact.register(TaylorConstants)
@cold_njit
def _without_impact(c, rows, n, tolerance, verdict):
    """Judge a run without impacts by its states once a period, where its flights are started afresh."""
    verdict[v.REGIME], verdict[v.LYAPUNOV_ERROR] = v.NO_IMPACT, 0.0
    last = n - 2
    # A ball that rides is carried by the frame, and no free one.
    told = last >= LONGEST and (held(c) == len(directions(c)) or rows[n - 1, col.MODE] == 0.0)
    if not _stays(c, rows, n - 1, verdict):
        verdict[v.REGIME] = v.UNSETTLED
        return
    verdict[v.REMAINING], verdict[v.REASON] = math.nan, v.NOTHING
    scale = 1e-3
    for i in range(last + 1):
        scale = max(scale, abs(rows[i, col.A_V1]), abs(rows[i, col.A_V2]))
    best, nearest = 0, math.inf
    for p in range(1, min(LONGEST, last // 2) + 1):
        away = apart(c, rows, last, last - p) / scale
        if away < 0.5 * nearest:
            best, nearest = p, away
        if away <= 2.5 * tolerance:
            break
    if best == 0:
        return
    if nearest > 2.5 * tolerance:
        # Whether it comes nearer, and when it will be there.
        before = last // 2
        earlier = apart(c, rows, before, before - best) / scale if before >= best else math.inf
        first = max(best, last // 4)
        # A torus may come nearer by chance, but neither steadily nor near.
        steady = not told or (nearest < NEAR and earlier < apart(c, rows, first, first - best) / scale)
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
    d = len(directions(c))
    roots = complex_vector(d)
    given = _roots(c, rows, last - best, last, roots)
    largest = abs(roots[given])
    gap = math.inf
    for k in range(d):
        size = abs(roots[k])
        gap = min(gap, abs(1.0 - roots[k])) if k >= given else gap
        verdict[v.EXPONENTS + k] = math.log(size) / (best * c.period) if size > 0.0 else -math.inf
        verdict[v.EXPONENTS + d + k], verdict[v.EXPONENTS + 2 * d + k] = roots[k].real, roots[k].imag
    judge_unstruck(verdict, best, largest, gap, nearest, tolerance)


without_impact.register(HybridConstants)(_without_impact)
