"""The plot ``measures``: columns of points, transients or orbits over one parameter, of any systems."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Literal

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError, nearest
from vines.schema import table
from vines.stages.plots._checks import called
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    import pyarrow as pa
    from matplotlib.figure import Figure

    from vines.figures import MeasureCurve, MeasurePanel
    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "MeasureCell", "MeasuresOptions"]

_MOST = 7
"""Curves of a panel that a reader can tell apart."""


class MeasureCell(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A panel: a column of the points, transients or orbits of stages over one parameter.

    Curves are named by `labels`, and by the parameters that tell those of one stage apart. Stages with one label share
    a colour; sweeps that were carried up and down have marks that say so, and with `band` what lies between them is
    shaded. Branches are lines, dotted where orbits are unstable, and have the names of their families.
    """

    show: Annotated[str, Meta(description="A column of numbers, such as reduction")]
    of: Annotated[tuple[str, ...], Meta(min_length=1, description="The stages that it shows")]
    over: Annotated[str, Meta(description="What is along x; the carried axis or the last varied one if empty")] = ""
    where: Annotated[dict[str, float], Meta(description="Parameters that the shown points have")] = {}
    title: Annotated[str, Meta(description="Written above the panel")] = ""
    log: Annotated[Literal["", "x", "y", "xy"], Meta(description="Logarithmic axes")] = ""
    band: Annotated[bool, Meta(description="Whether what lies between curves of one label is shaded")] = False
    marks: Annotated[tuple[float, ...], Meta(description="Places along x that are marked")] = ()
    window: Annotated[tuple[float, float] | None, Meta(description="The part of the horizontal axis shown")] = None
    y: Annotated[tuple[float, float] | None, Meta(description="The part of the vertical axis shown")] = None


class MeasuresOptions(PlotOptions, frozen=True, tag="measures"):
    """Columns of points, transients or orbits over one parameter: a panel a column, a curve a stage, of any systems.

    With sweeps and branches in one panel it shows a measure over a parameter as simulated and as continued.
    """

    cells: Annotated[tuple[MeasureCell, ...], Meta(description="The panels, row by row")] = ()
    labels: Annotated[dict[str, str], Meta(description="What stages are called; their names if left out")] = (
        msgspec.field(default_factory=dict)
    )
    columns: Annotated[int, Meta(ge=1, description="Panels in a row")] = 2
    height: Annotated[float, Meta(gt=0, description="Height of a row [inch]")] = 2.3


def _check(stage: Stage, pipeline: Pipeline) -> None:
    options: Any = stage.options
    for name in options.labels:
        if name not in stage.needs:
            raise DeclarationError(f"labels: {name!r} is not needed: {nearest(name, stage.needs)}")
    if not options.cells:
        raise DeclarationError("measures has [[cells]]; declare at least one")
    for number, cell in enumerate(options.cells, 1):
        where = f"cell {number} ({cell.show})"
        for name in cell.of:
            if name not in stage.needs:
                raise DeclarationError(f"{where}: {name!r} is not needed: {nearest(name, stage.needs)}")
        for pair in (cell.window, cell.y):
            if pair is not None and not pair[0] < pair[1]:
                raise DeclarationError(f"{where}: {pair[0]:g} to {pair[1]:g}; give the lower end first")
        _check_cell(where, cell, [pipeline.stages[name] for name in cell.of])


def _check_cell(where: str, cell: MeasureCell, shown: Sequence[Stage]) -> None:
    """Refuse columns that are not there, stages without a common axis, values off the grid and too many curves."""
    counts: dict[str, int] = {}
    along = set[str]()
    for one in shown:
        name = _rows_of(one.kind.tables)
        if not name:
            raise DeclarationError(
                f"{where}: {one.name} is of kind {one.kind.name!r}; it shows sweeps, transients and branches"
            )
        form = table(name)
        numbers = [column.name for column in form.columns if column.dtype in ("float64", "int64")]
        if cell.show not in numbers:
            known = nearest(cell.show, numbers)
            raise DeclarationError(f"{where}: {one.name} has no column {cell.show!r} of numbers: {known}")
        if form.like == "orbits":
            along |= {axis.name for axis in one.axes}
            continue
        values = {axis.name: axis.values() for axis in one.axes}
        axis = cell.over or (one.carry.axis if one.carry is not None else next(reversed(values), ""))
        if axis not in values:
            varied = ", ".join(values) or "nothing"
            raise DeclarationError(f"{where}: {one.name} does not vary {axis or 'anything'}; it varies {varied}")
        along.add(axis)
        for name, value in cell.where.items():
            there = values.get(name) or ((one.params[name],) if name in one.params else ())
            if value not in there:
                known = f"the nearest is {min(there, key=lambda each: abs(each - value)):.10g}" if there else "none is"
                raise DeclarationError(f"{where}: {one.name} has no {name} = {value:g}; {known}")
        kept = [len(known) for name, known in values.items() if name != axis and name not in cell.where]
        counts[one.name] = math.prod(kept)
    if len(along) != 1:
        raise DeclarationError(f"{where} shows stages along {', '.join(sorted(along))}; name one of them, over = ...")
    if max(counts.values(), default=0) > _MOST:
        many = max(counts, key=lambda name: counts[name])
        told = f"{many} gives {counts[many]} curves, allowed are {_MOST}"
        raise DeclarationError(f"{where}: {told}; choose some, where = ...")


