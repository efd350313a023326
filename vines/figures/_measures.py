"""Measures of points over one parameter, a curve a stage: sweeps up and down told apart, thresholds marked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from vines.figures._axes import name_axis
from vines.figures._colours import COLOURS, PALETTE
from vines.figures._diagram import runs
from vines.figures._marks import DOTTED
from vines.figures._style import font

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vines.figures._legend import Entry

__all__ = ["MeasureCurve", "MeasurePanel"]

Floats = npt.NDArray[np.float64]

_ORDER = ("red", "blue", "green", "orange", "black", "magenta", "cyan")
_DASHES: tuple[Any, ...] = ("-", (0, (4, 1.5)), (0, (1, 1)), (0, (4, 1.2, 1, 1.2)))
"""Styles of lines, so that curves are told apart without colour too."""

_MARKS: dict[str, dict[str, Any]] = {
    "up": {"marker": "^", "markersize": 3.0, "markeredgewidth": 0.0, "zorder": 2},
    "down": {"marker": "v", "markersize": 3.8, "markeredgewidth": 0.6, "markerfacecolor": "none", "zorder": 3},
}
_PALE: dict[str, Any] = {"alpha": 0.35, "zorder": 1.5}
_SWEEPS = {"up": "swept up", "down": "swept down"}


@dataclass(frozen=True)
class MeasureCurve:
    """A measure over one parameter.

    Attributes
    ----------
    x : (n,) array
        Value of the parameter, ascending.
    y : (n,) array
        The measure; nan where there is none.
    label : str
        For the legend.
    colour : int
        Number of the curve, from 0; curves with one label share it.
    way : {"", "up", "down"}
        The way in which states were carried along the parameter; a line where they were not.
    stable : (n,) array of bool, optional
        Of a branch, which may turn back: solid where true, dotted where not.
    """

    x: Floats
    y: Floats
    label: str
    colour: int
    way: Literal["", "up", "down"] = ""
    stable: npt.NDArray[np.bool_] | None = None


@dataclass(frozen=True)
class MeasurePanel:
    """Curves of one measure.

    With `band` what lies between curves of one label is shaded; `marks` are places along x; the labels stand below the
    figure where `legend` is None, else in the panel if true, and nowhere if false: another panel has them.
    """

    axis: str
    quantity: str
    curves: Sequence[MeasureCurve]
    title: str = ""
    window: tuple[float, float] | None = None
    y: tuple[float, float] | None = None
    log: tuple[bool, bool] = (False, False)
    band: bool = False
    marks: Sequence[float] = ()
    legend: bool | None = None

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        for place in self.marks:
            ax.axvline(place, color=COLOURS["mark"], linewidth=0.7, linestyle=(0, (1, 1.6)), zorder=0)
        if self.band:
            self._shade(ax)
        branches = any(curve.stable is not None for curve in self.curves)
        for curve in self.curves:
            if curve.stable is None:
                # Below branches, and paler: they would hide them.
                ax.plot(curve.x, curve.y, **_look(curve) | (_PALE if branches else {}))
                continue
            for start, stop, stable in runs(curve.stable):
                # One point is shared with the next run, so that the line has no gap where stability changes.
                part = slice(start, min(stop + 1, len(curve.x)))
                ax.plot(
                    curve.x[part], curve.y[part], color=_colour(curve), linestyle="-" if stable else DOTTED, zorder=3
                )
        for scale, wanted in zip((ax.set_xscale, ax.set_yscale), self.log, strict=True):
            if wanted:
                scale("log")
        name_axis(ax, "x", self.axis)
        name_axis(ax, "y", self.quantity)
        ends = [float(end) for curve in self.curves if len(curve.x) for end in (curve.x.min(), curve.x.max())]
        if self.window is not None:
            ax.set_xlim(*self.window)
        elif ends and min(ends) < max(ends):
            # marks at the ends are shown whole
            more = 0.015 if any(curve.way for curve in self.curves) else 0.0
            low, high = (math.log(min(ends)), math.log(max(ends))) if self.log[0] else (min(ends), max(ends))
            window = (low - more * (high - low), high + more * (high - low))
            ax.set_xlim(*map(math.exp, window) if self.log[0] else window)
        if self.y is not None:
            ax.set_ylim(*self.y)
        elif not self.log[1]:
            ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
        if self.title:
            ax.set_title(self.title, fontsize=font(8.5))
        if self.legend and (labels := self._labels()):
            ax.legend([line for _, (line,) in labels], [label for label, _ in labels], loc="best", handlelength=2.4)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it: a colour a label, and the ways of sweeps in black."""
        from matplotlib.lines import Line2D

        ways = [way for way in _SWEEPS if any(curve.way == way for curve in self.curves)]
        said: list[Entry] = [
            (_SWEEPS[way], (Line2D([], [], linestyle="none", color=COLOURS["ink"], **_bigger(way)),)) for way in ways
        ]
        flags = [curve.stable for curve in self.curves if curve.stable is not None]
        styles: tuple[tuple[str, Any, bool], ...] = (
            ("stable", "-", any(flag.any() for flag in flags)),
            ("unstable", DOTTED, any((~flag).any() for flag in flags)),
        )
        for word, style, there in styles:
            if there:
                said.append((word, (Line2D([], [], color=COLOURS["ink"], linewidth=1.4, linestyle=style),)))
        return [*(() if self.legend is not None else self._labels()), *said]

    def _labels(self) -> list[Entry]:
        from matplotlib.lines import Line2D

        found: dict[str, Entry] = {}
        branches = any(curve.stable is not None for curve in self.curves)
        for curve in self.curves:
            plain: dict[str, Any] = {"color": _colour(curve), "linewidth": 3.0 if curve.way else 1.4}
            if curve.stable is None and branches:
                plain |= _PALE
            line = plain if curve.way or curve.stable is not None else _look(curve)
            found.setdefault(curve.label, (curve.label, (Line2D([], [], **line),)))
        return [entry for label, entry in found.items() if label]

    def _shade(self, ax: Axes) -> None:
        """Shade what lies between curves of one label that have the same places."""
        for label in dict.fromkeys(curve.label for curve in self.curves):
            mine = [curve for curve in self.curves if curve.label == label]
            if len(mine) > 1 and all(np.array_equal(curve.x, mine[0].x) for curve in mine):
                values = np.stack([curve.y for curve in mine])
                low, high = np.fmin.reduce(values), np.fmax.reduce(values)
                ax.fill_between(mine[0].x, low, high, color=_colour(mine[0]), alpha=0.2, linewidth=0, zorder=1)


def _colour(curve: MeasureCurve) -> str:
    return PALETTE[_ORDER[curve.colour % len(_ORDER)]]


def _look(curve: MeasureCurve) -> dict[str, Any]:
    if curve.way:
        return {"linestyle": "none", "color": _colour(curve), **_MARKS[curve.way]}
    return {"linestyle": _DASHES[curve.colour % len(_DASHES)], "linewidth": 1.2, "color": _colour(curve)}


def _bigger(way: str) -> dict[str, Any]:
    return {name: value for name, value in _MARKS[way].items() if name != "zorder"} | {"markersize": 4.5}
