"""The ball's flights as a camera or a second laser saw them: ballistic arcs, and the impacts where they meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import compress, pairwise

import numpy as np
import numpy.typing as npt

from vines.rig.uncertainty import robust_deviation

__all__ = ["RATE", "Flights", "find_flights", "frames"]

Floats = npt.NDArray[np.float64]
_Meeting = tuple[float, float, float, float, float, float, float, float, bool]

RATE = 1000.0
"""Positions a second that are looked at, at most: a faster sensor is averaged to this."""

_BENT = 0.1
"""Standard deviation of what bends a flight: friction of .02 g and a tilt of half a degree [m/s^2]."""

_TURN = 12.0
"""What a flight more must save of the squared residuals, beside four times the logarithm of their number."""

_LONGEST = 600
"""Positions of a flight at most; a ball that rests longer is looked at piece by piece."""

_FEW = 3
"""Positions from which the velocity of a flight is taken, at least."""

_GAP = 2.5
"""Distance of positions, in those of the sensor, in which an impact may hide."""

_SOFTEST = 5.0
"""A turn of less than so many standard uncertainties is none."""


@dataclass(frozen=True, slots=True, eq=False)
class Flights:
    """Impacts of the ball by its own positions; arrays are of the K impacts between K + 1 flights.

    Attributes
    ----------
    t, u_t : ndarray
        When the arcs before and after meet, on the clock of the sensor [s].
    x, u_x : ndarray
        Position there [m].
    v_before, v_after, u_before, u_after : ndarray
        Velocities there [m/s].
    clear : ndarray of bool
        Whether both flights have three positions and more, and no gap at the impact that could hide another one.
    noise : float
        Standard deviation of a position [m].
    lost : float
        Share of the positions that the sensor lost.
    gaps : ndarray, shape (G, 2)
        Times from and to which the ball was not seen [s]: all before the first position, all after the last, and
        between them what is longer than two positions.
    """

    t: Floats
    u_t: Floats
    x: Floats
    u_x: Floats
    v_before: Floats
    v_after: Floats
    u_before: Floats
    u_after: Floats
    clear: npt.NDArray[np.bool_]
    noise: float
    lost: float
    gaps: Floats

    def __len__(self) -> int:
        return len(self.t)

    @property
    def side(self) -> Floats:
        """+1 for an impact on the left end, from which the ball goes to the right; -1 on the right."""
        return np.sign(self.v_after - self.v_before)


def frames(
    t: Floats, x: Floats, valid: npt.NDArray[np.bool_], rate: float
) -> tuple[Floats, Floats, npt.NDArray[np.bool_], float]:
    """Return times, positions, flags and rate with at most `RATE` positions a second, as means of neighbours."""
    size = max(1, int(rate // RATE))
    if size == 1:
        return t, x, valid, rate
    count = len(x) // size
    held = valid[: count * size].reshape(count, size)
    seen = held.sum(axis=1)
    total = np.where(held, x[: count * size].reshape(count, size), 0.0).sum(axis=1)
    middle = t[: count * size].reshape(count, size).mean(axis=1)
    whole = seen == size
    return middle, np.where(whole, total / np.maximum(seen, 1), 0.0), whole, rate / size


def find_flights(t: Floats, x: Floats, valid: npt.NDArray[np.bool_], rate: float) -> Flights:
    """Cut the positions of the ball into flights.

    Parameters
    ----------
    t, x : ndarray, shape (n,)
        Times [s] and positions [m].
    valid : ndarray of bool, shape (n,)
        False where the ball was not seen.
    rate : float
        Positions a second.

    Returns
    -------
    Flights

    Notes
    -----
    The cut with the least sum of squared residuals of straight lines and a price a flight, among all cuts (dynamic
    programming, with the pruning of Killick, Fearnhead and Eckley 2012). Flights that one arc of the ball's friction
    explains are one; the frame that an impact falls into, which shows the ball before and after, counts for neither.

    Examples
    --------
    >>> t = np.arange(400) / 500
    >>> x = np.abs((t * 4 + 0.3) % 2 - 1) * 0.02
    >>> found = find_flights(t, x, np.ones(400, bool), 500.0)
    >>> len(found), bool(np.allclose(np.diff(found.t), 0.25))
    (3, True)
    """
    t, x, valid, rate = frames(t, x, valid, rate)
    lost = 1 - float(np.mean(valid)) if len(valid) else 1.0
    t, x = t[valid], x[valid]
    if len(t) < 2 * _FEW:
        return _flights([], 0.0, lost, np.array([[-np.inf, np.inf]]))
    noise = max(robust_deviation(np.diff(x, 3)) / float(np.sqrt(20.0)), 1e-9)
    apart = np.flatnonzero(np.diff(t) > _GAP / rate)
    gaps = np.array([[-np.inf, t[0]], *zip(t[apart], t[apart + 1], strict=True), [t[-1], np.inf]])
    edges = _joined(t, x, noise, _sharp(t, x, noise, _cut(t - t[0], x, noise), rate))
    while True:
        rows = [_meeting(t, x, noise, edges, k, rate) for k in range(1, len(edges) - 1)]
        real = [abs(row[5] - row[4]) > _SOFTEST * np.hypot(row[6], row[7]) for row in rows]
        if all(real):
            break
        edges = [edges[0], *compress(edges[1:-1], real), edges[-1]]
    # Where arcs do not meet between their positions there is no single impact between them.
    met = [
        row
        for row, edge in zip(rows, edges[1:-1], strict=True)
        if t[edge - 1] - 1.5 / rate < row[0] < t[edge] + 1.5 / rate
    ]
    return _flights(met, noise, lost, gaps)


def _flights(rows: Sequence[_Meeting], noise: float, lost: float, gaps: Floats) -> Flights:
    t, u_t, x, u_x, before, after, u_before, u_after, clear = np.array(rows, dtype=np.float64).reshape(-1, 9).T
    return Flights(t, u_t, x, u_x, before, after, u_before, u_after, clear > 0, noise, lost, gaps)


def _cut(t: Floats, x: Floats, noise: float) -> list[int]:
    """Return the first position of each flight, and the number of positions at the end."""
    n = len(t)
    price = _TURN + 4 * np.log(n)
    # Lines over positions i to j - 1 by running sums; steps of the sums are small beside their digits.
    sums = [np.concatenate([[0.0], np.cumsum(values)]) for values in (np.ones(n), t, t * t, x, t * x, x * x)]
    best = np.full(n + 1, np.inf)
    best[0] = -price
    before = np.zeros(n + 1, np.intp)
    starts = np.array([0])
    for j in range(2, n + 1):
        size, st, stt, sx, stx, sxx = (total[j] - total[starts] for total in sums)
        size = np.maximum(size, 1)
        var, cov = stt - st * st / size, stx - st * sx / size
        rest = sxx - sx * sx / size - np.divide(cov * cov, var, out=np.zeros(len(starts)), where=var > 0)
        cost = best[starts] + np.maximum(rest, 0.0) / noise**2
        k = int(np.argmin(cost))
        best[j], before[j] = cost[k] + price, starts[k]
        # A start that is dearer than the best cut by a whole flight can never be part of it.
        starts = np.append(starts[(cost < best[j]) & (starts > j - _LONGEST)], j - 1)
    edges = [n]
    while edges[-1] > 0:
        edges.append(int(before[edges[-1]]))
    return edges[::-1]


def _sharp(t: Floats, x: Floats, noise: float, edges: list[int], rate: float) -> list[int]:
    """Return the edges without flights of one or two positions that are the blur of an impact beside them."""
    kept, k = [edges[0]], 1
    while k < len(edges) - 1:
        low, high = edges[k], edges[k + 1]
        wide = k + 2 < len(edges) and min(low - kept[-1], edges[k + 2] - high) >= _FEW
        if high - low < _FEW and wide:
            at = 0.5 * float(t[low] + t[high - 1])
            p, q = (_arc(t[span], x[span], noise, at)[0] for span in (slice(kept[-1], low), slice(high, edges[k + 2])))
            meet = at + (p[0] - q[0]) / (q[1] - p[1]) if q[1] != p[1] else np.inf
            if t[low] - 0.6 / rate <= meet <= t[high - 1] + 0.6 / rate:
                kept.append(int(np.clip(np.searchsorted(t, meet), low, high)))
                k += 2
                continue
        kept.append(low)
        k += 1
    return [*kept, edges[-1]]


def _joined(t: Floats, x: Floats, noise: float, edges: list[int]) -> list[int]:
    """Return the edges of flights without those in one arc: friction bends a flight a little."""
    kept = [edges[0]]
    for edge, after in pairwise(edges[1:]):
        span = slice(kept[-1], after)
        _, _, rest = _arc(t[span], x[span], noise, float(t[edge]))
        if rest > after - kept[-1] + _TURN + 4 * np.sqrt(after - kept[-1]):
            kept.append(edge)
    return [*kept, edges[-1]]


def _arc(t: Floats, x: Floats, noise: float, at: float) -> tuple[Floats, Floats, float]:
    """Return position, velocity and acceleration at a time, their covariance, and the squared residuals over noise."""
    away = t - at
    columns = np.stack([np.ones(len(t)), away, 0.5 * away**2])
    normal = columns @ columns.T / noise**2
    normal[2, 2] += 1 / _BENT**2
    normal += np.diag([1e-12, 1e-12, 0.0]) * np.trace(normal)
    covariance = np.linalg.inv(normal)
    found = covariance @ (columns @ x) / noise**2
    return found, covariance, float(np.sum((x - found @ columns) ** 2)) / noise**2


def _meeting(t: Floats, x: Floats, noise: float, edges: list[int], k: int, rate: float) -> _Meeting:
    """Return the impact between two flights: the columns of `Flights`."""
    low, middle, high = edges[k - 1 : k + 2]
    at = 0.5 * float(t[middle - 1] + t[middle])
    before, after = early, late = np.arange(low, middle), np.arange(middle, high)
    (p, cp, _), (q, cq, _) = _arc(t[early], x[early], noise, at), _arc(t[late], x[late], noise, at)
    for _ in range(3):
        turn = q[1] - p[1]
        step = (p[0] - q[0]) / turn if turn else 0.0
        at += float(np.clip(step, -2 / rate, 2 / rate))
        # A frame lasts: what it shows beside the impact is a mean of both flights.
        before, after = early[t[early] < at - 0.5 / rate], late[t[late] > at + 0.5 / rate]
        before, after = before if len(before) > 1 else early, after if len(after) > 1 else late
        (p, cp, _), (q, cq, _) = _arc(t[before], x[before], noise, at), _arc(t[after], x[after], noise, at)
    turn = max(abs(q[1] - p[1]), 1e-9)
    u_p, u_q = np.sqrt(cp[0, 0]), np.sqrt(cq[0, 0])
    # Where both arcs are, weighted by how well each tells it.
    where = (p[0] / cp[0, 0] + q[0] / cq[0, 0]) / (1 / cp[0, 0] + 1 / cq[0, 0])
    gap = float(t[middle] - t[middle - 1]) * rate
    clear = min(len(before), len(after)) >= _FEW and gap < _GAP
    return (
        at, float(np.hypot(u_p, u_q)) / turn, float(where), float(1 / np.hypot(1 / u_p, 1 / u_q)),
        float(p[1]), float(q[1]), float(np.sqrt(cp[1, 1])), float(np.sqrt(cq[1, 1])), clear,
    )  # fmt: skip
