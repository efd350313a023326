"""The plot ``sheet``: panels of several kinds on a grid, each of some of the needed stages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Literal

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError
from vines.figures import PANELS, RUN_PANELS
from vines.model import with_one_ball
from vines.stages.plots._checks import called, cells, has_diagram, has_runs, one_system
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures import Panel
    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "SheetCell", "SheetOptions"]

_SHOWN = (*RUN_PANELS, "multipliers", *PANELS)
_Show = Annotated[str, Meta(description="What is shown", extra_json_schema={"enum": list(_SHOWN)})]


class SheetCell(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A panel: what it shows of which of the needed stages.

    Of runs it shows the two ends of the cavity with the ball (`ends`) or gap and relative velocity (`gap`) over
    `periods` forcing periods, or the phase plane of all of them. Of sweeps and branches that vary one parameter it
    shows a quantity, or the moduli of the multipliers of the branch that `families` names.
    """

    show: _Show
    of: Annotated[tuple[str, ...], Meta(description="The stages that it shows")]
    title: Annotated[str, Meta(description="Written above the panel")] = ""
    periods: Annotated[float, Meta(description="Forcing periods of a run that are shown")] = 3.0
    families: Annotated[
        tuple[str, ...], Meta(description="Labels of the branches shown, such as '1:1 symmetric'; all if empty")
    ] = ()
    marks: Annotated[
        dict[str, str],
        Meta(description="Types of bifurcations that are marked, each with what is written beside it; all if empty"),
    ] = {}
    opacity: Annotated[
        float | None, Meta(description="Opacity of simulated impacts; where they repeat they add up to solid")
    ] = None
    window: Annotated[tuple[float, float] | None, Meta(description="The part of the horizontal axis shown")] = None
    y: Annotated[tuple[float, float] | None, Meta(description="The part of the vertical axis shown")] = None


class SheetOptions(PlotOptions, frozen=True, tag="sheet"):
    """Runs, sweeps and branches in `cells` of several kinds, row by row, with one legend."""

    cells: Annotated[tuple[SheetCell, ...], Meta(description="The panels, row by row")] = ()
    columns: Annotated[int, Meta(ge=1, description="Panels in a row")] = 1
    letters: Annotated[Literal["panels", "rows"], Meta(description="What is lettered")] = "panels"
    height: Annotated[float, Meta(gt=0, description="Height of a row [inch]")] = 2.3
    mirror: Annotated[bool, Meta(description="Whether mirror images of asymmetric orbits are drawn too")] = False


def _check(stage: Stage, pipeline: Pipeline) -> None:
    for where, cell, shown in cells(stage, pipeline, _SHOWN):
        system = one_system(shown, where)
        without = with_one_ball(system).without
        if cell.show in without:
            shows = ", ".join(name for name in _SHOWN if name not in without)
            raise DeclarationError(f"{where}: the system {system!r} has no {cell.show}; a sheet of it shows {shows}")
        if cell.show in RUN_PANELS:
            if not all(map(has_runs, shown)) or (cell.show != "phase_plane" and len(shown) > 1):
                raise DeclarationError(f"{where} shows one stage of kind 'trajectory', a phase plane also more")
            continue
        varied = {tuple(axis.name for axis in one.axes) for one in shown}
        if not all(map(has_diagram, shown)) or len(varied) != 1 or {len(names) for names in varied} != {1}:
            raise DeclarationError(f"{where} shows sweeps and branches that vary one and the same parameter")
        if cell.show == "multipliers" and (
            not all(called(one.kind.tables, "branches") for one in shown) or len(cell.families) != 1
        ):
            raise DeclarationError(f"{where} shows one family of stages of kind 'branch'; name it in families")


def _draw(inputs: Mapping[str, Input], options: SheetOptions) -> Figure:
    from vines.figures import sheet_figure
    from vines.stages.plots._caption import listed, shared_params

    panels = [_panel(cell, [inputs[name] for name in cell.of], mirror=options.mirror) for cell in options.cells]
    return sheet_figure(
        panels,
        columns=options.columns,
        letters=options.letters,
        caption=options.title or listed(shared_params(inputs.values())),
        width=options.inches,
        height=options.height,
    )


def _panel(cell: SheetCell, stages: list[Input], *, mirror: bool) -> Panel:
    from vines.figures import DiagramPanel, EndsPanel, GapPanel, MultiplierPanel, PhasePlanePanel
    from vines.stages.plots._diagram import diagram_parts
    from vines.stages.plots._runs import run_curves
    from vines.stages.plots.multipliers import multiplier_lines

    look: dict[str, Any] = {"title": cell.title, "y": cell.y}
    if cell.show in RUN_PANELS:
        runs = run_curves(stages)
        if cell.show == "phase_plane":
            return PhasePlanePanel(runs, **look)
        panel = EndsPanel if cell.show == "ends" else GapPanel
        # the first run, which has a curve for each of its balls
        return panel(runs[0], cell.periods, balls=runs[1 : max(run.ball for run in runs)], **look)
    axis, names = stages[0].axes[0], {kind: f"${text}$" for kind, text in cell.marks.items() if text}
    if cell.show == "multipliers":
        (branch,) = multiplier_lines(stages, cell.families)
        met = [(kind, place) for kind, place in branch.marks if not cell.marks or kind in cell.marks]
        return MultiplierPanel(axis, replace(branch, marks=met), cell.window, names=names, **look)
    parts = diagram_parts(stages, mirror=mirror, families=cell.families, marks=cell.marks)
    look |= {"window": cell.window, "opacity": cell.opacity, "names": names, "places": False}
    return DiagramPanel(axis, cell.show, *parts, **look)


PLOT = Plot(
    summary="panels of several kinds on a grid",
    options=SheetOptions,
    draw=_draw,
    check=_check,
    tables=("impacts", "orbits"),
)
