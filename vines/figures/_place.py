"""Place the legends of panels where they cover nothing that is drawn, if there is such a place."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["place_in_panels"]

_PLACES = 33
"""Places that are tried along each side of a panel; nine is what matplotlib itself tries."""
_EDGE = 5.0
"""Points between a legend and the frame of its panel."""
_BEST = 0
"""What matplotlib keeps for ``loc="best"``."""


def place_in_panels(figure: Figure) -> None:
    """Move the legends of panels that may stand anywhere to where they cover least, nearest to a corner.

    Parameters
    ----------
    figure : matplotlib Figure
        Laid out.
    """
    for ax in figure.axes:
        legend: Any = ax.get_legend()
        if legend is not None and legend._loc == _BEST:
            box = legend.get_window_extent(figure.canvas.get_renderer())  # pyright: ignore[reportAttributeAccessIssue]
            size = np.array([box.width, box.height])
            low, room = np.array([ax.bbox.x0, ax.bbox.y0]), np.array([ax.bbox.width, ax.bbox.height])
            edge = _EDGE * figure.dpi / 72
            if (room > size + 2 * edge).all():
                place = _freest(_drawn(ax, float(size.min()) / 4) - low, size, room, edge)
                legend.set_loc(tuple(place / room))


def _freest(points: np.ndarray, size: np.ndarray, room: np.ndarray, edge: float) -> np.ndarray:
    """Return where the lower left corner of a box is to stand that covers fewest points, px in the panel."""
    x, y = (np.linspace(edge, room[k] - size[k] - edge, _PLACES) for k in range(2))
    places = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    margin = 0.5 * edge
    inside = (points[None] > places[:, None] - margin) & (points[None] < (places + size)[:, None] + margin)
    covered = inside.all(axis=-1).sum(axis=-1)
    ends = places[:, None] - np.array([[i, j] for i in (x[0], x[-1]) for j in (y[0], y[-1])])
    off = np.hypot(*np.moveaxis(ends, -1, 0)).min(axis=-1)
    return places[np.lexsort((off, covered))[0]]


def _drawn(ax: Axes, step: float) -> np.ndarray:
    """Return points of what is drawn in a panel, px, at most a step apart on lines, shape (n, 2)."""
    found: list[np.ndarray] = [np.empty((0, 2))]
    for line in ax.lines:
        if line.get_visible() and np.size(line.get_xdata(orig=False)):
            at = line.get_transform().transform(line.get_path().vertices)
            drawn = line.get_linestyle() not in ("None", "none", "", " ")
            found.append(_dense(at, step) if drawn else at)
    for each in ax.collections:
        offsets: Any = each.get_offsets()
        if len(offsets):
            found.append(each.get_offset_transform().transform(np.ma.filled(offsets, np.nan)))
    points = np.concatenate(found)
    return points[np.isfinite(points).all(axis=1)]


def _dense(at: np.ndarray, step: float) -> np.ndarray:
    """Return points on the way through some, at most a step apart.

    Examples
    --------
    >>> _dense(np.array([[0.0, 0.0], [0.0, 3.0]]), 1.5).tolist()
    [[0.0, 0.0], [0.0, 1.5], [0.0, 3.0]]
    """
    if len(at) < 2:
        return at
    long = np.concatenate([[0.0], np.cumsum(np.nan_to_num(np.hypot(*np.diff(at, axis=0).T)))])
    if not np.isfinite(long[-1]) or long[-1] > 1e5:  # far outside: its corners will do
        return at
    way = np.linspace(0.0, long[-1], int(long[-1] / step) + 1)
    return np.column_stack([np.interp(way, long, at[:, k]) for k in range(2)])
