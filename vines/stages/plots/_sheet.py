"""A sheet: panels of several kinds, each of some of the needed stages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from vines.figures import (
    RUN_PANELS,
    DiagramPanel,
    EndsPanel,
    GapPanel,
    MultiplierPanel,
    Panel,
    PhasePlanePanel,
    sheet_figure,
)
from vines.pipeline import Input
from vines.stages.plots._diagram import diagram_parts, listed, shared_params
from vines.stages.plots._multipliers import multiplier_lines
from vines.stages.plots._run_panels import run_curves

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["sheet"]


def sheet(inputs: Mapping[str, Input], options: Any) -> Figure:
    """Draw the cells of a sheet.

    Raises
    ------
    DeclarationError
        If a cell names a branch that there is not.
    """
    panels = [_panel(cell, [inputs[name] for name in cell.of], mirror=options.mirror) for cell in options.cells]
    return sheet_figure(
        panels,
        columns=options.columns,
        letters=options.letters,
        caption=options.title or listed(shared_params(list(inputs.values()))),
        width=options.width,
        height=options.height,
    )


def _panel(cell: Any, stages: list[Input], *, mirror: bool) -> Panel:
    look: dict[str, Any] = {"title": cell.title, "y": cell.y}
    if cell.show in RUN_PANELS:
        runs = run_curves(stages)
        if cell.show == "phase_plane":
            return PhasePlanePanel(runs, **look)
        panel = EndsPanel if cell.show == "ends" else GapPanel
        return panel(runs[0], cell.periods, **look)
    axis, names = stages[0].axes[0], {kind: f"${text}$" for kind, text in cell.marks.items() if text}
    if cell.show == "multipliers":
        (branch,) = multiplier_lines(stages, cell.families)
        met = [(kind, place) for kind, place in branch.marks if not cell.marks or kind in cell.marks]
        return MultiplierPanel(axis, replace(branch, marks=met), cell.window, names=names, **look)
    parts = diagram_parts(stages, mirror=mirror, families=cell.families, marks=cell.marks)
    look |= {"window": cell.window, "opacity": cell.opacity, "names": names, "places": False}
    return DiagramPanel(axis, cell.show, *parts, **look)
