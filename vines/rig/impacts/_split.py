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

    def tried(tau: float) -> tuple[float, float, float]:
        after = np.where(t > tau, (s**order * np.exp(s * (t - tau))).imag / s.imag, 0.0)
        # Around the impact itself the smoothed signal is neither.
        fair = np.abs(t - tau) > 4.5 * bins.smooth + bins.width
        columns = np.column_stack([two, after])[fair]
        linear = np.linalg.lstsq(columns, y[fair], rcond=None)[0]
        left = float(np.sum((y[fair] - columns @ linear) ** 2)) * len(t) / max(np.count_nonzero(fair), 1)
        return left, tau, float(linear[2])

    low, high = t[_LEAST // 2], t[-_LEAST // 2]
    best = min(map(tried, np.arange(low, high, _COARSE * _GRID)), default=(np.inf, 0.0, 0.0))
    near = best[1] + _GRID * np.arange(1 - _COARSE, _COARSE)
    best = min([best, *map(tried, near[(near >= low) & (near < high)])])
    return (float(best[1]), best[2]) if best[0] < _BETTER**2 * alone else None
