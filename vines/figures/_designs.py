"""What absorbers are worth over a range of forcing: bands of attractors, widths of ranges, maps of designs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import name_axis
from vines.figures._colours import COLOURS, PALETTE
from vines.figures._names import QUANTITIES, SYMBOLS
from vines.figures._style import font
from vines.figures._ticks import plain_ticks

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vines.figures._legend import Entry

__all__ = ["BandCurve", "BandPanel", "DesignMap", "FactorPanel"]

Floats = npt.NDArray[np.float64]

_LINES = (("black", (0, (4, 1.5))), ("red", "-"), ("blue", "-"), ("green", (0, (1, 1))), ("orange", "-."))
"""Colour and style of a set, told apart without colour too."""


@dataclass(frozen=True)
class BandCurve:
    """A measure over the forcing: between the best and the worst of the attractors.

    Attributes
    ----------
    x : (n,) array
        The forcing, ascending.
    least, worst : (n,) array
        The measure.
    label : str
        For the legend.
    colour : int
        Number of the set in its panel, from 0.
    """

    x: Floats
    least: Floats
    worst: Floats
    label: str
    colour: int


@dataclass(frozen=True)
class BandPanel:
    """Bands over the forcing, within `span` and a little beyond."""

    axis: str
    quantity: str
    bands: Sequence[BandCurve]
    span: tuple[float, float]
    title: str = ""
    y: tuple[float, float] | None = None

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        low, high = self.span
        margin = (high / low) ** 0.15
        for band in self.bands:
            colour, style = _look(band.colour)
            ax.fill_between(band.x, band.least, band.worst, color=colour, alpha=0.18, linewidth=0)
            ax.plot(band.x, band.worst, color=colour, linestyle=style, linewidth=1.2)
        for end in self.span:
            ax.axvline(end, color=COLOURS["mark"], linewidth=0.7, linestyle=(0, (1, 1.6)), zorder=0)
        ax.set_xscale("log")
        ax.set_xlim(low / margin, high * margin)
        plain_ticks(ax, "x")
        name_axis(ax, "x", self.axis)
        name_axis(ax, "y", self.quantity)
        inside = [band.worst[(band.x >= low / margin) & (band.x <= high * margin)] for band in self.bands]
        shown = np.concatenate([*inside, np.zeros(1)])
        ax.set_ylim(*(self.y or (0.0, 1.08 * float(shown[np.isfinite(shown)].max(initial=1e-9)))))
        _frame(ax, self.title)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.patches import Patch

        worst: list[Entry] = [(band.label, (_line(band.colour),)) for band in self.bands]
        shade: Any = Patch(facecolor=COLOURS["mark"], alpha=0.25, linewidth=0)
        return [*worst, ("from the best attractor to the worst", (shade,))]


@dataclass(frozen=True)
class FactorPanel:
    """The least worst measure against how wide the range of the forcing is; a dotted line at the range asked for."""

    axis: str
    quantity: str
    curves: Sequence[tuple[str, Floats, Floats, int]]
    factor: float
    title: str = ""
    y: tuple[float, float] | None = None

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        for _, x, values, number in self.curves:
            colour, style = _look(number)
            ax.plot(x, values, color=colour, linestyle=style, linewidth=1.2)
        ax.axvline(self.factor, color=COLOURS["mark"], linewidth=0.7, linestyle=(0, (1, 1.6)), zorder=0)
        ax.set_xscale("log")
        ends = [float(x.max()) for _, x, _, _ in self.curves if len(x)]
        ax.set_xlim(1.0, max(ends, default=self.factor))
        plain_ticks(ax, "x")
        symbol = SYMBOLS.get(self.axis, self.axis)
        name_axis(ax, "x", "width", rf"width of the range  ${symbol}_{{\max}}/{symbol}_{{\min}}$")
        name_axis(ax, "y", "factor", f"least worst {_short(self.quantity)}")
        if self.y is not None:
            ax.set_ylim(*self.y)
        else:
            ax.set_ylim(bottom=0.0)
        handles = [_line(number) for *_, number in self.curves]
        ax.legend(handles, [name for name, *_ in self.curves], loc="best", handlelength=2.4)
        _frame(ax, self.title)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it: nothing, it has one of its own."""
        return []


@dataclass(frozen=True)
class DesignMap:
    """The least worst measure over two parameters of a design, each at its best size; a star at the best.

    Attributes
    ----------
    axes : (str, str)
        The two parameters.
    x, y : (nx,), (ny,) array
        Their values.
    worst : (ny, nx) array
        The measure.
    best : (float, float) or None
        Where it is least.
    quantity : str
        Name of the measure.
    """

    axes: tuple[str, ...]
    x: Floats
    y: Floats
    worst: Floats
    best: tuple[float, ...] | None
    quantity: str
    title: str = ""
    limits: tuple[float, float] | None = None

    def draw(self, ax: Axes) -> None:
        """Draw it, with a bar of colours."""
        from matplotlib.ticker import FixedLocator, MaxNLocator

        finite = self.worst[np.isfinite(self.worst)]
        low, high = self.limits or (float(finite.min()), float(finite.max()))
        mesh = ax.pcolormesh(
            self.x, self.y, self.worst, cmap="viridis_r", vmin=low, vmax=high, shading="nearest", rasterized=True
        )
        if self.best is not None:
            ax.plot(*self.best, marker="*", markersize=9, color="white", markeredgecolor=COLOURS["ink"], zorder=3)
        ax.tick_params(which="both", color="white")
        ax.xaxis.set_major_locator(FixedLocator(MaxNLocator(4).tick_values(float(self.x[0]), float(self.x[-1]))))
        ax.set_xlim(*_edges(self.x))
        name_axis(ax, "x", self.axes[0])
        name_axis(ax, "y", self.axes[1])
        extend = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
        beyond = (bool(finite.min() < low - 1e-12), bool(finite.max() > high + 1e-12))
        bar = ax.figure.colorbar(mesh, ax=ax, pad=0.02, extend=extend[beyond])
        bar.set_label(f"least worst {_short(self.quantity)}")
        _frame(ax, self.title)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.lines import Line2D

        star: Any = {"marker": "*", "markersize": 8, "color": "white", "markeredgecolor": COLOURS["ink"]}
        return [("best design", (Line2D([], [], linestyle="none", **star),))]


def _look(number: int) -> tuple[str, Any]:
    colour, style = _LINES[number % len(_LINES)]
    return PALETTE[colour], style


def _line(number: int) -> Any:
    from matplotlib.lines import Line2D

    colour, style = _look(number)
    return Line2D([], [], color=colour, linestyle=style, linewidth=1.4)


def _edges(x: Floats) -> tuple[float, float]:
    """Return where the outer cells of a map end."""
    if len(x) < 2:
        return float(x[0]) - 0.5, float(x[0]) + 0.5
    return float(1.5 * x[0] - 0.5 * x[1]), float(1.5 * x[-1] - 0.5 * x[-2])


def _short(quantity: str) -> str:
    """Return the name of a quantity without its formula."""
    return QUANTITIES.get(quantity, quantity).partition("  ")[0]


def _frame(ax: Axes, title: str) -> None:
    if title:
        ax.set_title(title, fontsize=font(8.5))
