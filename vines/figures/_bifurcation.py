"""Bifurcation diagrams: simulated impacts as dots, branches of periodic orbits as lines."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.errors import DeclarationError, nearest
from vines.figures._legend import add_legend, legend_entries
from vines.figures._marks import DOTTED, mark_style
from vines.figures._names import NAMES, PANELS, SYMBOLS
from vines.figures._style import COLOURS, FAMILIES, RC, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["BranchLine", "ImpactDots", "Marker", "bifurcation_figure"]

Floats = npt.NDArray[np.float64]

_MANY = 4_000
"""Dots beyond which they are small, translucent and drawn as pixels, so that chaos does not cover what is regular."""

_FEW = 8
"""Bifurcations beyond which their symbols are small."""

_RARE = 0.03
"""Share of the dots, at either end, that may lie beyond an axis."""


@dataclass(frozen=True)
class ImpactDots:
    """Simulated impacts.

    Attributes
    ----------
    x : (n,) array
        Value of the varied parameter.
    side : (n,) array
        +1 on the left end, -1 on the right.
    values : dict of str to (n,) array
        What the panels show, by the names of :data:`PANELS`; ``dt`` in forcing periods.
    label : str
        For the legend.
    """

    x: Floats
    side: npt.NDArray[np.integer[Any]]
    values: dict[str, Floats]
    label: str = "simulation"


@dataclass(frozen=True)
class BranchLine:
    """One impact of the orbits along a branch, as a line.

    Attributes
    ----------
    x : (n,) array
        Value of the varied parameter along the branch.
    side : int
        +1 on the left end, -1 on the right.
    stable : (n,) array of bool
        Solid where true, dotted where not.
    values : dict of str to (n,) array
        As in :class:`ImpactDots`.
    label : str
        For the legend, such as ``"1:1 symmetric"``.
    family : str
        One of :data:`FAMILIES`, for the colours.
    image : bool
        Whether it is the mirror image of another line, whose flight times it shares.
    """

    x: Floats
    side: int
    stable: npt.NDArray[np.bool_]
    values: dict[str, Floats]
    label: str
    family: str = "symmetric"
    image: bool = False


@dataclass(frozen=True)
class Marker:
    """A bifurcation on a branch: its type, its place, and what the panels show there (one value an impact)."""

    type: str
    x: float
    values: dict[str, Floats]


def bifurcation_figure(
    axis: str,
    dots: Sequence[ImpactDots],
    lines: Sequence[BranchLine],
    markers: Sequence[Marker],
    *,
    panels: Sequence[str] = ("w_dot", "dt"),
    caption: str = "",
    width: float = 7.0,
    window: tuple[float, float] | None = None,
) -> Figure:
    """Draw a bifurcation diagram with one panel a quantity, stacked over a common axis.

    Parameters
    ----------
    axis : str
        The varied parameter: ``A``, ``mu``, ``Omega``, ``r`` or ``lam``.
    dots, lines, markers : sequences
        What is drawn.
    panels : sequence of str
        Quantities of :data:`PANELS`.
    caption : str
        The fixed parameters, written above the first panel.
    width : float
        Width of the figure [inch].
    window : (float, float), optional
        The part of the varied parameter that is shown; everything by default.

    Raises
    ------
    DeclarationError
        If a panel is not known.
    """
    import matplotlib as mpl

    for panel in panels:
        if panel not in PANELS:
            raise DeclarationError(f"unknown panel {panel!r} of a bifurcation diagram: {nearest(panel, PANELS)}")
    if window is not None:
        dots, lines, markers = _within(window, dots, lines, markers)
    with mpl.rc_context(RC):
        figure = new_figure(width, 0.75 + 2.75 * len(panels))
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for letter, panel, ax in zip("abcdefgh", panels, axes, strict=False):
            _draw(ax, panel, dots, lines, markers)
            ax.set_ylabel(PANELS[panel])
            _widen(ax)
            _spare_outliers(ax, panel, dots, lines)
            ax.text(-0.082, 1.0, f"({letter})", transform=ax.transAxes, va="top", fontweight="bold")
        axes[-1].set_xlabel(f"{NAMES.get(axis, axis)}  ${SYMBOLS.get(axis, axis)}$")
        everything = [group.x for group in (*dots, *lines) if len(group.x)]
        if window is not None:
            axes[-1].set_xlim(*window)
        elif everything:
            low, high = min(float(x.min()) for x in everything), max(float(x.max()) for x in everything)
            axes[-1].set_xlim(low - 0.01 * (high - low), high + 0.01 * (high - low))
        if caption:
            axes[0].set_title(caption, fontsize=8.5, loc="left", pad=6)
        add_legend(figure, legend_entries(dots, lines, markers))
    return figure


def _within(
    window: tuple[float, float], dots: Sequence[ImpactDots], lines: Sequence[BranchLine], markers: Sequence[Marker]
) -> tuple[list[ImpactDots], list[BranchLine], list[Marker]]:
    """Leave out what the window does not show, so that the other axis is scaled to the rest."""
    low, high = min(window), max(window)

    def cut(group: Any, keep: npt.NDArray[Any], *names: str) -> Any:
        columns = {name: getattr(group, name)[keep] for name in ("x", *names)}
        return replace(group, **columns, values={q: v[keep] for q, v in group.values.items()})

    shown = [cut(one, (low <= one.x) & (one.x <= high), "side") for one in dots]
    parts = [
        # One point more at either end, so that a line reaches the border.
        cut(line, np.arange(max(start - 1, 0), min(stop + 1, len(line.x))), "stable")
        for line in lines
        for start, stop, inside in runs((low <= line.x) & (line.x <= high))
        if inside
    ]
    return shown, parts, [marker for marker in markers if low <= marker.x <= high]


def _draw(
    ax: Axes, panel: str, dots: Sequence[ImpactDots], lines: Sequence[BranchLine], markers: Sequence[Marker]
) -> None:
    for group in dots:
        many = len(group.x) > _MANY
        for side, name in ((1, "L"), (-1, "R")):
            mine = group.side == side
            ax.plot(
                group.x[mine],
                group.values[panel][mine],
                linestyle="none",
                marker=".",
                markersize=2.8 if many else 4.2,
                markeredgewidth=0,
                alpha=0.6 if many else 1.0,
                color=COLOURS[f"{name} light"],
                rasterized=many,
                zorder=1,
            )
    for line in lines:
        if line.image and panel == "dt":
            continue
        # Where left and right coincide, as the flight times of a symmetric orbit do, neither colour would be true.
        twin = line.family == "symmetric" and any(
            o is not line and o.side != line.side and _coincide(o, line, panel) for o in lines
        )
        left, right = FAMILIES[line.family]
        colour = COLOURS["ink"] if twin else left if line.side == 1 else right
        for start, stop, stable in runs(line.stable):
            # One point is shared with the next run, so that the line has no gap where stability changes.
            part = slice(start, min(stop + 1, len(line.x)))
            ax.plot(
                line.x[part],
                line.values[panel][part],
                color=colour,
                linestyle="-" if stable else DOTTED,
                linewidth=1.3 if stable else 1.2,
                zorder=2.5 if stable else 2,
            )
    size = 5.0 if len(markers) <= _FEW else 3.8
    for marker in markers:
        values = np.unique(np.round(marker.values[panel], 12))
        ax.plot(np.full(len(values), marker.x), values, linestyle="none", zorder=3, **mark_style(marker.type, size))


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
    bulk = np.quantile(values, [_RARE, 1 - _RARE])
    low, high = (float(end(np.append(np.concatenate(branches), bulk))) for end in (np.min, np.max))
    if values.min() < low - (high - low) or values.max() > high + (high - low):
        ax.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))


def _coincide(one: BranchLine, other: BranchLine, panel: str) -> bool:
    a, b = one.values[panel], other.values[panel]
    return len(a) == len(b) and np.array_equal(one.x, other.x) and np.allclose(a, b, rtol=1e-9, atol=1e-12)


def runs(flags: npt.NDArray[np.bool_]) -> list[tuple[int, int, bool]]:
    """Return the stretches of equal flags as (start, stop, flag).

    Examples
    --------
    >>> runs(np.array([True, True, False]))
    [(0, 2, True), (2, 3, False)]
    """
    if not len(flags):
        return []
    edges = np.flatnonzero(np.diff(flags.astype(np.int8))) + 1
    bounds = [0, *edges.tolist(), len(flags)]
    return [(a, b, bool(flags[a])) for a, b in itertools.pairwise(bounds)]
