"""Bifurcation diagrams: simulated impacts as dots, branches of periodic orbits as lines."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.errors import DeclarationError, nearest
from vines.figures._style import COLOURS, RC, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["PANELS", "BranchLine", "ImpactDots", "Marker", "bifurcation_figure"]

Floats = npt.NDArray[np.float64]

PANELS = {
    "w_dot": r"relative impact velocity  $\dot w$",
    "dt": r"time to next impact  $\Delta t / T$",
    "x1": r"displacement at impact  $x_1$",
    "phase": r"impact phase  $\psi$  [rad]",
}

SYMBOLS = {"A": "A", "mu": r"\mu", "Omega": r"\Omega", "r": "r", "lam": r"\lambda"}
NAMES = {
    "A": "forcing amplitude",
    "mu": "mass ratio",
    "Omega": "frequency ratio",
    "r": "restitution",
    "lam": "damping",
}

MARKS = {
    "symmetry_breaking": ("o", "symmetry breaking"),
    "period_doubling": ("s", "period doubling"),
    "fold": ("D", "fold"),
    "neimark_sacker": ("^", "Neimark–Sacker"),
    "grazing": ("v", "grazing"),
    "pair_turns_real": ("|", "a pair of multipliers turns real"),
}


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
    """

    x: Floats
    side: int
    stable: npt.NDArray[np.bool_]
    values: dict[str, Floats]
    label: str


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

    Raises
    ------
    DeclarationError
        If a panel is not known.
    """
    import matplotlib as mpl

    for panel in panels:
        if panel not in PANELS:
            raise DeclarationError(f"unknown panel {panel!r} of a bifurcation diagram: {nearest(panel, PANELS)}")
    with mpl.rc_context(RC):
        figure = new_figure(width, 0.55 + 2.55 * len(panels))
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for letter, panel, ax in zip("abcdefgh", panels, axes, strict=False):
            _draw(ax, panel, dots, lines, markers)
            ax.set_ylabel(PANELS[panel])
            _widen(ax)
            ax.text(-0.082, 1.0, f"({letter})", transform=ax.transAxes, va="top", fontweight="bold")
        axes[-1].set_xlabel(f"{NAMES.get(axis, axis)}  ${SYMBOLS.get(axis, axis)}$")
        everything = [group.x for group in (*dots, *lines) if len(group.x)]
        if everything:
            low, high = min(float(x.min()) for x in everything), max(float(x.max()) for x in everything)
            axes[-1].set_xlim(low - 0.01 * (high - low), high + 0.01 * (high - low))
        if caption:
            axes[0].set_title(caption, fontsize=8.5, loc="left", pad=6)
        _legend(figure, dots, lines, markers)
    return figure


def _draw(
    ax: Axes, panel: str, dots: Sequence[ImpactDots], lines: Sequence[BranchLine], markers: Sequence[Marker]
) -> None:
    for group in dots:
        for side, name in ((1, "L"), (-1, "R")):
            mine = group.side == side
            ax.plot(
                group.x[mine],
                group.values[panel][mine],
                linestyle="none",
                marker=".",
                markersize=4.2,
                markeredgewidth=0,
                color=COLOURS[f"{name} light"],
                rasterized=bool(np.count_nonzero(mine) > 20_000),
                zorder=1,
            )
    for line in lines:
        # Where left and right coincide, as the flight times of a symmetric orbit do, neither colour would be true.
        twin = any(o is not line and o.side != line.side and _coincide(o, line, panel) for o in lines)
        colour = COLOURS["ink" if twin else "L" if line.side == 1 else "R"]
        for start, stop, stable in runs(line.stable):
            # One point is shared with the next run, so that the line has no gap where stability changes.
            part = slice(start, min(stop + 1, len(line.x)))
            ax.plot(
                line.x[part],
                line.values[panel][part],
                color=colour,
                linestyle="-" if stable else (0, (1, 1.6)),
                linewidth=1.1 if stable else 1.4,
                zorder=2,
            )
    for marker in markers:
        symbol, _ = MARKS.get(marker.type, ("x", marker.type))
        values = np.unique(np.round(marker.values[panel], 12))
        ax.plot(
            np.full(len(values), marker.x),
            values,
            linestyle="none",
            marker=symbol,
            markersize=5,
            markerfacecolor="white",
            markeredgecolor=COLOURS["ink"],
            markeredgewidth=1.0,
            zorder=3,
        )


def _widen(ax: Axes) -> None:
    """Keep an axis from magnifying rounding noise into structure."""
    ax.ticklabel_format(axis="y", useOffset=False)
    low, high = ax.get_ylim()
    middle, least = (low + high) / 2, 1e-6 * max(abs(low), abs(high), 1e-6)
    if high - low < least:
        ax.set_ylim(middle - least / 2, middle + least / 2)


def _coincide(one: BranchLine, other: BranchLine, panel: str) -> bool:
    a, b = one.values[panel], other.values[panel]
    return len(a) == len(b) and np.array_equal(one.x, other.x) and np.allclose(a, b, rtol=1e-9, atol=1e-12)


def _legend(figure: Figure, dots: Sequence[ImpactDots], lines: Sequence[BranchLine], markers: Sequence[Marker]) -> None:
    from matplotlib.lines import Line2D

    entries: list[Line2D] = []
    for label in dict.fromkeys(group.label for group in dots):
        for name, word in (("L", "left"), ("R", "right")):
            entries.append(
                Line2D([], [], linestyle="none", marker=".", markersize=6, markeredgewidth=0,
                       color=COLOURS[f"{name} light"], label=f"{label}, {word} end")
            )  # fmt: skip
    for label in dict.fromkeys(line.label for line in lines):
        mine = [line for line in lines if line.label == label]
        if any(line.stable.any() for line in mine):
            entries.append(Line2D([], [], color=COLOURS["ink"], linewidth=1.3, label=f"{label}, stable"))
        if any((~line.stable).any() for line in mine):
            entries.append(
                Line2D(
                    [],
                    [],
                    color=COLOURS["ink"],
                    linewidth=1.5,
                    linestyle=(0, (1, 1.6)),
                    label=f"{label}, unstable",
                )
            )
    for kind in dict.fromkeys(marker.type for marker in markers):
        symbol, word = MARKS.get(kind, ("x", kind))
        places = ", ".join(f"{m.x:.5g}" for m in markers if m.type == kind)
        entries.append(
            Line2D([], [], linestyle="none", marker=symbol, markersize=5, markerfacecolor="white",
                   markeredgecolor=COLOURS["ink"], label=f"{word} ({places})")
        )  # fmt: skip
    if entries:
        figure.legend(handles=entries, loc="outside lower center", ncols=3, columnspacing=1.6, handlelength=2.2)


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
