"""Which of several sets is best over two parameters, by how much, and what each is worth along one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from vines.figures._axes import name_axis
from vines.figures._colours import COLOURS, SETS
from vines.figures._region_names import write_region_names
from vines.figures._style import font
from vines.figures._ticks import plain_ticks

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vines.figures._legend import Entry

__all__ = ["BestMap", "LeadMap", "SetCurve", "SetPanel"]

Floats = npt.NDArray[np.float64]

_STYLES: tuple[Any, ...] = (
    "-",
    (0, (5, 1.2)),
    (0, (1, 0.9)),
    (0, (4, 1.2, 1, 1.2)),
    (0, (7, 1, 1, 1, 1, 1)),
    (0, (9, 1)),
    (0, (2.5, 1.5)),
    (0, (6, 2.5)),
)
"""Styles of lines, so that sets are told apart without colour too."""
_PALE = 0.45
"""How much of its colour a point keeps where another set is as good but for little."""


@dataclass(frozen=True)
class BestMap:
    """The best set at each point of a grid, in its colour and with its name; paler where another is nearly as good.

    Attributes
    ----------
    axes : (str, str)
        The parameters along x and y.
    x, y : (nx,), (ny,) array
        Their values, ascending.
    best : (ny, nx) array of int
        Place of the best set in `names`; -1 where there is none.
    lead : (ny, nx) array
        The second best over the best, >= 1 (or best over second, where more is better).
    names : tuple of str
        All sets, in the order of their colours.
    close : float
        A lead below 1 + `close` is pale.
    log : (bool, bool)
        Logarithmic axes.
    """

    axes: tuple[str, str]
    x: Floats
    y: Floats
    best: npt.NDArray[np.int64]
    lead: Floats
    names: tuple[str, ...]
    close: float
    log: tuple[bool, bool] = (False, False)
    title: str = ""

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        from matplotlib.colors import to_rgb

        colours = np.array([to_rgb(SETS[k]) for k in range(len(self.names))] + [(1.0, 1.0, 1.0)])
        shown = colours[self.best]
        pale = (self.lead < 1 + self.close)[..., None]
        shown = np.where(pale, 1 - _PALE * (1 - shown), shown)
        ax.pcolormesh(_edges(self.x, self.log[0]), _edges(self.y, self.log[1]), shown, rasterized=True)
        _frame(ax, self)
        written = np.array([*self.names, None], dtype=object)[self.best]
        write_region_names(ax, self.x, self.y, written, wider=False)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.patches import Patch

        pale: Any = Patch(facecolor="#b9b9b9", edgecolor="#777777", linewidth=0.5)
        paler = bool((self.lead[self.best >= 0] < 1 + self.close).any())
        said = [_entry(self.names, k) for k in range(len(self.names))]
        return [*said, *([(f"paler: by less than {100 * self.close:g} %", (pale,))] if paler else [])]


@dataclass(frozen=True)
class LeadMap:
    """How much better the best set is than the second, as a ratio."""

    axes: tuple[str, str]
    x: Floats
    y: Floats
    lead: Floats
    log: tuple[bool, bool] = (False, False)
    title: str = ""
    limits: tuple[float, float] | None = None

    def draw(self, ax: Axes) -> None:
        """Draw it, with a bar of colours."""
        from matplotlib.colors import LogNorm
        from matplotlib.ticker import FuncFormatter, NullFormatter

        finite = self.lead[np.isfinite(self.lead)]
        low, high = self.limits or (1.0, max(1.01, float(finite.max(initial=1.0))))
        mesh = ax.pcolormesh(
            _edges(self.x, self.log[0]),
            _edges(self.y, self.log[1]),
            np.ma.masked_invalid(self.lead),
            norm=LogNorm(low, high),
            cmap="cividis",
            rasterized=True,
        )
        _frame(ax, self)
        beyond = bool(finite.max(initial=1.0) > high * (1 + 1e-9))
        bar = ax.figure.colorbar(mesh, ax=ax, pad=0.02, extend="max" if beyond else "neither")
        bar.set_label("second best over best")
        marks = [mark for mark in (1, 1.2, 1.5, 2, 3, 4, 5, 7, 10, 20, 50, 100) if low <= mark <= high * (1 + 1e-9)]
        bar.set_ticks(marks)
        bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        bar.ax.yaxis.set_minor_formatter(NullFormatter())

    def entries(self) -> list[Entry]:
        """Return what the legend says of it: nothing, it has a bar."""
        return []


@dataclass(frozen=True)
class SetCurve:
    """A measure of one set along a parameter, between the best and the worst of its attractors.

    Attributes
    ----------
    x : (n,) array
        The parameter, ascending.
    least, worst : (n,) array
        The measure.
    number : int
        Place of the set in the names of the panel.
    """

    x: Floats
    least: Floats
    worst: Floats
    number: int


@dataclass(frozen=True)
class SetPanel:
    """What sets are worth along one parameter: a line at the worst attractor, a band to the best.

    `without` is the measure where nothing is attached, if it has a sense then; `names` are all sets in the order of
    their colours.
    """

    axis: str
    quantity: str
    curves: Sequence[SetCurve]
    names: tuple[str, ...]
    without: tuple[Floats, Floats] | None = None
    log: tuple[bool, bool] = (False, False)
    title: str = ""
    y: tuple[float, float] | None = None

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        if self.without is not None:
            ax.plot(*self.without, color=COLOURS["mark"], linewidth=0.8, zorder=1)
        for curve in self.curves:
            colour = SETS[curve.number]
            ax.fill_between(curve.x, curve.least, curve.worst, color=colour, alpha=0.22, linewidth=0)
            ax.plot(curve.x, curve.worst, color=colour, linestyle=_STYLES[curve.number], linewidth=1.2)
        for along, wanted in zip("xy", self.log, strict=True):
            if wanted:
                getattr(ax, f"set_{along}scale")("log")
        ends = np.concatenate([curve.x for curve in self.curves])
        ax.set_xlim(float(ends.min()), float(ends.max()))
        if self.log[0]:
            plain_ticks(ax, "x")
        name_axis(ax, "x", self.axis)
        name_axis(ax, "y", self.quantity)
        if self.y is not None:
            ax.set_ylim(*self.y)
        elif not self.log[1]:
            ax.set_ylim(bottom=0.0)
        if self.log[1]:
            plain_ticks(ax, "y")
        if self.title:
            ax.set_title(self.title, fontsize=font(8.5))

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.lines import Line2D
        from matplotlib.patches import Patch

        shade: Any = Patch(facecolor=COLOURS["mark"], alpha=0.25, linewidth=0)
        said = [_entry(self.names, curve.number) for curve in self.curves]
        bands = any((curve.least < curve.worst * (1 - 1e-3)).any() for curve in self.curves)
        if bands:
            said.append(("from the best attractor to the worst", (shade,)))
        if self.without is not None:
            said.append(("nothing attached", (Line2D([], [], color=COLOURS["mark"], linewidth=0.8),)))
        return said


def _entry(names: Sequence[str], k: int) -> Entry:
    """Return the entry of a set: its colour as in maps, and its line."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    patch: Any = Patch(facecolor=SETS[k], linewidth=0)
    return (names[k], (patch, Line2D([], [], color=SETS[k], linestyle=_STYLES[k], linewidth=1.4)))


def _frame(ax: Axes, panel: BestMap | LeadMap) -> None:
    sides: tuple[Literal["x"], Literal["y"]] = ("x", "y")
    for along, values, log, name in zip(sides, (panel.x, panel.y), panel.log, panel.axes, strict=True):
        edges = _edges(values, log)
        if log:
            getattr(ax, f"set_{along}scale")("log")
        getattr(ax, f"set_{along}lim")(float(edges[0]), float(edges[-1]))
        if log:
            plain_ticks(ax, along)
        name_axis(ax, along, name)
    if panel.title:
        ax.set_title(panel.title, fontsize=font(8.5))


def _edges(values: Floats, log: bool) -> Floats:
    """Return the edges of the cells around values.

    Examples
    --------
    >>> _edges(np.array([1.0, 2.0, 3.0]), False).tolist()
    [0.5, 1.5, 2.5, 3.5]
    """
    at = np.log(values) if log else values
    if len(at) < 2:
        step = 0.1 if log else 0.5
        edges = np.array([at[0] - step, at[0] + step])
    else:
        middle = (at[1:] + at[:-1]) / 2
        edges = np.concatenate([[2 * at[0] - middle[0]], middle, [2 * at[-1] - middle[-1]]])
    return np.exp(edges) if log else edges
