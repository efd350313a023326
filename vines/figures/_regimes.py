"""A map over two parameters: what is reached at each point, and K2/K1 beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import name_axis
from vines.figures._chart import CurveLine, curve_entries, draw_curves
from vines.figures._colours import REGIME_CLASSES
from vines.figures._fit import columns_in, place_legend
from vines.figures._region_names import write_region_names
from vines.figures._style import font, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["RegimeMap", "regimes_figure"]

SHADE = 0.62
"""Factor on the colour where the ball sticks again and again."""


@dataclass(frozen=True, slots=True)
class RegimeMap:
    """A grid over two parameters, y down the rows and x along the columns of each array.

    Attributes
    ----------
    axes : (str, str)
        Names of the parameters along x and y.
    x, y : (nx,), (ny,) array
        Their values, ascending.
    regime : (ny, nx) array of int
        Place in :data:`REGIME_CLASSES`, -1 where there is no point.
    sticks : (ny, nx) array of bool
        Whether sticking recurs.
    name : (ny, nx) array of object
        n:m/pT where periodic, else None.
    ratio : (ny, nx) array
        K2/K1, or what `measure` names.
    caption : str
        The fixed parameters.
    measure : str
        "kinetic_ratio", "kinetic_ratios" of several balls together, "impact_power" or "harvested_power".
    curves : tuple of CurveLine
        Bifurcations that are laid over both maps.
    """

    axes: tuple[str, str]
    x: npt.NDArray[np.float64]
    y: npt.NDArray[np.float64]
    regime: npt.NDArray[np.int64]
    sticks: npt.NDArray[np.bool_]
    name: npt.NDArray[np.object_]
    ratio: npt.NDArray[np.float64]
    caption: str
    measure: str = "kinetic_ratio"
    curves: tuple[CurveLine, ...] = ()


_MEASURES = {
    "kinetic_ratio": ("kinetic energy, ball over mass", r"$K_2/K_1$"),
    "kinetic_ratios": ("kinetic energy, balls over mass", r"$\sum K_2/K_1$"),
    "impact_power": ("power lost in impacts", "power"),
    "harvested_power": ("power harvested at both ends", "power"),
}
"""What stands above the second map, and beside its bar."""

_POWERS = ("impact_power", "harvested_power")
"""Measures that may be zero, and are compared with each other: their scale is linear from zero."""


def regimes_figure(data: RegimeMap, *, title: str = "", width: float = 7.0) -> Figure:
    """Draw the map of what is reached, and that of K2/K1 beside it.

    Parameters
    ----------
    data : RegimeMap
        The grid.
    title : str
        Above the picture.
    width : float
        In inches.
    """
    import matplotlib as mpl
    from matplotlib.colors import LogNorm, Normalize, to_rgb
    from matplotlib.patches import Patch

    colours = np.array([to_rgb(colour) for colour in REGIME_CLASSES.values()] + [(1.0, 1.0, 1.0)])
    shown = colours[data.regime]
    shown = np.where(data.sticks[..., None], SHADE * shown, shown)
    with mpl.rc_context(look()):
        beside_each_other = columns_in(width, 2) == 2
        figure = new_figure(width, 0.56 * width if beside_each_other else 1.7 * width)
        above, beside = _MEASURES[data.measure]
        left, right = figure.subplots(1, 2, sharey=True) if beside_each_other else figure.subplots(2, 1)
        left.pcolormesh(data.x, data.y, shown, shading="nearest", rasterized=True)
        finite = data.ratio[np.isfinite(data.ratio) & (data.ratio > 0)]
        low, high = np.quantile(finite, [0.005, 1.0]) if finite.size else (1e-3, 1.0)
        linear = data.measure in _POWERS
        drawn = right.pcolormesh(
            data.x,
            data.y,
            np.ma.masked_invalid(data.ratio if linear else np.where(data.ratio > 0, data.ratio, np.nan)),
            norm=Normalize(0, high) if linear else LogNorm(max(low, 1e-6 * high), high),
            cmap="cividis",
            shading="nearest",
            rasterized=True,
        )
        right.set_facecolor("#ffffff")
        figure.colorbar(drawn, ax=right, label=beside, extend="neither" if linear else "min", pad=0.015)
        for ax, letter, what in ((left, "a", "what is reached"), (right, "b", above)):
            ax.set_title(f"({letter})  {what}", fontsize=font(8.5), loc="left")
            draw_curves(ax, data.curves, cased=True)
            _scale(ax, data)
        for ax in (left, right):
            name_axis(ax, "y", data.axes[1], written=ax is left or not beside_each_other)
        write_region_names(left, data.x, data.y, data.name)
        used = np.unique(data.regime)
        handles: list[Any] = [
            Patch(facecolor=colour, edgecolor="#777777", linewidth=0.5, label=label)
            for k, (label, colour) in enumerate(REGIME_CLASSES.items())
            if k in used
        ]
        if data.sticks.any():
            dark: Any = SHADE * np.array(to_rgb(REGIME_CLASSES["1:1, symmetric"]))
            handles.append(
                Patch(facecolor=dark, edgecolor="#777777", linewidth=0.5, label="any, darker: sticking recurs")
            )
        for label, line in curve_entries(data.curves):
            line.set_label(label)
            handles.append(line)
        labels = [str(each.get_label()) for each in handles]
        place_legend(figure, handles, labels, ncols=4 if data.curves else 5)
        figure.suptitle(", ".join(part for part in (title, data.caption) if part), fontsize=font(9))
    return figure


def _scale(ax: Axes, data: RegimeMap) -> None:
    for values, scale in ((data.x, ax.set_xscale), (data.y, ax.set_yscale)):
        if len(values) > 2 and values[0] > 0 and values[-1] > 20 * values[0]:
            scale("log")
    ax.set_xlim(data.x[0], data.x[-1])
    ax.set_ylim(data.y[0], data.y[-1])
    name_axis(ax, "x", data.axes[0])
