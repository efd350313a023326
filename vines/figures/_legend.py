"""The legend of a bifurcation diagram."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from vines.figures._marks import DOTTED, MARKS, mark_style
from vines.figures._style import COLOURS, FAMILIES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures._bifurcation import BranchLine, ImpactDots, Marker

__all__ = ["add_legend", "legend_entries"]

_LISTED = 3
"""Values of the parameter that an entry lists at most; more would hide the entry."""


def legend_entries(
    dots: Sequence[ImpactDots], lines: Sequence[BranchLine], markers: Sequence[Marker]
) -> list[tuple[str, tuple[Any, ...]]]:
    """Return the entries as (label, lines drawn side by side): left end, then right end."""
    from matplotlib.lines import Line2D

    entries: list[tuple[str, tuple[Any, ...]]] = []
    for label in dict.fromkeys(group.label for group in dots):
        point = {"linestyle": "none", "marker": ".", "markersize": 6, "markeredgewidth": 0}
        entries.append((label, tuple(Line2D([], [], color=COLOURS[f"{side} light"], **point) for side in "LR")))
    for label, family in dict.fromkeys((line.label, line.family) for line in lines):
        entries.append((label, tuple(Line2D([], [], color=colour, linewidth=1.6) for colour in FAMILIES[family])))
    styles: tuple[tuple[str, Any, bool], ...] = (
        ("stable", "-", any(line.stable.any() for line in lines)),
        ("unstable", DOTTED, any((~line.stable).any() for line in lines)),
    )
    for word, style, there in styles:
        if there:
            entries.append((word, (Line2D([], [], color=COLOURS["ink"], linewidth=1.4, linestyle=style),)))
    for kind in dict.fromkeys(marker.type for marker in markers):
        _, word = MARKS.get(kind, ("x", kind))
        places = list(dict.fromkeys(f"{marker.x:.5g}" for marker in markers if marker.type == kind))
        listed = f" ({', '.join(places)})" if len(places) <= _LISTED else ""
        entries.append((f"{word}{listed}", (Line2D([], [], linestyle="none", **mark_style(kind)),)))
    return entries


def add_legend(figure: Figure, entries: Sequence[tuple[str, tuple[Any, ...]]], ncols: int = 3) -> None:
    """Write a legend below the panels."""
    from matplotlib.legend_handler import HandlerTuple

    if entries:
        # A tuple of lines is drawn side by side by the handler; the annotations of matplotlib know single ones only.
        handles: Any = [drawn for _, drawn in entries]
        figure.legend(
            handles,
            [label for label, _ in entries],
            handler_map={tuple: HandlerTuple(ndivide=None, pad=0.3)},
            loc="outside lower center",
            ncols=ncols,
            columnspacing=1.6,
            handlelength=2.6,
        )
