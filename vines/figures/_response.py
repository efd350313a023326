"""Figures put together from declared panels: energy measures and impact velocities of all attractors of sweeps."""

from __future__ import annotations

import itertools
import string
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import SHOWN, name_axis
from vines.figures._colours import BALLS, COLOURS
from vines.figures._energy import LOCKED, NO_BALL, EnergyPanel, cross, diamond, draw_energy, draw_reduction, frame
from vines.figures._fit import columns_in
from vines.figures._legend import add_legend, ball_entries
from vines.figures._style import font, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["VelocityPanel", "response_figure"]

_HEIGHTS = (2.3, 1.0)
"""Heights of a panel and of the strip of reductions below it [inch]."""


@dataclass(frozen=True)
class VelocityPanel:
    """Relative impact velocities of simulated attractors, red on the left end, blue on the right.

    Attributes
    ----------
    axis : str
        The varied parameter.
    x, w_dot : (n,) array
        Its value at each impact, and the relative velocity just before it.
    side : (n,) array
        +1 on the left end, -1 on the right.
    found : (n,) array of int
        Place in :data:`FOUND` of the attractor that the impact belongs to.
    caption : str
        The fixed parameters.
    window : (float, float), optional
        The part of the varied parameter that is shown.
    ball : (n,) array of int, optional
        Number of the ball that hits, where balls have numbers: it gives the colour, the side the shape.
    """

    axis: str
    x: npt.NDArray[np.float64]
    w_dot: npt.NDArray[np.float64]
    side: npt.NDArray[np.integer[Any]]
    found: npt.NDArray[np.integer[Any]]
    caption: str = ""
    window: tuple[float, float] | None = None
    ball: npt.NDArray[np.integer[Any]] | None = None


def response_figure(
    panels: Sequence[EnergyPanel | VelocityPanel], *, columns: int = 2, caption: str = "", width: float = 7.0
) -> Figure:
    """Draw panels row by row, lettered; below each energy panel a strip with the reduction of max|x1|.

    Parameters
    ----------
    panels : sequence of EnergyPanel or VelocityPanel
        In the order of the letters.
    columns : int
        Panels side by side; fewer where the figure is too narrow for them.
    caption : str
        The parameters that all panels share, written above everything.
    width : float
        Width of the figure [inch].
    """
    import matplotlib as mpl

    columns = columns_in(width, columns)
    rows = [panels[k : k + columns] for k in range(0, len(panels), columns)]
    strips = [any(isinstance(panel, EnergyPanel) for panel in row) for row in rows]
    heights = [sum(_HEIGHTS) if strip else _HEIGHTS[0] for strip in strips]
    letters = itertools.cycle(string.ascii_lowercase)
    with mpl.rc_context(look()):
        figure = new_figure(width, 0.9 + sum(heights))
        grid = figure.add_gridspec(len(rows), columns, height_ratios=heights)
        for i, row in enumerate(rows):
            for j, panel in enumerate(row):
                axes = _axes(figure, grid[i, j], isinstance(panel, EnergyPanel))
                title = f"({next(letters)})  {panel.caption}".rstrip()
                axes[0].set_title(title, fontsize=font(8.5), loc="left", pad=4)
                _draw(axes, panel, first=j == 0)
        if caption:
            figure.suptitle(caption, fontsize=font(8.5), x=0.01, ha="left")
        add_legend(figure, _legend(panels), ncols=3)
    return figure


def _axes(figure: Figure, place: Any, strip: bool) -> list[Axes]:
    if not strip:
        return [figure.add_subplot(place)]
    inner = place.subgridspec(2, 1, height_ratios=_HEIGHTS, hspace=0.0)
    above = figure.add_subplot(inner[0])
    below = figure.add_subplot(inner[1], sharex=above)
    above.tick_params(labelbottom=False)
    return [above, below]


