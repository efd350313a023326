"""Branches of the model with the points of a rig on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._colours import COLOURS
from vines.figures._diagram import BranchLine, Marker
from vines.figures._diagram_panel import DiagramPanel
from vines.figures._legend import Entry, add_legend
from vines.figures._names import MEASURES
from vines.figures._style import font, look, new_figure, write_letter

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["DIRECTIONS", "RigPoints", "rig_branches_figure", "rig_mark"]

Floats = npt.NDArray[np.float64]

DIRECTIONS = {"sweep_up": "^", "sweep_down": "v", "dwell": "o"}
"""Symbol of each protocol."""

_WORDS = {"sweep_up": "rig, amplitude rising", "sweep_down": "rig, amplitude falling", "dwell": "rig, dwell"}


@dataclass(frozen=True)
class RigPoints:
    """A measured quantity of some runs, at the measured amplitude.

    Attributes
    ----------
    x, u_x : (n,) array
        Forcing amplitude and its standard uncertainty.
    y, u_y : (n,) array
        The quantity and its standard uncertainty.
    side : (n,) array of int
        +1 for impacts on the left end, -1 on the right, 0 for a quantity of a whole run.
    protocol : (n,) array of str
        Keys of :data:`DIRECTIONS`.
    good : (n,) array of bool
        Whether the run passed its gates and a pattern holds; others are drawn empty.
    model, u_model : (n,) array
        What the model gives at the measured parameters of each run; nan where that was not asked.
    """

    x: Floats
    u_x: Floats
    y: Floats
    u_y: Floats
    side: npt.NDArray[np.integer[Any]]
    protocol: npt.NDArray[np.str_]
    good: npt.NDArray[np.bool_]
    model: Floats
    u_model: Floats


def rig_branches_figure(
    points: Mapping[str, RigPoints],
    lines: Sequence[BranchLine],
    markers: Sequence[Marker] = (),
    *,
    caption: str = "",
    width: float = 7.0,
    window: tuple[float, float] | None = None,
) -> Figure:
    """Draw a panel for each measured quantity over the forcing amplitude, with branches, points and error bars.

    Parameters
    ----------
    points : mapping of str to RigPoints
        By quantity, one of :data:`RIG_PANELS`; a panel each, in this order.
    lines : sequence of BranchLine
        Those of side 0 are drawn where quantities are of a whole run, the others where they are of impacts.
    markers : sequence of Marker
        Bifurcations, drawn where they have the quantity.
    caption : str
        The parameters of the branches, written above the first panel.
    width : float
        Width of the figure [inch].
    window : (float, float), optional
        The part of the amplitudes that is shown; all runs with a margin by default.
    """
    import matplotlib as mpl

    window = window or _around(points)
    with mpl.rc_context(look()):
        figure = new_figure(width, 0.9 + 2.5 * len(points))
        axes = figure.subplots(len(points), 1, sharex=True, squeeze=False)[:, 0]
        entries: dict[str, tuple[Any, ...]] = {}
        for letter, ax, (quantity, own) in zip("abcdefgh", axes, points.items(), strict=False):
            mine = [line for line in lines if (line.side == 0) == (quantity in MEASURES)]
            marks = [mark for mark in markers if quantity in mark.values]
            panel = DiagramPanel("A", quantity, (), mine, marks, window=window)
            panel.draw(ax)
            _draw(ax, own)
            if len(points) > 1:
                write_letter(ax, letter)
            entries |= {label: entries.get(label, drawn) for label, drawn in (*_entries(own), *panel.entries())}
        for ax in axes[:-1]:
            ax.set_xlabel("")
        figure.align_ylabels(axes)
        axes[0].set_title("; ".join(filter(None, (caption, _BARS))), fontsize=font(8.5), loc="left", pad=6)
        add_legend(figure, list(entries.items()))
    return figure


def rig_mark(protocol: str, colour: str, *, good: bool, size: float = 5.0) -> dict[str, Any]:
    """Return the style of a rig point.

    Examples
    --------
    >>> rig_mark("sweep_down", "#222222", good=False)["markerfacecolor"]
    'white'
    """
    return {
        "linestyle": "none",
        "marker": DIRECTIONS.get(protocol, "o"),
        "markersize": size,
        "markerfacecolor": colour if good else "white",
        "markeredgecolor": colour,
        "markeredgewidth": 0.8,
    }


def _draw(ax: Axes, own: RigPoints) -> None:
    for side, name in _SIDES.items():
        colour = COLOURS[name]
        for protocol in DIRECTIONS:
            for good in (True, False):
                at = (own.side == side) & (own.protocol == protocol) & (own.good == good)
                if not at.any():
                    continue
                ax.errorbar(
                    own.x[at],
                    own.y[at],
                    xerr=2 * own.u_x[at],
                    yerr=2 * own.u_y[at],
                    ecolor=colour,
                    elinewidth=0.7,
                    capsize=1.5,
                    capthick=0.6,
                    zorder=4,
                    **rig_mark(protocol, colour, good=good),
                )
    there = np.isfinite(own.model)
    ax.errorbar(
        own.x[there],
        own.model[there],
        yerr=2 * own.u_model[there],
        ecolor=COLOURS["mark"],
        elinewidth=2.2,
        alpha=0.75,
        zorder=3.5,
        **_model(),
    )


_BARS = "bars: two standard uncertainties"
_SIDES = {1: "L", -1: "R", 0: "ink"}


def _model() -> dict[str, Any]:
    return {
        "linestyle": "none",
        "marker": "s",
        "markersize": 8.5,
        "markerfacecolor": "none",
        "markeredgecolor": COLOURS["mark"],
        "markeredgewidth": 0.9,
    }


def _entries(own: RigPoints) -> list[Entry]:
    from matplotlib.lines import Line2D

    found: list[Entry] = []
    for protocol in DIRECTIONS:
        if (own.protocol == protocol).any():
            mark = Line2D([], [], **rig_mark(protocol, COLOURS["ink"], good=True))
            found.append((_WORDS[protocol], (mark,)))
    if not own.good.all():
        mark = Line2D([], [], **rig_mark(str(own.protocol[~own.good][0]), COLOURS["ink"], good=False))
        found.append(("empty: gates failed, or no pattern holds", (mark,)))
    if np.isfinite(own.model).any():
        found.append(("model at the measured parameters", (Line2D([], [], **_model()),)))
    return found


def _around(points: Mapping[str, RigPoints]) -> tuple[float, float] | None:
    """Return a window about all runs."""
    x = np.concatenate([own.x for own in points.values()] or [np.zeros(0)])
    x = x[np.isfinite(x)]
    if not len(x):
        return None
    margin = max(0.12 * float(np.ptp(x)), 0.02 * float(x.max()))
    return float(x.min()) - margin, float(x.max()) + margin
