"""What designs are worth by two measures, of which one is to be small and the other large, and the best compromises."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import called, name_axis
from vines.figures._colours import COLOURS
from vines.figures._style import font

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vines.figures._legend import Entry

__all__ = ["FrontPanel", "front_of"]

Floats = npt.NDArray[np.float64]


def front_of(least: Floats, most: Floats) -> npt.NDArray[np.int64]:
    """Return the places of the points that no other beats in both measures, by the first in ascending order.

    Examples
    --------
    >>> front_of(np.array([0.3, 0.1, 0.2, 0.2]), np.array([3.0, 1.0, 0.5, 2.0])).tolist()
    [1, 3, 0]
    """
    known = np.flatnonzero(np.isfinite(least) & np.isfinite(most))
    found: list[int] = []
    for place in known[np.lexsort((-most[known], least[known]))].tolist():
        if not found or most[place] > most[found[-1]]:
            found.append(place)
    return np.array(found, dtype=np.int64)


@dataclass(frozen=True)
class FrontPanel:
    """Designs by two measures in the colours of a parameter; a line through the best compromises.

    Attributes
    ----------
    axes : (str, str)
        The measure along x, of which less is better, and that along y, of which more is.
    x, y : (n,) array
        Both of each design.
    parameter : str
        What the colours are.
    values : (n,) array
        Its value of each design.
    log : bool
        Whether the colours are logarithmic.
    hollow : (n,) array of bool
        Designs with hollow marks: those whose balls are never hit.
    """

    axes: tuple[str, str]
    x: Floats
    y: Floats
    parameter: str
    values: Floats
    log: bool
    hollow: npt.NDArray[np.bool_]
    title: str = ""

    def draw(self, ax: Axes) -> None:
        """Draw it, with a bar of colours."""
        from matplotlib.colors import LogNorm, Normalize

        scale: Any = LogNorm if self.log else Normalize
        norm = scale(float(self.values.min()), float(self.values.max()))
        best = front_of(self.x, self.y)
        ends = [*self.x[best], float(np.nanmax(self.x, initial=0.0))]
        ax.stairs(self.y[best], ends, baseline=None, color=COLOURS["ink"], linewidth=0.9, zorder=1)
        plain: dict[str, Any] = {"cmap": "viridis", "norm": norm, "s": 7, "rasterized": True}
        shown = ax.scatter(self.x[~self.hollow], self.y[~self.hollow], c=self.values[~self.hollow], **plain, zorder=2)
        if self.hollow.any():
            rings = ax.scatter(self.x[self.hollow], self.y[self.hollow], c=self.values[self.hollow], **plain, zorder=2)
            rings.set_facecolor("none")
            rings.set_linewidth(0.7)
            edges: Any = rings.to_rgba(self.values[self.hollow])
            rings.set_edgecolor(edges)
        name_axis(ax, "x", self.axes[0])
        name_axis(ax, "y", self.axes[1])
        ax.set_xlim(left=0.0)
        ax.set_ylim(bottom=0.0)
        bar = ax.figure.colorbar(shown, ax=ax, pad=0.02)
        bar.set_label(called(self.parameter))
        if self.title:
            ax.set_title(self.title, fontsize=font(8.5))

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.lines import Line2D

        mark: Any = {"marker": "o", "markersize": 3.5, "color": COLOURS["mark"]}
        said: Sequence[Entry] = [
            ("no other design is better in both", (Line2D([], [], color=COLOURS["ink"], linewidth=0.9),)),
            ("a design", (Line2D([], [], linestyle="none", **mark),)),
        ]
        ring = ("one whose ball is never hit", (Line2D([], [], linestyle="none", markerfacecolor="none", **mark),))
        return [*said, ring] if self.hollow.any() else [*said]
