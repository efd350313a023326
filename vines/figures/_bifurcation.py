"""Bifurcation diagrams: simulated impacts as dots, branches of periodic orbits as lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from vines.errors import DeclarationError, nearest
from vines.figures._diagram import BranchLine, ImpactDots, Marker
from vines.figures._diagram_panel import DiagramPanel
from vines.figures._legend import add_legend
from vines.figures._names import PANELS
from vines.figures._style import font, look, new_figure, write_letter

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["bifurcation_figure"]


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
    with mpl.rc_context(look()):
        figure = new_figure(width, 0.75 + 2.75 * len(panels))
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        drawn = [DiagramPanel(axis, panel, dots, lines, markers, window=window) for panel in panels]
        for letter, panel, ax in zip("abcdefgh", drawn, axes, strict=False):
            panel.draw(ax)
            write_letter(ax, letter)
        for ax in axes[:-1]:
            ax.set_xlabel("")
        if caption:
            axes[0].set_title(caption, fontsize=font(8.5), loc="left", pad=6)
        add_legend(figure, drawn[0].entries())
    return figure
