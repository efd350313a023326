"""The plot ``exits``: how long regimes hold under noise, and which hold most of the time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError, nearest
from vines.stages.plots._checks import called
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures import HeldCurve, Panel
    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "ExitsCell", "ExitsOptions"]


class ExitsCell(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A panel of one stage of kind exits.

    `survival` shows which share of the runs has not left a regime, a curve for each value of the varied parameter;
    `mean` the mean time over that parameter, without splittings that tell none; `shares` shares of the time in the long
    run and of the starts.
    """

    show: Annotated[Literal["survival", "mean", "shares"], Meta(description="What is shown")]
    of: Annotated[str, Meta(description="The stage")]
    names: Annotated[
        tuple[str, ...], Meta(description="Regimes that are shown, such as 1:1 or chaotic; all if empty")
    ] = ()
    title: Annotated[str, Meta(description="Written above the panel")] = ""
    log: Annotated[bool, Meta(description="Whether the parameter has a logarithmic axis")] = False
    y: Annotated[tuple[float, float] | None, Meta(description="The part of the other axis that is shown")] = None


class ExitsOptions(PlotOptions, frozen=True, tag="exits"):
    """Stages of kind exits that vary one parameter, or none, in panels."""

    cells: Annotated[tuple[ExitsCell, ...], Meta(min_length=1, description="The panels, row by row")] = ()
    columns: Annotated[int, Meta(ge=1, description="Panels in a row")] = 2
    height: Annotated[float, Meta(gt=0, description="Height of a row [inch]")] = 2.5


def _check(stage: Stage, pipeline: Pipeline) -> None:
    options: Any = stage.options
    if not options.cells:
        raise DeclarationError("a figure of exits has [[cells]]; declare at least one")
    for number, cell in enumerate(options.cells, 1):
        if cell.of not in stage.needs:
            raise DeclarationError(f"cell {number}: {cell.of!r} is not needed: {nearest(cell.of, stage.needs)}")
        one = pipeline.stages[cell.of]
        if not called(one.kind.tables, "exit_regimes"):
            raise DeclarationError(f"cell {number}: {cell.of} is of kind {one.kind.name!r}; this draws kind exits")
        if cell.y is not None and not cell.y[0] < cell.y[1]:
            raise DeclarationError(f"cell {number}: y is {cell.y[0]:g} to {cell.y[1]:g}; give the lower end first")
        if len(one.axes) > 1 or (not one.axes and cell.show != "survival"):
            varied = ", ".join(axis.name for axis in one.axes) or "nothing"
            raise DeclarationError(f"cell {number}: {cell.of} varies {varied}; {cell.show} needs one parameter")


def _draw(inputs: Mapping[str, Input], options: ExitsOptions) -> Figure:
    from vines.figures import sheet_figure
    from vines.stages.plots._caption import listed

    panels = [_panel(cell, inputs[cell.of]) for cell in options.cells]
    return sheet_figure(
        panels,
        columns=options.columns,
        caption=options.title or listed(next(iter(inputs.values())).params),
        width=options.inches,
        height=options.height,
    )


def _panel(cell: ExitsCell, stage: Input) -> Panel:
    from vines.figures import HoldingPanel, SharesPanel

    rows = [row for row in stage.table(called(stage.tables, "exit_regimes")).to_pylist() if _wanted(cell, row)]
    if cell.show == "survival":
        return _survival(cell, stage, rows)
    axis = next(iter(stage.axes))
    if cell.show == "mean":
        told = [row for row in rows if not row.get("remark")]
        return HoldingPanel(axis, _curves(told, axis, "mean", "mean_low", "mean_high"), cell.title, cell.log, cell.y)
    plain = [row for row in rows if row["method"] == "runs"]
    keys = ("long_run", "long_run_low", "long_run_high", "basin")
    return SharesPanel(axis, _curves(plain, axis, *keys), cell.title, cell.log, cell.y)


def _wanted(cell: ExitsCell, row: Mapping[str, Any]) -> bool:
    return not cell.names or _name(row) in cell.names


def _name(row: Mapping[str, Any]) -> str:
    return row["name"] or row["regime"].replace("_", " ")


def _curves(rows: list[dict[str, Any]], axis: str, value: str, low: str, high: str, other: str = "") -> list[HeldCurve]:
    import numpy as np

    from vines.figures import HeldCurve

    def column(own: list[dict[str, Any]], name: str) -> Any:
        return np.array([np.nan if row[name] is None else row[name] for row in own])

    # Two attractors of one name at a point make one curve each.
    places: dict[tuple[Any, ...], int] = {}
    groups: dict[tuple[str, int, str], list[dict[str, Any]]] = {}
    for row in sorted(rows, key=lambda row: (row[axis], row["attractor"])):
        seen = (row["point_id"], _name(row), row["method"])
        places[seen] = places.get(seen, -1) + 1
        groups.setdefault((_name(row), places[seen], row["method"]), []).append(row)
    numbers: dict[tuple[str, int], int] = {}
    found = []
    for (name, place, method), own in groups.items():
        irregular = own[0]["regime"] in ("chaotic", "unsettled", "quasiperiodic")
        number = -1 if irregular else numbers.setdefault((name, place), len(numbers))
        label = f"{name}{f' ({place + 1})' if place else ''}{', by splitting' if method == 'splitting' else ''}"
        found.append(
            HeldCurve(
                x=column(own, axis),
                y=column(own, value),
                low=column(own, low),
                high=column(own, high),
                label=label,
                colour=number,
                other=column(own, other) if other else None,
                way="o" if method == "runs" else "D",
            )
        )
    return found


def _survival(cell: ExitsCell, stage: Input, rows: list[dict[str, Any]]) -> Panel:
    import numpy as np

    from vines.figures import SYMBOLS, HeldRuns, SurvivalPanel

    table = stage.table(called(stage.tables, "exits")).to_pylist()
    axis = next(iter(stage.axes), None)
    several = len({_name(row) for row in rows}) > 1
    found = []
    for row in rows:
        if row["method"] != "runs":
            continue
        own = [r for r in table if r["point_id"] == row["point_id"] and r["attractor"] == row["attractor"]]
        label = _name(row) if several or axis is None else ""
        if axis is not None:
            value = f"${SYMBOLS.get(axis, axis)} = {row[axis]:g}$"
            label = f"{label}, {value}" if label else value
        found.append(
            HeldRuns(
                times=np.array([np.inf if r["censored"] else r["T_exit"] for r in own]),
                watched=max(r["T_exit"] for r in own),
                wait=float(row["wait"]),
                mean=np.nan if row["mean"] is None else row["mean"],
                label=label,
            )
        )
    return SurvivalPanel(found, cell.title)


PLOT = Plot(
    summary="how long regimes hold under noise, and which hold most of the time",
    options=ExitsOptions,
    draw=_draw,
    check=_check,
    tables=("exit_regimes",),
)
