"""Charts of two parameters: curves of bifurcations, special points on them, and where an orbit is stable."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._legend import add_legend
from vines.figures._marks import MARKS
from vines.figures._names import NAMES, SYMBOLS
from vines.figures._style import COLOURS, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["CurveLine", "Region", "SpecialMark", "chart_figure", "curve_entries", "draw_curves"]

Floats = npt.NDArray[np.float64]

_COLOURS = {
    "fold": "#333333",
    "symmetry_breaking": "#c8102e",
    "period_doubling": "#7a2bbf",
    "neimark_sacker": "#0b7d6b",
    "grazing": "#0b4ea2",
    "incomplete_chatter": "#d3005f",
    "release_tangency": "#9a5b00",
}
_STYLES = ("-", (0, (5, 1.5)), (0, (4, 1.5, 1, 1.5)), (0, (1.5, 1.2)))
"""Line styles of the families, in the order in which they come."""

_SYMBOLS = ("*", "P", "X", "d", "h", "p", "8", "<", ">")
_STABLE = "#dcebd5"
_DECADE = 10
"""Ratio of the ends of a range from which its axis is logarithmic."""


@dataclass(frozen=True)
class CurveLine:
    """A curve of bifurcations: its type, the family it belongs to, such as ``"1:1 symmetric"``, and its points."""

    type: str
    family: str
    x: Floats
    y: Floats


@dataclass(frozen=True)
class SpecialMark:
    """A point of codimension two on a curve."""

    type: str
    x: float
    y: float


@dataclass(frozen=True)
class Region:
    """Where something holds, on a grid: x (nx,), y (ny,), inside (ny, nx) of bool, and its name for the legend."""

    x: Floats
    y: Floats
    inside: npt.NDArray[np.bool_]
    label: str


def chart_figure(
    axes: tuple[str, str],
    curves: Sequence[CurveLine],
    special: Sequence[SpecialMark],
    regions: Sequence[Region] = (),
    *,
    caption: str = "",
    width: float = 7.0,
) -> Figure:
    """Draw a chart.

    Parameters
    ----------
    axes : (str, str)
        Names of the parameters along x and y. An axis whose curves span a decade is logarithmic.
    curves, special, regions : sequences
        What is drawn.
    caption : str
        The fixed parameters, written above.
    width : float
        Width of the figure [inch].
    """
    import matplotlib as mpl

    with mpl.rc_context(look()):
        figure = new_figure(width, 0.78 * width)
        ax = figure.subplots()
        for region in regions:
            # Pixel by pixel: a smooth outline would claim more than the grid knows.
            shown = np.where(region.inside, 1.0, np.nan)
            ax.pcolormesh(region.x, region.y, shown, cmap=_one(_STABLE), shading="nearest", rasterized=True, zorder=0)
        draw_curves(ax, curves)
        symbols: dict[str, str] = dict(zip(dict.fromkeys(mark.type for mark in special), _SYMBOLS, strict=False))
        for mark in special:
            ax.plot([mark.x], [mark.y], linestyle="none", zorder=4, **_special_style(symbols.get(mark.type, "x")))
        _scale(ax, curves)
        ax.set_xlabel(f"{NAMES.get(axes[0], axes[0])}  ${SYMBOLS.get(axes[0], axes[0])}$")
        ax.set_ylabel(f"{NAMES.get(axes[1], axes[1])}  ${SYMBOLS.get(axes[1], axes[1])}$")
        if caption:
            ax.set_title(caption, fontsize=8.5, loc="left", pad=6)
        add_legend(figure, _entries(curves, symbols, regions))
    return figure


def draw_curves(ax: Axes, curves: Sequence[CurveLine], *, cased: bool = False) -> None:
    """Draw curves in the colours of their types and the styles of their families, with a white rim where `cased`."""
    from matplotlib.patheffects import Normal, Stroke

    rim = [Stroke(linewidth=2.7, foreground="white"), Normal()] if cased else []
    for curve, style in zip(curves, _styles(curves), strict=True):
        width = 1.3 if cased else 1.5
        drawn = ax.plot(curve.x, curve.y, color=_COLOURS[curve.type], linestyle=style, linewidth=width, zorder=2)
        if rim:
            drawn[0].set_path_effects(rim)


def curve_entries(curves: Sequence[CurveLine]) -> list[tuple[str, Any]]:
    """Return what a legend says of curves, one entry a type of a family: a label and a line."""
    from matplotlib.lines import Line2D

    styles = {(curve.type, curve.family): style for curve, style in zip(curves, _styles(curves), strict=True)}
    return [
        (f"{MARKS[kind][1]}, {family}", Line2D([], [], color=_COLOURS[kind], linewidth=1.5, linestyle=style))
        for (kind, family), style in styles.items()
    ]


def _styles(curves: Sequence[CurveLine]) -> list[Any]:
    families = list(dict.fromkeys(curve.family for curve in curves))
    return [_STYLES[families.index(curve.family) % len(_STYLES)] for curve in curves]


def _one(colour: str) -> Any:
    from matplotlib.colors import ListedColormap

    return ListedColormap([colour])


def _special_style(symbol: str) -> dict[str, Any]:
    return {
        "marker": symbol,
        "markersize": 9 if symbol == "*" else 6.5,
        "markerfacecolor": "#f7d038",
        "markeredgecolor": COLOURS["ink"],
        "markeredgewidth": 0.8,
    }


def _scale(ax: Axes, curves: Sequence[CurveLine]) -> None:
    """Choose linear or logarithmic axes, and let the curves fill them."""
    for name in ("x", "y"):
        values = np.concatenate([getattr(curve, name) for curve in curves]) if curves else np.array([])
        if not len(values):
            continue
        low, high = float(values.min()), float(values.max())
        if low > 0 and high / low >= _DECADE:
            getattr(ax, f"set_{name}scale")("log")
        getattr(ax, f"set_{name}lim")(low, high)


def _entries(
    curves: Sequence[CurveLine], symbols: dict[str, str], regions: Sequence[Region]
) -> list[tuple[str, tuple[Any, ...]]]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries: list[tuple[str, tuple[Any, ...]]] = [
        (region.label, (Patch(facecolor=_STABLE, edgecolor="none"),)) for region in regions
    ]
    entries += [(label, (line,)) for label, line in curve_entries(curves)]
    for kind, symbol in symbols.items():
        text = re.sub(r"(\d)_(\d)", r"\1:\2", kind).replace("neimark_sacker", "Neimark–Sacker").replace("_", " ")
        entries.append((text, (Line2D([], [], linestyle="none", **_special_style(symbol)),)))
    return entries
