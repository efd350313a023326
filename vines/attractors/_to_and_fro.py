"""What a run with friction comes to that neither hits nor stops: it is judged by its turns, where w' = 0."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._judge import judge_unstruck, note_drift, without_impact
from vines.attractors._multipliers import multipliers
from vines.dynamics.friction import FrictionConstants
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import tangent_product
from vines.kernels import cold_njit, complex_vector, njit

__all__: list[str] = []

LONGEST = 16
"""Most forcing periods over which a repetition of turns is looked for."""

_at_rest = without_impact.first


@njit
def _turn_before(rows, i):
    """Return the last turn before a row, -1 if there is none."""
    i -= 1
    while i >= 0 and not (rows[i, col.KIND] == col.SLIDE and rows[i, col.RUN] == 0.0):
        i -= 1
    return i


@njit
def _apart(c, rows, i, j, p, scale):
    """Return how far turn i is from the repetition of turn j p periods later: frame and time, and place of the ball."""
    away = max(abs(rows[i, col.X1] - rows[j, col.X1]), abs(rows[i, col.V1] - rows[j, col.V1]))
    late = rows[i, col.TIME] - rows[j, col.TIME] - p * c.period
    return max(away, abs(late) * scale) / scale, abs(rows[i, col.X2] - rows[j, col.X2]) / scale


@njit
def _turn_near(rows, i, t):
    """Return the turn in the sense of turn i that is nearest to an earlier time, -1 if there is none."""
    best, nearest, j = -1, math.inf, i
    while True:
        j = _turn_before(rows, j)
        if j < 0:
            return best
        if rows[j, col.SIDE] == rows[i, col.SIDE]:
            away = abs(rows[j, col.TIME] - t)
            if away >= nearest:
                return best
            best, nearest = j, away


@without_impact.register(FrictionConstants)
@cold_njit
def _without_impact(c, rows, n, tolerance, verdict):
    last = _turn_before(rows, n)
    if last < 0 or rows[n - 1, col.MODE] != 0.0 or rows[n - 1, col.TIME] - rows[last, col.TIME] > LONGEST * c.period:
        _at_rest(c, rows, n, tolerance, verdict)
        return
    verdict[v.REGIME], verdict[v.LYAPUNOV_ERROR], verdict[v.REMAINING] = v.NO_IMPACT, 0.0, math.nan
    scale = max(1e-3, abs(rows[last, col.V1]))
    for i in range(n):
        scale = max(scale, abs(rows[i, col.A_V1]), abs(rows[i, col.A_V2]))
    best, earlier, nearest = 0, -1, math.inf
    for p in range(1, LONGEST + 1):
        j = _turn_near(rows, last, rows[last, col.TIME] - p * c.period)
        if j < 0:
            break
        away, shift = _apart(c, rows, last, j, p, scale)
        if max(away, shift) < 0.5 * nearest:
            best, earlier, nearest = p, j, max(away, shift)
        if away <= 2.5 * tolerance:
            if shift > 2.5 * tolerance:
                # The frame repeats, and the ball comes nearer to a wall each time.
                note_drift(verdict, c.period, shift * scale / (p * c.period))
                return
            break
    if best == 0:
        return
    roots = complex_vector(4)
    multipliers(tangent_product(c, rows, earlier, last), roots)
    # Where in the cavity it slides makes no difference, so that one of them is 1.
    shifted = 0
    for k in range(4):
        if abs(1.0 - roots[k]) < abs(1.0 - roots[shifted]):
            shifted = k
    largest, gap = 0.0, math.inf
    for k in range(4):
        size = abs(roots[k])
        verdict[v.EXPONENTS + k] = math.log(size) / (best * c.period) if size > 0.0 else -math.inf
        verdict[v.EXPONENTS + 4 + k], verdict[v.EXPONENTS + 8 + k] = roots[k].real, roots[k].imag
        if k != shifted:
            largest, gap = max(largest, size), min(gap, abs(1.0 - roots[k]))
    judge_unstruck(verdict, best, largest, gap, nearest, tolerance)
