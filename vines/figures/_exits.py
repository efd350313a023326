"""How long regimes hold under noise: shares of runs that are left, means with their intervals, shares of the time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import name_axis
from vines.figures._colours import CHAOS, COLOURS, HUES
from vines.figures._style import font

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vines.figures._legend import Entry

__all__ = ["HeldCurve", "HeldRuns", "HoldingPanel", "SharesPanel", "SurvivalPanel"]

Floats = npt.NDArray[np.float64]

DASHED = (0, (4, 1.5))


@dataclass(frozen=True)
class HeldRuns:
    """Runs that began in one regime.

    Attributes
    ----------
    times : (n,) array
        When each was left, in forcing periods; infinite where the watch ended before.
    watched : float
        Forcing periods of the watch.
    wait, mean : float
        From when on runs count, and the mean time from then on; nan where none left.
    label : str
        For the legend.
    """

    times: Floats
    watched: float
    wait: float
    mean: float
    label: str


@dataclass(frozen=True)
class HeldCurve:
    """What is known of one regime along a parameter.

    Attributes
    ----------
    x : (n,) array
        The parameter, ascending.
    y, low, high : (n,) array
        The value and the ends of its interval; a value of nan is only known to be above `low`.
    label : str
        For the legend.
    colour : int
        Number of the regime, -1 for an irregular one.
    other : (n,) array, optional
        What is drawn beside, open.
    way : str
        Marker.
    """

    x: Floats
    y: Floats
    low: Floats
    high: Floats
    label: str
    colour: int
    other: Floats | None = None
    way: str = "o"


@dataclass(frozen=True)
class SurvivalPanel:
    """Shares of runs that have not left a regime, over the time; dashed the exponential of their mean."""

    runs: Sequence[HeldRuns]
    title: str = ""

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        least = 1.0
        for k, each in enumerate(self.runs):
            times = np.sort(each.times[np.isfinite(each.times)])
            n = len(each.times)
            steps = np.concatenate([[0.0], times, [each.watched]])
            left = np.concatenate([[1.0], 1.0 - np.arange(1, len(times) + 1) / n, [1.0 - len(times) / n]])
            ax.step(steps, left, where="post", color=_shade(k, len(self.runs)), linewidth=1.2)
            least = min(least, float(left[left > 0].min()))
            if np.isfinite(each.mean):
                at = np.linspace(each.wait, each.watched, 200)
                held = float(np.mean(each.times >= each.wait))
                ax.plot(
                    at, held * np.exp(-(at - each.wait) / each.mean), color=_shade(k, len(self.runs)), linestyle=DASHED,
                    linewidth=0.8,
                )  # fmt: skip
        ax.set_yscale("log")
        ax.set_ylim(0.8 * least, 1.15)
        ax.set_xlim(0.0, max(each.watched for each in self.runs))
        name_axis(ax, "x", "T_exit")
        name_axis(ax, "y", "held")
        _title(ax, self.title)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.lines import Line2D

        found: list[Entry] = []
        for k, each in enumerate(self.runs):
            drawn: Any = Line2D([], [], color=_shade(k, len(self.runs)), linewidth=1.2)
            found.append((each.label, (drawn,)))
        dashed: Any = Line2D([], [], color=COLOURS["mark"], linestyle=DASHED, linewidth=0.8)
        return [*found, ("exponential of the mean", (dashed,))]


@dataclass(frozen=True)
class HoldingPanel:
    """Mean times until regimes are left, over a parameter; a triangle where it is only known to be longer."""

    axis: str
    curves: Sequence[HeldCurve]
    title: str = ""
    log: bool = False
    y: tuple[float, float] | None = None

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        for curve in self.curves:
            colour, known = _colour(curve), np.isfinite(curve.y)
            ax.errorbar(
                curve.x[known], curve.y[known], [(curve.y - curve.low)[known], (curve.high - curve.y)[known]],
                color=colour, marker=curve.way, markersize=3.5, linewidth=0.8, elinewidth=0.8, capsize=1.5,
                markerfacecolor=colour if curve.way == "o" else "white",
            )  # fmt: skip
            ax.plot(curve.x[~known], curve.low[~known], color=colour, marker="^", markersize=4.5, linestyle="none")
        ax.set_yscale("log")
        _along(ax, self.curves, self.log)
        if self.y is not None:
            ax.set_ylim(*self.y)
        name_axis(ax, "x", self.axis)
        name_axis(ax, "y", "mean_exit")
        _title(ax, self.title)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.lines import Line2D

        found: list[Entry] = []
        for curve in self.curves:
            drawn: Any = Line2D(
                [], [], color=_colour(curve), marker=curve.way, markersize=3.5, linewidth=0.8,
                markerfacecolor=_colour(curve) if curve.way == "o" else "white",
            )  # fmt: skip
            found.append((curve.label, (drawn,)))
        if any(not np.isfinite(curve.y).all() for curve in self.curves):
            mark: Any = Line2D([], [], color=COLOURS["mark"], marker="^", markersize=4.5, linestyle="none")
            found.append(("longer than (95 %)", (mark,)))
        return found


@dataclass(frozen=True)
class SharesPanel:
    """Shares of the time in the long run, over a parameter, and, open, shares of the starts without noise."""

    axis: str
    curves: Sequence[HeldCurve]
    title: str = ""
    log: bool = False
    y: tuple[float, float] | None = None

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        for curve in self.curves:
            colour = _colour(curve)
            ax.fill_between(curve.x, curve.low, curve.high, color=colour, alpha=0.2, linewidth=0)
            ax.plot(curve.x, curve.y, color=colour, marker="o", markersize=3.0, linewidth=1.0)
            if curve.other is not None:
                ax.plot(
                    curve.x, curve.other, color=colour, marker="s", markersize=3.5, markerfacecolor="white",
                    linestyle=DASHED, linewidth=0.8,
                )  # fmt: skip
        _along(ax, self.curves, self.log)
        ax.set_ylim(*(self.y or (-0.03, 1.03)))
        name_axis(ax, "x", self.axis)
        name_axis(ax, "y", "held_share")
        _title(ax, self.title)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.lines import Line2D

        filled: Any = Line2D([], [], color=COLOURS["mark"], marker="o", markersize=3.0, linewidth=1.0)
        hollow: Any = Line2D(
            [], [], color=COLOURS["mark"], marker="s", markersize=3.5, markerfacecolor="white", linestyle=DASHED,
            linewidth=0.8,
        )  # fmt: skip
        named = [(curve.label, (_patch(_colour(curve)),)) for curve in self.curves]
        return [*named, ("of the time", (filled,)), ("of the starts", (hollow,))]


def _along(ax: Axes, curves: Sequence[HeldCurve], log: bool) -> None:
    """Make the axis of the parameter logarithmic where that is wanted, with its own values at the ticks."""
    if not log:
        return
    from matplotlib.ticker import NullLocator

    values = np.unique(np.concatenate([curve.x for curve in curves]))
    ax.set_xscale("log")
    ax.set_xticks(values, [f"{value:g}" for value in values])
    ax.xaxis.set_minor_locator(NullLocator())


def _patch(colour: str) -> Any:
    from matplotlib.patches import Patch

    return Patch(facecolor=colour, linewidth=0)


def _colour(curve: HeldCurve) -> str:
    return CHAOS[2] if curve.colour < 0 else HUES[curve.colour % len(HUES)]


def _shade(k: int, count: int) -> Any:
    import matplotlib as mpl

    return mpl.colormaps["viridis"](0.85 * k / max(count - 1, 1))


def _title(ax: Axes, title: str) -> None:
    if title:
        ax.set_title(title, fontsize=font(8))
