"""Impacts that no pulse and no corner shows: a flight whose motion is not that of one flight is two."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from vines.rig.fit import Bins, JumpFit, Push, Train

__all__ = ["U_SILENT", "split_flights"]

Floats = npt.NDArray[np.float64]

_GRID = 1e-3
"""Distance of the times at which an impact is tried [s]."""

U_SILENT = 5e-4
"""Standard uncertainty of the time of an impact that only the motion shows [s]: half of the grid."""

_COARSE = 4
"""First in steps so many times as long: what is left changes within some ten milliseconds."""

_BETTER = 0.2
"""Largest part of the residual that may be left if a flight is split."""

_LEAST = 12


def split_flights(bins: Bins, fit: JumpFit, order: int, pushed: Push | None = None) -> Train:
    """Return the impacts that flights with a large residual ask for, one in each at most.

    Parameters
    ----------
    bins : Bins
        Of the channel.
    fit : JumpFit
        Of it.
    order : {0, 2}
        Derivative of x1 that the channel measures.
    pushed : Push, optional
        What was taken off the signal before it was fitted.

    Notes
    -----
    In each such flight the signal less the forced response is fitted by a free oscillation and a kink
    dv Im exp(s (t - tau))/gamma after tau, for each tau of a grid; the best one counts.
    """
    if pushed is not None:
        bins = replace(bins, mean=bins.mean - pushed.signal)
    starts = fit.motion.starts
    flight = np.searchsorted(starts, fit.left_t, side="right") - 1
    count = np.maximum(np.bincount(flight, minlength=len(starts)), 1)
    size = np.sqrt(np.bincount(flight, fit.left**2, len(starts)) / count)
    usual = float(np.median(size[count > _LEAST])) if (count > _LEAST).any() else np.inf
    times, dv = [], []
    for j in np.flatnonzero((size > 3 * max(usual, fit.noise)) & (count > 2 * _LEAST)):
        found = _kink(bins, fit, order, fit.left_t[flight == j], float(starts[j]))
        if found is not None:
            times.append(found[0])
            dv.append(found[1])
    return Train.alike(np.array(times), np.array(dv), U_SILENT)


def _kink(bins: Bins, fit: JumpFit, order: int, t: Floats, start: float) -> tuple[float, float] | None:
    s = fit.motion.s
    y = np.interp(t, bins.t, bins.mean) - fit.motion.forced(t, order) - fit.offset
    free = bins.response(s) * s**order * np.exp(s * (t - start))
    two = np.stack([free.real, -free.imag], axis=1)
    alone = float(np.sum((y - two @ np.linalg.lstsq(two, y, rcond=None)[0]) ** 2))
    # Around the impact itself the smoothed signal is neither.
    apart = 4.5 * bins.smooth + bins.width
    low, high = t[_LEAST // 2], t[-_LEAST // 2]
    coarse = np.arange(low, high, _COARSE * _GRID)
    if not len(coarse):
        return None

    def scanned(tau: Floats) -> float:
        turn = np.exp(-s * (tau - start)) / (bins.response(s) * s.imag)
        return float(tau[np.argmin(_left_by_kinks(t, y, two, tau, (turn.imag, -turn.real), apart))])

    near = scanned(coarse) + _GRID * np.arange(1 - _COARSE, _COARSE, dtype=np.float64)
    tau = scanned(near[(near >= low) & (near < high)])
    after = np.where(t > tau, (s**order * np.exp(s * (t - tau))).imag / s.imag, 0.0)
    fair = np.abs(t - tau) > apart
    columns = np.column_stack([two, after])[fair]
    linear = np.linalg.lstsq(columns, y[fair], rcond=None)[0]
    left = float(np.sum((y[fair] - columns @ linear) ** 2)) * len(t) / max(np.count_nonzero(fair), 1)
    return (tau, float(linear[2])) if left < _BETTER**2 * alone else None


def _left_by_kinks(
    t: Floats, y: Floats, two: Floats, tau: Floats, parts: tuple[Floats, Floats], apart: float
) -> Floats:
    """Return what a free oscillation with a kink at each time `tau` leaves, as a sum of squares over all samples.

    The kink is a combination of the two phases of the free oscillation after its time, with `parts` of each, so that
    sums over the samples before and after give all normal equations. Sums that begin at their small end keep digits.
    """
    one, other = two.T
    products = np.stack([one * one, one * other, other * other, one * y, other * y, y * y])
    none = np.zeros((6, 1))
    low, high = np.searchsorted(t, tau - apart), np.searchsorted(t, tau + apart, side="right")
    later = np.hstack([np.cumsum(products[:, ::-1], axis=1)[:, ::-1], none])[:, high]
    aa, ab, bb, ay, by, yy = np.hstack([none, np.cumsum(products, axis=1)])[:, low] + later
    a, b = parts
    ac, bc = a * later[0] + b * later[1], a * later[1] + b * later[2]
    normal = np.stack([aa, ab, ac, ab, bb, bc, ac, bc, a * ac + b * bc], axis=1).reshape(-1, 3, 3)
    right = np.stack([ay, by, a * later[3] + b * later[4]], axis=1)
    size = np.sqrt(np.maximum(np.diagonal(normal, axis1=1, axis2=2), 1e-300))
    normal, right = normal / (size[:, :, None] * size[:, None, :]), right / size
    solved = np.linalg.solve(normal + 1e-13 * np.eye(3), right[:, :, None])[:, :, 0]
    count = np.maximum(low + len(t) - high, 1)
    return (yy - np.sum(solved * right, axis=1)) * len(t) / count
