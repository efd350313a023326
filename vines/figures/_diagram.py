"""What a bifurcation diagram draws: simulated impacts, branches of periodic orbits, bifurcations on them."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["BranchLine", "ImpactDots", "Marker", "runs", "within"]

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ImpactDots:
    """Simulated impacts.

    Attributes
    ----------
    x : (n,) array
        Value of the varied parameter.
    side : (n,) array
        +1 on the left end, -1 on the right.
    values : dict of str to (n,) array
        What the panels show, by the names of :data:`PANELS`; ``dt`` in forcing periods.
    label : str
        For the legend.
    repeats : (n,) array, optional
        How often each dot came back while a point was observed; once if not given.
    ball : (n,) array of int, optional
        Number of the ball that hits, from 1, where balls have numbers: it gives the colour, the side the shape.
    """

    x: Floats
    side: npt.NDArray[np.integer[Any]]
    values: dict[str, Floats]
    label: str = "simulation"
    repeats: Floats | None = None
    ball: npt.NDArray[np.integer[Any]] | None = None


@dataclass(frozen=True)
class BranchLine:
    """One impact of the orbits along a branch, as a line.

    Attributes
    ----------
    x : (n,) array
        Value of the varied parameter along the branch.
    side : int
        +1 on the left end, -1 on the right, 0 for a quantity of the whole orbit.
    stable : (n,) array of bool
        Solid where true, dotted where not.
    values : dict of str to (n,) array
        As in :class:`ImpactDots`.
    label : str
        For the legend, such as ``"1:1 symmetric"``.
    family : str
        One of :data:`FAMILIES`, for the colours.
    image : bool
        Whether it is the mirror image of another line, whose flight times it shares.
    ball : int
        Number of the ball, which then gives the colour; 0 where balls have no numbers.
    stop : bool
        Whether it is of a stop in mid-cavity, and no impact.
    """

    x: Floats
    side: int
    stable: npt.NDArray[np.bool_]
    values: dict[str, Floats]
    label: str
    family: str = "symmetric"
    image: bool = False
    ball: int = 0
    stop: bool = False


@dataclass(frozen=True)
class Marker:
    """A bifurcation on a branch: its type, its place, and what the panels show there (one value an impact)."""

    type: str
    x: float
    values: dict[str, Floats]


def within(
    window: tuple[float, float], dots: Sequence[ImpactDots], lines: Sequence[BranchLine], markers: Sequence[Marker]
) -> tuple[list[ImpactDots], list[BranchLine], list[Marker]]:
    """Leave out what the window does not show, so that the other axis is scaled to the rest."""
    low, high = min(window), max(window)

    def cut(group: Any, keep: npt.NDArray[Any], *names: str) -> Any:
        columns = {name: getattr(group, name)[keep] for name in ("x", *names) if getattr(group, name) is not None}
        return replace(group, **columns, values={q: v[keep] for q, v in group.values.items()})

    shown = [cut(one, (low <= one.x) & (one.x <= high), "side", "repeats", "ball") for one in dots]
    parts = [
        # One point more at either end, so that a line reaches the border.
        cut(line, np.arange(max(start - 1, 0), min(stop + 1, len(line.x))), "stable")
        for line in lines
        for start, stop, inside in runs((low <= line.x) & (line.x <= high))
        if inside
    ]
    return shown, parts, [marker for marker in markers if low <= marker.x <= high]


def runs(flags: npt.NDArray[np.bool_]) -> list[tuple[int, int, bool]]:
    """Return the stretches of equal flags as (start, stop, flag).

    Examples
    --------
    >>> runs(np.array([True, True, False]))
    [(0, 2, True), (2, 3, False)]
    """
    if not len(flags):
        return []
    edges = np.flatnonzero(np.diff(flags.astype(np.int8))) + 1
    bounds = [0, *edges.tolist(), len(flags)]
    return [(a, b, bool(flags[a])) for a, b in itertools.pairwise(bounds)]
