"""Basins of attraction as a map of the starts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from vines.figures._axes import name_axis
from vines.figures._colours import CHAOS, HUES
from vines.figures._fit import place_legend
from vines.figures._style import font, look, new_figure
from vines.model import VI_NES, with_all_balls

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["BasinMap", "basins_figure", "start_symbol"]

Floats = npt.NDArray[np.float64]

UNSETTLED = "#000000"
"""Colours as in the map of regimes: periodic attractors coloured, chaotic ones grey, what has not settled black."""

LETTERS, SWATCH = 13, 9
"""Letters of the legend to an inch, and the room of a colour in it, in letters."""
SHADE = 0.62
"""Factor on the colour where the mirror image of an attractor is reached."""

PIXELS = 2000
"""Most pixels along a side that halved cells are drawn with."""


@dataclass(frozen=True, slots=True)
class BasinMap:
    """Cells of a map of starts.

    Attributes
    ----------
    axes : (str, str)
        Coordinates along x and y, as `start_symbol` writes them.
    x, y : (n,) array
        Centres of the cells.
    level : (n,) array of int
        How often each was halved in both directions.
    attractor : (n,) array of int
        What was reached, -1 where that has not settled.
    mirrored : (n,) array of bool
        Whether that is the mirror image.
    names, regimes : sequence of str
        For each attractor, with its share; and what is written for the cells that have not settled, if there are any.
    steps : (float, float)
        Sizes of an uncut cell.
    coordinates : (str, str)
        Names of the coordinates, by which the look of a figure knows its axes.
    """

    axes: tuple[str, str]
    x: Floats
    y: Floats
    level: npt.NDArray[np.int64]
    attractor: npt.NDArray[np.int64]
    mirrored: npt.NDArray[np.bool_]
    names: Sequence[str]
    regimes: Sequence[str]
    steps: tuple[float, float]
    coordinates: tuple[str, str] = ("x", "y")


def start_symbol(name: str, system: str = VI_NES.name) -> str:
    r"""Return what an axis calls a coordinate of a start of a system.

    Examples
    --------
    >>> start_symbol("v2"), start_symbol("phase", "impact_pair")
    ("$x_2'$", 'phase $\\theta$')
    """
    known = with_all_balls(system)
    if name == known.phase.name:
        return f"phase ${known.phase.symbol}$"
    return next(f"${each.symbol}$" for each in known.state if each.name == name)


def basins_figure(data: BasinMap, *, title: str = "", width: float = 7.0) -> Figure:
    """Draw the map: one hue for each attractor, darker where its mirror image is reached.

    Parameters
    ----------
    data : BasinMap
        The cells.
    title : str
        Above the picture.
    width : float
        In inches.
    """
    import matplotlib as mpl
    from matplotlib.colors import to_rgb
    from matplotlib.patches import Patch

    colours = _colours(data.regimes)
    shown = np.array([to_rgb(colour) for colour in (*colours, UNSETTLED)])[data.attractor]
    shown = np.where(data.mirrored[:, None], SHADE * shown, shown)
    image, extent = _image(data, shown)
    with mpl.rc_context(look()):
        figure = new_figure(width, 0.8 * width)
        ax = figure.add_subplot()
        ax.imshow(image, extent=extent, origin="lower", aspect="auto", interpolation="none")
        name_axis(ax, "x", data.coordinates[0], f"{data.axes[0]} at the start")
        name_axis(ax, "y", data.coordinates[1], f"{data.axes[1]} at the start")
        handles = [
            Patch(facecolor=colour, edgecolor="#777777", linewidth=0.5, label=name)
            for colour, name in zip((*colours, UNSETTLED), data.names, strict=False)
        ]
        place_legend(figure, handles, [str(each.get_label()) for each in handles], ncols=2)
        ax.set_title(title, fontsize=font(9))
    return figure


def _colours(regimes: Sequence[str]) -> list[str]:
    hues, greys, colours = 0, 0, []
    for regime in regimes:
        if regime == "chaotic":
            colours.append(CHAOS[greys % len(CHAOS)])
            greys += 1
        else:
            colours.append(HUES[hues % len(HUES)])
            hues += 1
    return colours


def _image(data: BasinMap, colours: Floats) -> tuple[Floats, tuple[float, float, float, float]]:
    """Return the picture of the cells, (ny, nx, 3), white where there is none, and its edges (left, right, low, high).

    A pixel is a cell halved as often as the finest, but not so often that the picture grows without need: the colours
    of smaller cells are mixed.
    """
    cells = data.level - data.level.min()
    half = [0.5 * h / 2.0**cells for h in data.steps]
    left, low = (float(np.min(v - side)) for v, side in zip((data.x, data.y), half, strict=True))
    count = [
        round((float(np.max(v + side)) - edge) / h)
        for v, side, edge, h in zip((data.x, data.y), half, (left, low), data.steps, strict=True)
    ]
    fine = 0
    while fine < cells.max() and max(count) * 2 ** (fine + 1) <= PIXELS:
        fine += 1
    nx, ny = (n * 2**fine for n in count)
    total, area = np.zeros((ny * nx, 3)), np.zeros(ny * nx)
    for level in np.unique(cells).tolist():
        here = cells == level
        across = 2 ** max(fine - level, 0)
        size = 4.0 ** min(fine - level, 0)
        corner = [
            np.floor((v[here] - edge) / (h / 2**level)).astype(np.int64) * across // 2 ** max(level - fine, 0)
            for v, edge, h in zip((data.x, data.y), (left, low), data.steps, strict=True)
        ]
        for dy in range(across):
            for dx in range(across):
                pixel = (corner[1] + dy) * nx + corner[0] + dx
                area += size * np.bincount(pixel, minlength=ny * nx)
                for k in range(3):
                    total[:, k] += size * np.bincount(pixel, weights=colours[here, k], minlength=ny * nx)
    mixed = np.where(area[:, None] > 0, total / np.maximum(area, 1e-300)[:, None], 1.0)
    return mixed.reshape(ny, nx, 3), (left, left + count[0] * data.steps[0], low, low + count[1] * data.steps[1])
