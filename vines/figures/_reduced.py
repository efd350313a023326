"""Error maps of the reduced model: where the approximation may be trusted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.errors import DeclarationError, nearest
from vines.figures._axes import name_axis
from vines.figures._colours import COLOURS
from vines.figures._fit import columns_in, place_legend
from vines.figures._names import ERRORS
from vines.figures._style import font, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import QuadContourSet
    from matplotlib.figure import Figure

__all__ = ["ErrorMap", "reduced_figure"]

Floats = npt.NDArray[np.float64]

_LEVELS = (1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1, 0.2, 0.5, 1.0)
_NOWHERE = "#d9d9d9"


@dataclass(frozen=True)
class ErrorMap:
    """Errors over a grid of two parameters, y down the rows and x along the columns of each array.

    Attributes
    ----------
    axes : (str, str)
        Names of the parameters along x and y.
    x, y : (nx,), (ny,) array
        Their values, ascending.
    errors : dict of str to (ny, nx) array
        Errors by the names of :data:`ERRORS`, nan where approximation or orbit do not exist.
    valid : (ny, nx) array of bool
        Where the exact orbit is stable and admissible.
    inside : (ny, nx) array
        Positive where the reduction calls the response stable.
    caption : str
        The fixed parameters.
    """

    axes: tuple[str, str]
    x: Floats
    y: Floats
    errors: dict[str, Floats]
    valid: npt.NDArray[np.bool_]
    inside: Floats
    caption: str


def reduced_figure(
    maps: Sequence[ErrorMap], *, panels: Sequence[str] = (), title: str = "", width: float = 7.0
) -> Figure:
    """Draw error maps side by side as filled contours on one logarithmic colour scale, a row a quantity.

    Grey is where orbit or approximation do not exist, hatched where the exact orbit is unstable or passes through a
    wall. The dashed line bounds what the reduction calls stable.

    Parameters
    ----------
    maps : sequence of ErrorMap
    panels : sequence of str
        Quantities of :data:`ERRORS`, max_abs_x1 alone by default.
    title : str
        Written above everything.
    width : float
        Width of the figure [inch].

    Raises
    ------
    DeclarationError
        If a panel is not known or there is no map.
    """
    import matplotlib as mpl
    from matplotlib.colors import LogNorm

    panels = tuple(panels) or ("max_abs_x1",)
    for panel in panels:
        if panel not in ERRORS:
            raise DeclarationError(f"unknown panel {panel!r} of an error map: {nearest(panel, ERRORS)}")
    if not maps:
        raise DeclarationError("an error map needs a stage of kind reduced that varies two parameters; here is none")
    with mpl.rc_context({**look(), "hatch.linewidth": 0.4}):
        columns = columns_in(width, len(maps))
        each = -(-len(maps) // columns)  # rows of a quantity
        figure = new_figure(width, 0.9 + 2.9 * len(panels) * each)
        grid = figure.subplots(len(panels) * each, columns, squeeze=False).reshape(len(panels), each * columns)
        letters = iter("abcdefghijklmnop")
        for places, panel in zip(grid, panels, strict=True):
            for ax in places[len(maps) :]:
                ax.set_axis_off()
            row = places[: len(maps)]
            drawn = [
                _draw(ax, chart, panel, LogNorm(_LEVELS[0], _LEVELS[-1])) for ax, chart in zip(row, maps, strict=True)
            ]
            for ax, chart in zip(row, maps, strict=True):
                ax.set_title(f"({next(letters)})  {chart.caption}", fontsize=font(8), loc="left")
            figure.colorbar(drawn[0], ax=list(row), label=ERRORS[panel], pad=0.015, ticks=_LEVELS[::3])
        if title:
            figure.suptitle(title, fontsize=font(9.5))
        _legend(figure)
    return figure


def _draw(ax: Axes, chart: ErrorMap, panel: str, norm: object) -> QuadContourSet:
    from matplotlib import colormaps

    error = np.abs(chart.errors[panel])
    ax.set_facecolor(_NOWHERE)
    filled = ax.contourf(
        chart.x,
        chart.y,
        np.ma.masked_invalid(np.clip(error, _LEVELS[0], _LEVELS[-1])),
        levels=_LEVELS,
        norm=norm,
        cmap=colormaps["viridis_r"],
    )
    # Signed, so that the lines stay smooth where the error passes through zero.
    signed = np.ma.masked_invalid(chart.errors[panel])
    one_percent = ax.contour(
        chart.x, chart.y, signed, levels=[-0.01, 0.01], colors="white", linewidths=1.0, linestyles="solid"
    )
    ax.clabel(one_percent, fmt={-0.01: "−1 %", 0.01: "+1 %"}, fontsize=font(7))
    doubtful = np.where(np.isfinite(error) & ~chart.valid, 1.0, 0.0)
    if doubtful.any():
        ax.contourf(chart.x, chart.y, doubtful, levels=[0.5, 1.5], colors="none", hatches=["/////"])
    if (chart.inside > 0).any() and (chart.inside < 0).any():
        ax.contour(
            chart.x, chart.y, chart.inside, levels=[0.0], colors=COLOURS["L"], linewidths=1.2, linestyles="dashed"
        )
    if _logarithmic(chart.x):
        ax.set_xscale("log")
    if _logarithmic(chart.y):
        ax.set_yscale("log")
    name_axis(ax, "x", chart.axes[0])
    name_axis(ax, "y", chart.axes[1])
    return filled


def _logarithmic(values: Floats) -> bool:
    """Say whether values are spaced by a constant ratio rather than a constant difference.

    Examples
    --------
    >>> _logarithmic(np.geomspace(0.001, 0.1, 5)), _logarithmic(np.linspace(0.001, 0.1, 5))
    (True, False)
    """
    if len(values) < 3 or values[0] <= 0:
        return False
    steps = np.diff(np.log(values))
    return bool(np.ptp(steps) < 1e-6 * steps.mean())


def _legend(figure: Figure) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [
        Patch(facecolor="white", edgecolor=COLOURS["ink"], hatch="////", label="exact orbit unstable or inadmissible"),
        Patch(facecolor=_NOWHERE, label="no symmetric 1:1 orbit, exact or reduced"),
        Line2D([], [], color=COLOURS["L"], linestyle="dashed", label="stable by the reduction"),
    ]
    place_legend(figure, handles, [str(each.get_label()) for each in handles], ncols=3)
