"""Stretches of flights that no train of impacts explains yet: which pulses are impacts is tried, choice by choice."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import numpy.typing as npt

from vines.rig.fit import TAIL, Bins, JumpFit, Train

__all__ = ["unclear", "unravel"]

Floats = npt.NDArray[np.float64]
Places = npt.NDArray[np.intp]

_CLEAR = 0.8
"""Least share of flights that must be clear."""

_GRID = 1e-3
"""Distance of the times at which an impact without a pulse is tried [s]."""

_MOST = 6
"""Pulses of a stretch that are tried, the largest: 64 choices."""

_ONE, _SILENT, _LIKE = 8.0, 30.0, 16.0
"""By how much chi^2 must fall for an impact with a pulse and for one without; most that an unlikely area adds to it."""

_U_AREA = 0.1
"""Relative standard uncertainty of the area of a pulse beside others."""

_TOLD = 1e-9
"""Least part of a column that the others don't say."""

_GOOD = 9.0
"""Largest chi^2 a sample of a choice that explains a stretch."""


def unclear(fit: JumpFit) -> list[tuple[int, int]]:
    """Return first and last impact of the stretches of flights that are not those of one flight.

    None where these are many: then something else is wrong, or the rest of the run is not yet explained either.
    """
    if np.mean(fit.fair) < _CLEAR:
        return []
    unfair = np.flatnonzero(~fit.fair[1:-1]) + 1
    groups = np.split(unfair, np.flatnonzero(np.diff(unfair) > 2) + 1)
    return [(int(few[0]) - 1, int(few[-1])) for few in groups if len(few)]


def unravel(
    bins: Bins, fit: JumpFit, stretch: tuple[int, int], pulses: Train, order: int
) -> tuple[Places, Floats] | None:
    """Return which of the pulses of a stretch are impacts, and the times of impacts that have none; None if unknown.

    Parameters
    ----------
    bins : Bins
        Of the channel.
    fit : JumpFit
        Of it.
    stretch : tuple of int
        Of `unclear`.
    pulses : Train
        All pulses between the impact before the stretch and the one after it, with their areas.
    order : {0, 2}
        Derivative of x1 that the channel measures.

    Notes
    -----
    From the impact before to the impact after, the signal less all that is common to the run is one free oscillation
    and a response to each jump: a linear least squares of some hundred samples for each choice. An impact without a
    pulse is tried on a grid of times beside each.
    """
    largest = np.sort(np.argsort(-np.abs(pulses.dv), kind="stable")[:_MOST])
    t, area = pulses.t[largest], pulses.dv[largest]
    starts, s = np.append(fit.motion.starts, fit.motion.stop), fit.motion.s
    low, high = starts[stretch[0]], starts[min(stretch[1] + 3, len(starts) - 1)]
    near = (fit.left_t > low) & (fit.left_t < high)
    for one in pulses.t:
        near &= np.abs(fit.left_t - one) > TAIL * bins.smooth
    when = fit.left_t[near]
    if len(when) < 4 * (len(t) + 4):
        return None
    free = fit.motion.at(when, order) - fit.motion.forced(when, order)
    signal = fit.left[near] / bins.response(s).real + free
    usual = float(np.median(fit.left**2))
    start = s**order * np.exp(s * (when - low))

    def answer(at: Floats) -> Floats:
        tau = when[:, None] - at
        return np.where(tau > 0, (s**order * np.exp(s * tau)).imag / s.imag, 0.0)

    columns = np.column_stack([start.real, -start.imag, answer(t)])
    grid = np.arange(low + 5 * _GRID, high - 5 * _GRID, _GRID)
    tried = answer(grid)
    best: tuple[float, Places, Floats] | None = None
    for n in range(len(t) + 1):
        for some in combinations(range(len(t)), n):
            chosen = np.array(some, np.intp)
            basis, upper = np.linalg.qr(columns[:, np.append([0, 1], chosen + 2)])
            # A jump after the last sample, or two between neighbouring ones, can't be told.
            if np.min(np.abs(np.diag(upper))) < _TOLD * np.max(np.abs(upper)):
                continue
            rest = signal - basis @ (basis.T @ signal)
            jumps = np.linalg.solve(upper, basis.T @ signal)[2:]
            unlike = np.sum(np.minimum(((jumps - area[chosen]) / (_U_AREA * area[chosen])) ** 2, _LIKE))
            left = float(rest @ rest) / usual
            cost = left + _ONE * n + unlike
            if best is None or cost < best[0]:
                best = (cost, chosen, np.zeros(0)) if left < _GOOD * len(when) else best
            other = tried - basis @ (basis.T @ tried)
            size = np.sum(other**2, axis=0)
            gain = np.where(size > 1e-6 * float(np.max(size)), (rest @ other) ** 2 / np.maximum(size, 1e-30), 0.0)
            k = int(np.argmax(gain))
            left -= float(gain[k]) / usual
            cost = left + _ONE * n + _SILENT
            if left < _GOOD * len(when) and (best is None or cost < best[0]):
                best = (cost, chosen, grid[k : k + 1])
    return None if best is None else (largest[best[1]], best[2])
