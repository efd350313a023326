"""What sets of sweeps are worth over one grid of two parameters, and which of them is best at each point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from vines.stages.plots._checks import called

if TYPE_CHECKING:
    import pyarrow as pa

    from vines.pipeline import Input

__all__ = ["Worth", "rank", "worth_of"]

Floats = npt.NDArray[np.float64]

_ALIKE = 1e-6
"""Relative difference below which two measures are one: they are those of settled motions, or of runs of chaos."""


@dataclass(frozen=True, slots=True)
class Worth:
    """A measure of the attractors that the sweeps of one set found over a grid.

    Attributes
    ----------
    x, y : (nx,), (ny,) array
        Values of the two parameters, ascending.
    worst, best : (ny, nx) array
        The measure of the worst and of the best attractor. Where some run failed the worst is infinite, or minus that
        where more is better: a set gains nothing from it.
    without : (ny, nx) array
        Amplitude of the oscillator with nothing attached; nan where the tables have none.
    """

    x: Floats
    y: Floats
    worst: Floats
    best: Floats
    without: Floats


def worth_of(
    stages: Sequence[Input], measure: str, better: Literal["less", "more"], size: float = 1.0, power: int = 0
) -> Worth:
    """Return what the sweeps of a set found.

    Parameters
    ----------
    stages : sequence of Input
        Sweeps over one grid of two parameters; their own starts and random ones count.
    measure : str
        A column of numbers of their points and attractors.
    better : {"less", "more"}
        Which values of it are better.
    size : float
        Factor on all lengths: the forcing amplitude A is that of the sweeps times it.
    power : int
        The measure is that of the sweeps times this power of the size.
    """
    first = stages[0]
    axes = first.axes[:2]
    sizes = [size if name == "A" else 1.0 for name in axes]
    points = first.table()
    grid = tuple(np.unique(points[name].to_numpy()) for name in axes)
    shape = (len(grid[1]), len(grid[0]))
    high, low, without = np.full(shape, -np.inf), np.full(shape, np.inf), np.full(shape, np.nan)
    failed = np.zeros(shape, dtype=bool)
    for stage in stages:
        points = stage.table()
        x, y = (np.searchsorted(values, points[name].to_numpy()) for name, values in zip(axes, grid, strict=True))
        failed[y, x] |= ~np.isfinite(_numbers(points, measure))
        if "x1_no_ball" in points.column_names:
            without[y, x] = _numbers(points, "x1_no_ball") * size
        place = dict(zip(points["point_id"].to_pylist(), zip(y.tolist(), x.tolist(), strict=True), strict=True))
        for rows in (points, *(stage.table(name) for name in (called(stage.tables, "attractors"),) if name)):
            at = np.array([place[each] for each in rows["point_id"].to_pylist()], dtype=np.int64).reshape(-1, 2).T
            values = _numbers(rows, measure)
            np.fmax.at(high, tuple(at), values)
            np.fmin.at(low, tuple(at), values)
    worst, best = (high, low) if better == "less" else (low, high)
    factor = size**power
    return Worth(
        x=grid[0] * sizes[0],
        y=grid[1] * sizes[1],
        worst=np.where(failed, np.inf if better == "less" else -np.inf, worst * factor),
        best=best * factor,
        without=without,
    )


def rank(values: Sequence[Floats], better: Literal["less", "more"]) -> tuple[npt.NDArray[np.int64], Floats]:
    """Return the place of the best of several measures at each point, -1 where none is known, and its lead.

    The lead is the ratio of the second to the best, or of the best to the second where more is better: 1 or more. Of
    those that are alike to rounding the first counts: a stop that is never met changes nothing.

    Examples
    --------
    >>> place, lead = rank([np.array([[1.0, 4.0]]), np.array([[2.0, 1.0]])], "less")
    >>> place.tolist(), lead.tolist()
    ([[0, 1]], [[2.0, 4.0]])
    """
    stacked = np.stack(values)
    known = np.where(np.isfinite(stacked), stacked if better == "less" else -stacked, np.inf)
    least = known.min(axis=0)
    place = np.argmax(known <= least + _ALIKE * np.abs(least), axis=0)
    first = np.take_along_axis(stacked, np.argmin(known, axis=0)[None], axis=0)[0]
    place[~np.isfinite(least)] = -1
    if len(values) < 2:
        return place, np.full(place.shape, np.nan)
    second = np.sort(known, axis=0)[1] * (1.0 if better == "less" else -1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        lead = second / first if better == "less" else first / second
    return place, np.where(np.isfinite(second), lead, np.nan)


def _numbers(rows: pa.Table, name: str) -> Floats:
    return rows[name].to_numpy(zero_copy_only=False).astype(np.float64)