def _draw(axes: Sequence[Axes], panel: EnergyPanel | VelocityPanel, *, first: bool) -> None:
    if isinstance(panel, EnergyPanel):
        draw_energy(axes[0], panel)
        draw_reduction(axes[1], panel)
        sizes = ("energy", SHOWN["energy"]) if panel.ratio else ("max_abs_x1", r"$\max|x_1|$")
        named = [sizes, ("reduction", "reduction")]
    else:
        _draw_velocities(axes[0], panel)
        named = [("w_dot", r"$\dot w$")]
    for ax, (name, text) in zip(axes, named, strict=True):
        name_axis(ax, "y", name, text, written=first)
        name_axis(ax, "x", panel.axis, written=ax is axes[-1])


def _draw_velocities(ax: Axes, panel: VelocityPanel) -> None:
    few = len(np.unique(panel.x)) < _FEW
    dot = {**_DOT, **(_DOT_OF_FEW if few else {})}
    for ball in () if panel.ball is None else np.unique(panel.ball):
        for side, marker in ((1, "<"), (-1, ">")):
            mine = (panel.side == side) & (panel.ball == ball)
            look = {**dot, "marker": marker, "color": BALLS[(int(ball) - 1) % len(BALLS)]}
            ax.plot(panel.x[mine], panel.w_dot[mine], rasterized=True, zorder=1, **look)
    for light in (True, False) if panel.ball is None else ():
        for side, name in ((1, "L"), (-1, "R")):
            mine = (panel.side == side) & ((panel.found > 0) == light)
            ax.plot(
                panel.x[mine],
                panel.w_dot[mine],
                color=COLOURS[f"{name} light" if light else name],
                rasterized=True,
                zorder=1 if light else 2,
                **dot,
            )
    frame(ax, panel.x, panel.window)
    ax.axhline(0.0, color=COLOURS["mark"], linewidth=0.5, zorder=0)


_DOT: Any = {"linestyle": "none", "marker": ".", "markersize": 1.6, "markeredgewidth": 0, "alpha": 0.55}
_DOT_OF_FEW: Any = {"markersize": 3.2, "alpha": 0.9}
_FEW = 120
"""Points along x below which dots are large enough to be seen singly; more of them make lines and clouds."""


def _legend(panels: Sequence[EnergyPanel | VelocityPanel]) -> list[tuple[str, tuple[Any, ...]]]:
    """Return the entries: what the marks mean, how attractors were found, and the yardsticks."""
    from matplotlib.lines import Line2D

    entries: list[tuple[str, tuple[Any, ...]]] = []
    energy = [panel for panel in panels if isinstance(panel, EnergyPanel)]
    velocity = [panel for panel in panels if isinstance(panel, VelocityPanel)]
    found = {int(k) for panel in energy for curve in panel.curves for k in np.unique(curve.found)}
    words = ("upward sweep", "another attractor, downwards", "another, from random starts")
    ratio = any(panel.ratio for panel in energy)
    for k in sorted(found):
        marks = ([Line2D([], [], **diamond("black", k, 4.0))] if ratio else []) + [
            Line2D([], [], **cross("black", k, 4.0))
        ]
        what = (r"$K_2/K_1$ and $\max|x_1|$: " if ratio else r"$\max|x_1|$: ") if k == 0 else ""
        entries.append((what + words[k], tuple(marks)))
    numbered = sorted({int(k) for panel in velocity if panel.ball is not None for k in np.unique(panel.ball)})
    entries += ball_entries(numbered)
    velocity = [panel for panel in velocity if panel.ball is None]
    if velocity:
        dots = [Line2D([], [], color=COLOURS[side], **{**_DOT, "markersize": 6, "alpha": 1}) for side in "LR"]
        entries.append((r"$\dot w$ on L, R", tuple(dots)))
    if velocity and any((panel.found > 0).any() for panel in velocity):
        dots = [
            Line2D([], [], color=COLOURS[f"{side} light"], **{**_DOT, "markersize": 6, "alpha": 1}) for side in "LR"
        ]
        entries.append((r"$\dot w$ of other attractors", tuple(dots)))
    if energy:
        body = " or ".join(dict.fromkeys(panel.body for panel in energy))
        entries.append((f"with no {body}", (Line2D([], [], color=COLOURS["ink"], **NO_BALL),)))
        entries.append((f"with the {body} locked", (Line2D([], [], color=COLOURS["ink"], **LOCKED),)))
    return entries
