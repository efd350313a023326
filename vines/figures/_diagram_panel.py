"""One panel of a bifurcation diagram: simulated impacts as dots, branches of periodic orbits as lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import name_axis
from vines.figures._colours import BALLS, COLOURS, FAMILIES
from vines.figures._diagram import BranchLine, ImpactDots, Marker, runs, within
from vines.figures._legend import legend_entries
from vines.figures._marks import DOTTED, mark_style
from vines.figures._style import font

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vines.figures._legend import Entry

__all__ = ["DiagramPanel"]

Floats = npt.NDArray[np.float64]

_MANY = 4_000
"""Dots beyond which they are drawn as pixels, and small and translucent where they are not regular, as in chaos."""

_REGULAR = 4
"""Returns while a point was observed from which a dot is regular."""

_FEW = 8
"""Bifurcations beyond which their symbols are small."""

_RARE = 0.03
"""Share of the dots, and of the impacts that they stand for, that may lie beyond an axis at either end."""


@dataclass(frozen=True)
class DiagramPanel:
    """One quantity over the varied parameter.

    Attributes
    ----------
    axis : str
        The varied parameter.
    quantity : str
        One of :data:`PANELS` or :data:`MEASURES`.
    dots, lines, markers : sequences
        What is drawn.
    window, y : (float, float), optional
        The parts of the two axes that are shown.
    title : str
        Above the panel.
    opacity : float, optional
        Of a dot that came once. Dots then have the full colours of the two ends, and are the more solid the more often
        they came back.
    names : dict of str to str
        What is written beside the bifurcations of a type, such as ``{"symmetry_breaking": "$B_1$"}``.
    places : bool
        Whether the legend gives the places of all bifurcations, or of those with names only.
    """

    axis: str
    quantity: str
    dots: Sequence[ImpactDots]
    lines: Sequence[BranchLine]
    markers: Sequence[Marker]
    window: tuple[float, float] | None = None
    y: tuple[float, float] | None = None
    title: str = ""
    opacity: float | None = None
    names: Mapping[str, str] = field(default_factory=dict)
    places: bool = True

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        dots, lines, markers = self._shown()
        self._dots(ax, dots)
        self._lines(ax, lines)
        self._markers(ax, markers)
        name_axis(ax, "y", self.quantity)
        name_axis(ax, "x", self.axis)
        _widen(ax)
        _spare_outliers(ax, self.quantity, dots, lines)
        everything = [group.x for group in (*dots, *lines) if len(group.x)]
        if self.window is not None:
            ax.set_xlim(*self.window)
        elif everything:
            low, high = min(float(x.min()) for x in everything), max(float(x.max()) for x in everything)
            ax.set_xlim(low - 0.01 * (high - low), high + 0.01 * (high - low))
        if self.y is not None:
            ax.set_ylim(*self.y)
        if self.title:
            ax.set_title(self.title, fontsize=font(8.5))

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        dots, lines, markers = self._shown()
        return legend_entries(dots, lines, markers, names=self.names, places=self.places, full=self.opacity is not None)

    def _shown(self) -> tuple[Sequence[ImpactDots], Sequence[BranchLine], Sequence[Marker]]:
        if self.window is None:
            return self.dots, self.lines, self.markers
        return within(self.window, self.dots, self.lines, self.markers)

    def _dots(self, ax: Axes, dots: Sequence[ImpactDots]) -> None:
        total = sum(len(group.x) for group in dots)
        for group in dots:
            many = total > _MANY
            if group.ball is not None:
                self._balls(ax, group, many=many)
                continue
            for side, name in ((1, "L"), (-1, "R")):
                mine = group.side == side
                x, values = group.x[mine], group.values[self.quantity][mine]
                times = np.ones(x.shape) if group.repeats is None else group.repeats[mine]
                if self.opacity is not None:
                    solid: Any = 1 - (1 - self.opacity) ** times
                    ax.scatter(x, values, s=3.5, c=COLOURS[name], alpha=solid, linewidths=0, rasterized=many, zorder=1)
                    continue
                regular = (times >= _REGULAR) | (not many)
                for chosen, size, alpha in ((~regular, 2.8, 0.6), (regular, 4.2, 1.0)):
                    ax.plot(
                        x[chosen],
                        values[chosen],
                        linestyle="none",
                        marker=".",
                        markersize=size,
                        markeredgewidth=0,
                        alpha=alpha,
                        color=COLOURS[f"{name} light"],
                        rasterized=many,
                        zorder=1,
                    )

    def _balls(self, ax: Axes, group: ImpactDots, *, many: bool) -> None:
        """Draw the impacts of balls with numbers: a colour a ball, a triangle that points to the end that is hit."""
        balls: Any = group.ball
        for ball in np.unique(balls):
            for side, marker in ((1, "<"), (-1, ">")):
                mine = (balls == ball) & (group.side == side)
                ax.plot(
                    group.x[mine],
                    group.values[self.quantity][mine],
                    linestyle="none",
                    marker=marker,
                    markersize=1.8 if many else 2.6,
                    markeredgewidth=0,
                    alpha=0.6,
                    color=BALLS[(int(ball) - 1) % len(BALLS)],
                    rasterized=many,
                    zorder=1,
                )

    def _lines(self, ax: Axes, lines: Sequence[BranchLine]) -> None:
        for line in lines:
            if line.image and self.quantity == "dt":
                continue
            # Where left and right coincide, as the flight times of a symmetric orbit do, neither colour would be true.
            twin = line.family == "symmetric" and any(
                o is not line and o.side != line.side and _coincide(o, line, self.quantity) for o in lines
            )
            left, right = FAMILIES[line.family]
            plain = twin or (line.side == 0 and line.family == "symmetric")
            colour = COLOURS["ink"] if plain else right if line.side < 0 else left
            if line.stop:
                colour = COLOURS["stop"]
            elif line.ball:
                colour = BALLS[(line.ball - 1) % len(BALLS)]
            for start, stop, stable in runs(line.stable):
                # One point is shared with the next run, so that the line has no gap where stability changes.
                part = slice(start, min(stop + 1, len(line.x)))
                ax.plot(
                    line.x[part],
                    line.values[self.quantity][part],
                    color=colour,
                    linestyle="-" if stable else DOTTED,
                    linewidth=1.3 if stable else 1.2,
                    zorder=2.5 if stable else 2,
                )

    def _markers(self, ax: Axes, markers: Sequence[Marker]) -> None:
        size = 5.0 if len(markers) <= _FEW else 3.8
        for marker in markers:
            values = np.unique(np.round(marker.values[self.quantity], 12))
            ax.plot(np.full(len(values), marker.x), values, linestyle="none", zorder=3, **mark_style(marker.type, size))
            if marker.type in self.names:
                place = (marker.x, float(values.max()))
                text = self.names[marker.type]
                ax.annotate(text, place, (-4, 6), textcoords="offset points", fontsize=font(9), ha="right", zorder=4)


def _widen(ax: Axes) -> None:
    """Keep an axis from magnifying rounding noise into structure."""
    ax.ticklabel_format(axis="y", useOffset=False)
    low, high = ax.get_ylim()
    middle, least = (low + high) / 2, 1e-6 * max(abs(low), abs(high), 1e-6)
    if high - low < least:
        ax.set_ylim(middle - least / 2, middle + least / 2)


def _spare_outliers(ax: Axes, panel: str, dots: Sequence[ImpactDots], lines: Sequence[BranchLine]) -> None:
    """Let lines and all but the rarest dots fill an axis: one long flight would flatten everything else."""
    groups = [group.values[panel] for group in dots if len(group.x)]
    branches = [line.values[panel] for line in lines if len(line.x)]
    if not groups or not branches:
        return
    values = np.concatenate(groups)
    ends = np.array([_RARE, 1 - _RARE])
    bulk = np.quantile(values, ends)
    # A dot of an orbit stands for as many impacts as one of chaos has dots.
    order = np.argsort(values)
    often = np.concatenate([np.ones(len(each.x)) if each.repeats is None else each.repeats for each in dots])
    share = np.cumsum(np.maximum(often, 1.0)[order])
    met = values[order][np.searchsorted(share, share[-1] * ends)]
    low, high = (float(end(np.concatenate([*branches, bulk, met]))) for end in (np.min, np.max))
    if values.min() < low - (high - low) or values.max() > high + (high - low):
        ax.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))


def _coincide(one: BranchLine, other: BranchLine, panel: str) -> bool:
    a, b = one.values[panel], other.values[panel]
    return len(a) == len(b) and np.array_equal(one.x, other.x) and np.allclose(a, b, rtol=1e-9, atol=1e-12)
