"""The legend of a bifurcation diagram."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.figures._colours import BALLS, COLOURS, FAMILIES
from vines.figures._fit import place_legend
from vines.figures._marks import DOTTED, MARKS, mark_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures._diagram import BranchLine, ImpactDots, Marker

__all__ = ["Entry", "add_legend", "ball_entries", "legend_entries", "mark_entries"]

Entry = tuple[str, tuple[Any, ...]]
"""A label, and the lines that are drawn side by side before it."""

_LISTED = 3
"""Values of the parameter that an entry lists at most; more would hide the entry."""


def legend_entries(
    dots: Sequence[ImpactDots],
    lines: Sequence[BranchLine],
    markers: Sequence[Marker],
    *,
    names: Mapping[str, str] | None = None,
    places: bool = True,
    full: bool = False,
) -> list[Entry]:
    """Return the entries: left end, then right end.

    Parameters
    ----------
    dots, lines, markers : sequences
        What is drawn.
    names : mapping of str to str, optional
        What is written beside the bifurcations of a type.
    places : bool
        Whether the places of all bifurcations are given, or of those with names only.
    full : bool
        Whether dots have the colours of the ends in full.
    """
    from matplotlib.lines import Line2D

    entries: list[Entry] = []
    numbered = sorted({int(ball) for group in dots if group.ball is not None for ball in np.unique(group.ball)})
    entries += ball_entries(numbered or sorted({line.ball for line in lines if line.ball}), dots=bool(numbered))
    for label in dict.fromkeys(group.label for group in dots if group.ball is None):
        point = {"linestyle": "none", "marker": ".", "markersize": 6, "markeredgewidth": 0}
        entries.append(
            (label, tuple(Line2D([], [], color=COLOURS[side if full else f"{side} light"], **point) for side in "LR"))
        )
    for label in dict.fromkeys(line.label for line in lines if line.ball):
        entries.append((label, (Line2D([], [], color=COLOURS["ink"], linewidth=1.6),)))
    for label, family in dict.fromkeys((line.label, line.family) for line in lines if not line.ball):
        entries.append((label, tuple(Line2D([], [], color=colour, linewidth=1.6) for colour in FAMILIES[family])))
    if any(line.stop for line in lines):
        entries.append(("stop in mid-cavity", (Line2D([], [], color=COLOURS["stop"], linewidth=1.6),)))
    styles: tuple[tuple[str, Any, bool], ...] = (
        ("stable", "-", any(line.stable.any() for line in lines)),
        ("unstable", DOTTED, any((~line.stable).any() for line in lines)),
    )
    for word, style, there in styles:
        if there:
            entries.append((word, (Line2D([], [], color=COLOURS["ink"], linewidth=1.4, linestyle=style),)))
    return entries + mark_entries([(marker.type, marker.x) for marker in markers], names or {}, places=places)


def ball_entries(balls: Sequence[int], *, dots: bool = True) -> list[Entry]:
    """Return an entry for each ball with a number, and what the shapes of its impacts mean."""
    from matplotlib.lines import Line2D

    if not balls:
        return []
    swatch: Any = {"linestyle": "none", "marker": "s", "markersize": 5}
    entries: list[Entry] = [
        (f"ball {ball}", (Line2D([], [], color=BALLS[(ball - 1) % len(BALLS)], **swatch),)) for ball in balls
    ]
    ends = (("<", "simulated impact on L"), (">", "on R"))
    for marker, text in ends if dots else ():
        entries.append((text, (Line2D([], [], linestyle="none", marker=marker, markersize=4.5, color=COLOURS["ink"]),)))
    return entries


def mark_entries(marks: Sequence[tuple[str, float]], names: Mapping[str, str], *, places: bool = True) -> list[Entry]:
    """Return an entry for each type of bifurcation, given as (type, place)."""
    from matplotlib.lines import Line2D

    entries: list[Entry] = []
    for kind in dict.fromkeys(kind for kind, _ in marks):
        _, word = MARKS.get(kind, ("x", kind))
        where = list(dict.fromkeys(f"{place:.5g}" for each, place in marks if each == kind))
        listed = f" ({', '.join(where)})" if len(where) <= _LISTED and (places or kind in names) else ""
        name = f"{names[kind]}: " if kind in names else ""
        entries.append((f"{name}{word}{listed}", (Line2D([], [], linestyle="none", **mark_style(kind)),)))
    return entries


def add_legend(figure: Figure, entries: Sequence[Entry], ncols: int = 3) -> None:
    """Write a legend below the panels."""
    from matplotlib.legend_handler import HandlerTuple

    if entries:
        # A tuple of lines is drawn side by side by the handler; the annotations of matplotlib know single ones only.
        handles: Any = [drawn for _, drawn in entries]
        place_legend(
            figure,
            handles,
            [label for label, _ in entries],
            ncols=ncols,
            handler_map={tuple: HandlerTuple(ndivide=None, pad=0.3)},
            columnspacing=1.6,
            handlelength=2.6,
        )
