"""Runs of a rig beside the model, a panel a run: gap and relative velocity, and waits between impacts."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import SHOWN, name_axis
from vines.figures._colours import COLOURS, PALETTE
from vines.figures._fit import columns_in
from vines.figures._legend import add_legend
from vines.figures._style import font, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["RigCycle", "rig_cycles_figure", "rig_waits_figure"]

Floats = npt.NDArray[np.float64]

_COLUMNS = 3
_HEIGHT = 2.2


@dataclass(frozen=True)
class RigCycle:
    """A repetition of the pattern of a run, measured and of the model.

    Attributes
    ----------
    title : str
        Run, pattern, verdict.
    w, w_dot, model_w, model_w_dot : (n,) array
        Mean gap and relative velocity over the repetition, dimensionless.
    edges : (k + 1,) array
        Bins of the waits between impacts, in forcing periods.
    share, model_share : (k,) array
        Share of the waits in each.
    rms : (float, float)
        Normalised rms of the differences of w and w'.
    """

    title: str
    w: Floats
    w_dot: Floats
    model_w: Floats
    model_w_dot: Floats
    edges: Floats
    share: Floats
    model_share: Floats
    rms: tuple[float, float]


def rig_cycles_figure(cycles: Sequence[RigCycle], *, caption: str = "", width: float = 7.0) -> Figure:
    """Draw w' over w of each run and of the model.

    Parameters
    ----------
    cycles : sequence of RigCycle
        A panel each.
    caption : str
        Written above everything.
    width : float
        Width of the figure [inch].
    """
    return _grid(cycles, _phase_plane, ("w", SHOWN["w"]), ("w_dot", SHOWN["w_dot"]), caption, width)


def rig_waits_figure(cycles: Sequence[RigCycle], *, caption: str = "", width: float = 7.0) -> Figure:
    """Draw histograms of the times between impacts of each run and of the model's ensemble.

    Parameters
    ----------
    cycles : sequence of RigCycle
        A panel each.
    caption : str
        Written above everything.
    width : float
        Width of the figure [inch].
    """
    wait = ("dt", r"time to next impact  $\Delta t/T$")
    return _grid(cycles, _histogram, wait, ("share", SHOWN["share"]), caption, width)


def _grid(
    cycles: Sequence[RigCycle],
    draw: Callable[[Axes, RigCycle], None],
    x: tuple[str, str],
    y: tuple[str, str],
    caption: str,
    width: float,
) -> Figure:
    import matplotlib as mpl
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    columns = columns_in(width, max(1, min(_COLUMNS, len(cycles))))
    rows = max(1, math.ceil(len(cycles) / columns))
    with mpl.rc_context(look()):
        figure = new_figure(width, 0.8 + _HEIGHT * rows)
        axes = figure.subplots(rows, columns, squeeze=False)
        for k, ax in enumerate(axes.flat):
            if k >= len(cycles):
                ax.set_axis_off()
                continue
            draw(ax, cycles[k])
            ax.set_title(_told(cycles[k], draw), fontsize=font(7.5), loc="left", pad=3)
            name_axis(ax, "y", *y, written=k % columns == 0)
            name_axis(ax, "x", *x, written=k + columns >= len(cycles))
        figure.align_ylabels(axes[:, 0])
        if caption:
            figure.suptitle(caption, fontsize=font(8.5), x=0.01, ha="left")
        measured: Any = (
            Patch(color=PALETTE["orange"], alpha=0.45) if draw is _histogram else Line2D([], [], **_measured())
        )
        add_legend(figure, [("measured", (measured,)), ("model", (Line2D([], [], **_model()),))])
    return figure


def _measured() -> dict[str, Any]:
    return {"color": PALETTE["orange"], "linewidth": 2.6, "alpha": 0.75}


def _model() -> dict[str, Any]:
    return {"color": COLOURS["ink"], "linewidth": 0.9}


def _phase_plane(ax: Axes, cycle: RigCycle) -> None:
    for wall in (-1.0, 1.0):
        ax.axvline(wall, color=COLOURS["mark"], linewidth=0.6, zorder=0)
    ax.plot(_closed(cycle.w), _closed(cycle.w_dot), zorder=2, **_measured())
    ax.plot(_closed(cycle.model_w), _closed(cycle.model_w_dot), zorder=3, **_model())
    ax.set_xlim(-1.12, 1.12)


def _told(cycle: RigCycle, draw: Callable[[Axes, RigCycle], None]) -> str:
    """Return the title of a panel; that of w' over w gives the normalised rms of both differences."""
    if draw is _histogram:
        return cycle.title
    return cycle.title + "\n" + rf"rms of $w$ {cycle.rms[0]:.1%}, of $\dot w$ {cycle.rms[1]:.1%}"


def _closed(values: Floats) -> Floats:
    return np.append(values, values[:1])


def _histogram(ax: Axes, cycle: RigCycle) -> None:
    ax.stairs(cycle.share, cycle.edges, fill=True, color=PALETTE["orange"], alpha=0.45, linewidth=0, zorder=2)
    ax.stairs(cycle.model_share, cycle.edges, zorder=3, **_model())
    ax.set_xlim(float(cycle.edges[0]), float(cycle.edges[-1]))
    ax.set_ylim(0, None)
