"""Names written into the regions of a map."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._style import font

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["LABELS", "write_region_names"]

LABELS = 9
"""Most names written into a map."""

LEAST = 0.004
"""Smallest share of the map that a region must fill for its name to be written into it."""

ROOM = 0.01
"""Least distance of a name from the edge of its region, in parts of the map's longer side: else names run together."""
_DEEP = 2.0
"""Points of a map that it is from the edge of its region at least, whatever their number."""
_WIDEST = 1.1
"""Width of a name, over that of its region, from which it is left out where it need not be written."""


def write_region_names(
    ax: Axes,
    x: npt.NDArray[np.float64],
    y: npt.NDArray[np.float64],
    names: npt.NDArray[np.object_],
    *,
    wider: bool = True,
) -> None:
    """Write the names of the largest regions where they are widest.

    Parameters
    ----------
    ax : matplotlib Axes
        The map.
    x, y : (nx,), (ny,) array
        Values along its axes.
    names : (ny, nx) array of object
        Name of the region that each point belongs to; None for none.
    wider : bool
        Whether a name may be wider than its region; where a legend has all names it need not.
    """
    from matplotlib.patheffects import withStroke
    from scipy.ndimage import distance_transform_edt, label

    regions = []
    for name in sorted({name for name in names.ravel() if name}):
        found: Any = label(np.equal(names, name))
        parts, count = found
        sizes = np.bincount(parts.ravel(), minlength=count + 1)
        for k in np.flatnonzero(sizes >= LEAST * names.size):
            if k:
                regions.append((int(sizes[k]), name, parts == k))
    for _, name, inside in sorted(regions, key=lambda region: -region[0])[:LABELS]:
        # The frame counts as an edge, so that no name is cut by it.
        depth = np.asarray(distance_transform_edt(np.pad(inside, 1)))[1:-1, 1:-1]
        # a band is as wide in many places: its middle is the best of them
        deepest = np.argwhere(depth >= 0.999 * depth.max())
        row, column = map(int, deepest[np.argmin(np.hypot(*(deepest - deepest.mean(axis=0)).T))])
        if depth[row, column] < max(_DEEP, ROOM * max(depth.shape)):
            continue
        written = ax.text(
            float(x[column]),
            float(y[row]),
            name,
            ha="center",
            va="center",
            fontsize=font(7),
            color="#000000",
            path_effects=[withStroke(linewidth=1.6, foreground="#ffffff")],
        )
        if not wider and written.get_window_extent().width > _WIDEST * _across(
            ax, x, float(y[row]), inside[row], column
        ):
            written.remove()


def _across(ax: Axes, x: npt.NDArray[np.float64], level: float, inside: npt.NDArray[np.bool_], column: int) -> float:
    """Return how far a region reaches along its row [px], about: panels are laid out later."""
    ends = np.flatnonzero(~np.concatenate([[False], inside, [False]]))
    first, last = int(ends[ends <= column].max()), int(ends[ends > column].min()) - 2
    left, right = ax.transData.transform([(float(x[first]), level), (float(x[last]), level)])[:, 0]
    return float(abs(right - left)) * (last - first + 1) / max(last - first, 1)
