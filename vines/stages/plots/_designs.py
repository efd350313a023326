"""What designs are worth over a range of forcing: the worst of all attractors, and the size of cavities that suits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pyarrow as pa

__all__ = ["Best", "Designs", "designs_of"]

Floats = npt.NDArray[np.float64]

_SAME = 1e-9
"""Relative distance within which two values of a grid are one."""


@dataclass(frozen=True, slots=True)
class Best:
    """The design and the size with the least worst measure over a range of the forcing.

    Attributes
    ----------
    place : tuple of int
        Place of the design on the axes of `Designs`.
    first, last : int
        The range, as places of `Designs.over`.
    size : float
        Factor on all lengths that moves that range to the one asked for.
    worst : float
        The measure.
    """

    place: tuple[int, ...]
    first: int
    last: int
    size: float
    worst: float


@dataclass(frozen=True, slots=True)
class Designs:
    """A measure of all attractors found over a grid of designs and values of the forcing.

    Attributes
    ----------
    axes : tuple of str
        Parameters that make a design.
    values : tuple of array
        Their values, ascending.
    over : (n,) array
        The forcing, ascending.
    worst, least : (..., n) array
        Largest and smallest measure of the attractors that were found, along `axes` and `over`. Where some run failed
        the worst is infinite: a design gains nothing from it.
    """

    axes: tuple[str, ...]
    values: tuple[Floats, ...]
    over: Floats
    worst: Floats
    least: Floats

    def windows(self, factor: float) -> Floats:
        """Return the worst measure of each design in each range from ``over[i]`` to `factor` times that.

        Returns
        -------
        (..., m) array
            For the m values of `over` from which such a range lies on the grid; m may be 0.
        """
        ends = self._ends(factor)
        parts = [self.worst[..., first : last + 1].max(axis=-1) for first, last in enumerate(ends)]
        return np.stack(parts, axis=-1) if parts else np.empty((*self.worst.shape[:-1], 0))

    def best(self, low: float, high: float) -> Best | None:
        """Return the best design and size for a range of the forcing, or None where the grid holds no such range.

        With all lengths times a size the motion is that at the forcing over the size, times the size; so the grid tells
        of every size. A reduction does not change with it.
        """
        found = self.windows(high / low)
        if not found.size:
            return None
        *place, first = map(int, np.unravel_index(int(np.argmin(found)), found.shape))
        last = self._ends(high / low)[first]
        return Best(tuple(place), first, last, low / float(self.over[first]), float(found[(*place, first)]))

    def _ends(self, factor: float) -> list[int]:
        """Return for each start of a range on the grid where it ends."""
        ends = []
        for start in self.over:
            if self.over[-1] < start * factor * (1 - _SAME):
                break
            ends.append(int(np.searchsorted(self.over, start * factor * (1 + _SAME), side="right")) - 1)
        return ends


def designs_of(tables: Sequence[pa.Table], axes: tuple[str, ...], over: str, measure: str) -> Designs:
    """Return the designs of sweeps over one grid that differ in where their runs start.

    Parameters
    ----------
    tables : sequence of pyarrow.Table
        Points of the sweeps.
    axes : tuple of str
        Parameters that make a design.
    over : str
        The parameter of the forcing.
    measure : str
        A column; less of it is better.
    """
    names = (*axes, over)
    values = tuple(np.unique(tables[0][name].to_numpy()) for name in names)
    shape = tuple(len(each) for each in values)
    worst, least = np.full(shape, -np.inf), np.full(shape, np.inf)
    for table in tables:
        column = table[measure].to_numpy(zero_copy_only=False).astype(np.float64)
        at = tuple(np.searchsorted(each, table[name].to_numpy()) for name, each in zip(names, values, strict=True))
        worst[at] = np.maximum(worst[at], np.where(np.isfinite(column), column, np.inf))
        least[at] = np.fmin(least[at], column)
    return Designs(axes, values[:-1], values[-1], worst, least)