def _rows_of(names: Sequence[str]) -> str:
    """Return which table of a stage has its measures: points, transients, or the orbits of branches; empty if none."""
    first = names[:1]
    if any(table(name).like in ("points", "transients") for name in first):
        return first[0]
    return called(names, "orbits") if called(names, "branches") else ""


def _draw(inputs: Mapping[str, Input], options: MeasuresOptions) -> Figure:
    from vines.figures import sheet_figure
    from vines.stages.plots._caption import listed, shared_params

    return sheet_figure(
        _told_once([_panel(cell, inputs, options.labels) for cell in options.cells]),
        columns=options.columns,
        caption=options.title or listed(shared_params(inputs.values())),
        width=options.inches,
        height=options.height,
    )


def _told_once(panels: list[MeasurePanel]) -> list[MeasurePanel]:
    """Let the first panel of those with the same labels tell them, where not all panels have the same."""
    told = [tuple(dict.fromkeys(curve.label for curve in panel.curves)) for panel in panels]
    if len(set(told)) == 1:
        return panels
    return [replace(panel, legend=told.index(told[k]) == k) for k, panel in enumerate(panels)]


def _panel(cell: MeasureCell, inputs: Mapping[str, Input], labels: Mapping[str, str]) -> MeasurePanel:
    import numpy as np

    from vines.figures import MeasureCurve, MeasurePanel
    from vines.stages.plots._caption import listed

    stages = [inputs[name] for name in cell.of]
    axes = [cell.over or stage.carried or stage.axes[-1] for stage in stages]
    branches = [stage for stage in stages if called(stage.tables, "branches")]
    alone = len({labels.get(stage.name, stage.name) for stage in stages if stage not in branches}) == 1
    curves: list[MeasureCurve] = []
    numbers: dict[str, int] = {}
    for stage, axis in zip(stages, axes, strict=True):
        if stage in branches:
            curves += _branches(stage, axis, cell.show, labels.get(stage.name, ""), numbers)
            continue
        named = labels.get(stage.name, "simulation" if alone and branches else "" if alone else stage.name)
        for group, rows in _groups(stage.table(), cell.where, [name for name in stage.axes if name != axis]):
            label = ",  ".join(filter(None, (named, listed(group, ", "))))
            curves.append(
                MeasureCurve(
                    x=rows[axis].to_numpy(),
                    y=np.array(rows[cell.show].to_pylist(), dtype=np.float64),
                    label=label,
                    colour=numbers.setdefault(label, len(numbers)),
                    way=_WAYS.get(stage.direction, "") if stage.carried == axis else "",
                )
            )
    return MeasurePanel(
        axis=axes[0],
        quantity=cell.show,
        curves=curves,
        title=cell.title,
        window=cell.window,
        y=cell.y,
        log=("x" in cell.log, "y" in cell.log),
        band=cell.band,
        marks=cell.marks,
    )


def _branches(stage: Input, axis: str, column: str, named: str, numbers: dict[str, int]) -> Iterator[MeasureCurve]:
    """Yield a measure along each branch of a stage."""
    import numpy as np
    import pyarrow.compute as pc

    from vines.figures import MeasureCurve
    from vines.stages.plots._diagram import family_label

    orbits = stage.table(called(stage.tables, "orbits"))
    for branch in stage.table(called(stage.tables, "branches")).to_pylist():
        mine = orbits.filter(pc.field("branch_id") == branch["branch_id"])
        label = ",  ".join(filter(None, (named, family_label(branch))))
        yield MeasureCurve(
            x=mine[axis].to_numpy(),
            y=np.array(mine[column].to_pylist(), dtype=np.float64),
            label=label,
            colour=numbers.setdefault(label, len(numbers)),
            stable=mine["stable"].to_numpy(zero_copy_only=False).astype(bool),
        )


_WAYS: dict[str, Literal["up", "down"]] = {"up": "up", "down": "down"}


def _groups(
    rows: pa.Table, where: Mapping[str, float], others: Sequence[str]
) -> Iterator[tuple[dict[str, float], pa.Table]]:
    """Yield the points of each curve, and what tells it from the others, ascending."""
    import pyarrow.compute as pc

    for name, value in where.items():
        rows = rows.filter(pc.field(name) == value)
    names = [name for name in others if name not in where]
    if not names:
        yield {}, rows
        return
    found = rows.group_by(names).aggregate([]).to_pylist()
    for group in sorted(found, key=lambda row: tuple(row[name] for name in names)):
        mine = rows
        for name in names:
            mine = mine.filter(pc.field(name) == group[name])
        yield {name: group[name] for name in names}, mine


PLOT = Plot(
    summary="columns of points, transients or orbits over one parameter, of any systems",
    options=MeasuresOptions,
    draw=_draw,
    check=_check,
    tables=("points",),
)
