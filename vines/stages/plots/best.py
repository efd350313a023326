"""The plot ``best``: which of several sets of sweeps is best at each point of a grid, all their attractors counted."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError, nearest
from vines.schema import table
from vines.stages.plots._checks import called
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures import Panel, SetPanel
    from vines.pipeline import Input, Pipeline, Stage
    from vines.stages.plots._best import Worth

__all__ = ["PLOT", "BestCell", "BestOptions"]

_MOST = 8
"""Sets that colours can tell apart."""
_POWERS = {
    **dict.fromkeys(("reduction", "kinetic_ratio", "impacts_per_period"), 0),
    **dict.fromkeys(("max_abs_x1", "rms_x1"), 1),
    **dict.fromkeys(("impact_power", "viscous_power", "electric_power", "friction_power"), 2),
}
"""With which power of the size of everything a measure grows."""
_SAME = 1e-9
"""Relative distance within which two values of a grid are one."""


class BestCell(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A panel about some of the sets.

    `map` shows which set is best at each point, paler where another is nearly as good; `lead` by which ratio it is
    better than the second; `over` the measure of each set along one parameter, a line at the worst attractor and a
    band to the best.
    """

    show: Annotated[Literal["map", "lead", "over"], Meta(description="What is shown")]
    of: Annotated[tuple[str, ...], Meta(description="The sets that it is about; all if empty")] = ()
    count: Annotated[Literal["worst", "best"], Meta(description="Which of the attractors of a set counts, in maps")] = (
        "worst"
    )
    at: Annotated[dict[str, float], Meta(description="The value of the other parameter, for `over`")] = {}
    measure: Annotated[str, Meta(description="Another measure for this panel")] = ""
    title: Annotated[str, Meta(description="Written above the panel")] = ""
    log: Annotated[bool, Meta(description="Whether the measure is on a logarithmic axis")] = False
    y: Annotated[tuple[float, float] | None, Meta(description="The part of the measure shown, also of colours")] = None


class BestOptions(PlotOptions, frozen=True, tag="best"):
    """Sets of sweeps, of any systems, over one grid of two parameters, the first along x: which set is best where.

    The sweeps of a set differ in their starts; the measure of the set at a point is that of the worst attractor that
    any of them found, random starts included. `sizes` are factors on all lengths of a set, where its sweeps are in
    units of its own: its values of A are those of the sweeps times the factor, and so are displacements.
    """

    sets: Annotated[dict[str, tuple[str, ...]], Meta(description="Names of the sets, and the sweeps of each")] = (
        msgspec.field(default_factory=dict)
    )
    sizes: Annotated[
        dict[str, Annotated[float, Meta(gt=0)]], Meta(description="Factors on the lengths of sets; 1 if left out")
    ] = msgspec.field(default_factory=dict)
    measure: Annotated[str, Meta(description="A column of numbers that the points of all sets have")] = "reduction"
    better: Annotated[Literal["less", "more"], Meta(description="Which values of it are better")] = "less"
    close: Annotated[float, Meta(ge=0, description="A lead below this share is pale in maps")] = 0.05
    cells: Annotated[tuple[BestCell, ...], Meta(description="The panels, row by row")] = ()
    columns: Annotated[int, Meta(ge=1, description="Panels in a row")] = 2
    height: Annotated[float, Meta(gt=0, description="Height of a row [inch]")] = 2.6


def _check(stage: Stage, pipeline: Pipeline) -> None:
    options: Any = stage.options
    if len(options.sets) < 2 or not options.cells:
        raise DeclarationError("best compares sets of sweeps in [[cells]]; declare at least two sets and one cell")
    if len(options.sets) > _MOST:
        raise DeclarationError(f"{len(options.sets)} sets, allowed are {_MOST}: more colours nobody tells apart")
    for name in options.sizes:
        if name not in options.sets:
            raise DeclarationError(f"sizes: no set {name!r}: {nearest(name, options.sets)}")
    grid: dict[str, tuple[float, ...]] = {}
    for name, members in options.sets.items():
        if not members:
            raise DeclarationError(f"set {name!r} is empty; name sweeps")
        for each in members:
            if each not in stage.needs:
                raise DeclarationError(f"sets: {each!r} is not needed: {nearest(each, stage.needs)}")
            one = pipeline.stages[each]
            _check_sweep(name, one, options)
            found = _grid(one, options.sizes.get(name, 1.0))
            grid = grid or found
            _check_grid(f"set {name!r}: {each}", found, grid)
    for number, cell in enumerate(options.cells, 1):
        _check_cell(f"cell {number} ({cell.show})", cell, options, grid)


def _check_sweep(name: str, one: Stage, options: Any) -> None:
    """Refuse what is no sweep over two parameters or has not the measures, and sizes of what a size would change."""
    points = called(one.kind.tables[:1], "points")
    if not points:
        raise DeclarationError(f"set {name!r}: {one.name} is of kind {one.kind.name!r}; sets are of sweeps")
    if len(one.axes) != 2:
        varied = ", ".join(axis.name for axis in one.axes) or "nothing"
        raise DeclarationError(f"set {name!r}: {one.name} varies {varied}; best is over two parameters")
    forms = [table(each) for each in (points, called(one.kind.tables, "attractors")) if each]
    numbers = [column.name for column in forms[-1].columns if column.dtype == "float64"]
    for measure in {options.measure, *(cell.measure for cell in options.cells if cell.measure)}:
        if measure not in numbers:
            known = nearest(measure, numbers)
            raise DeclarationError(f"set {name!r}: {one.name} has no column {measure!r} of numbers: {known}")
        if options.sizes.get(name, 1.0) != 1.0 and measure not in _POWERS:
            raise DeclarationError(
                f"sizes: how {measure} grows with a size is not known; known are {', '.join(_POWERS)}"
            )
    tilted = one.params.get("G", 0.0) != 0 or "G" in {axis.name for axis in one.axes}
    if options.sizes.get(name, 1.0) != 1.0 and tilted:
        raise DeclarationError(f"sizes: {one.name} is tilted, so that its lengths have no free size; give it none")


def _grid(one: Stage, size: float) -> dict[str, tuple[float, ...]]:
    """Return the values of both parameters, the forcing times the size."""
    return {
        axis.name: tuple(sorted(value * (size if axis.name == "A" else 1.0) for value in axis.values()))
        for axis in one.axes
    }


def _check_grid(where: str, found: dict[str, tuple[float, ...]], grid: dict[str, tuple[float, ...]]) -> None:
    if list(found) != list(grid):
        raise DeclarationError(f"{where} varies {', '.join(found)}, others vary {', '.join(grid)}; give them one grid")
    for name, values in found.items():
        known = grid[name]
        if len(values) != len(known) or not all(map(_same, values, known)):
            told, others = (f"{len(each)} values from {each[0]:g} to {each[-1]:g}" for each in (values, known))
            raise DeclarationError(f"{where} has {told} of {name}, others {others}; give all sets one grid")


def _same(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=_SAME, abs_tol=1e-300)


def _check_cell(where: str, cell: BestCell, options: Any, grid: Mapping[str, tuple[float, ...]]) -> None:
    for name in cell.of:
        if name not in options.sets:
            raise DeclarationError(f"{where}: no set {name!r}: {nearest(name, options.sets)}")
    if cell.show != "over" and len(cell.of) == 1:
        raise DeclarationError(f"{where} compares sets, and is about {cell.of[0]!r} alone; name two or more")
    if cell.y is not None and not cell.y[0] < cell.y[1]:
        raise DeclarationError(f"{where}: y is {cell.y[0]:g} to {cell.y[1]:g}; give the lower end first")
    if cell.show != "over":
        if cell.at:
            raise DeclarationError(f"{where} is over both parameters; at = ... is for over")
        return
    if len(cell.at) != 1 or next(iter(cell.at)) not in grid:
        raise DeclarationError(f"{where} is along one parameter; give one value of the other, of {' or '.join(grid)}")
    [(name, value)] = cell.at.items()
    if not any(_same(value, each) for each in grid[name]):
        known = min(grid[name], key=lambda each: abs(each - value))
        raise DeclarationError(f"{where}: no {name} = {value:g} on the grid; the nearest is {known:.10g}")


def _draw(inputs: Mapping[str, Input], options: BestOptions) -> Figure:
    from vines.figures import sheet_figure
    from vines.stages.plots._best import worth_of
    from vines.stages.plots._caption import listed, shared_params

    measures = {options.measure, *(cell.measure for cell in options.cells if cell.measure)}
    found = {
        measure: {
            name: worth_of(
                [inputs[each] for each in members],
                measure,
                options.better,
                options.sizes.get(name, 1.0),
                _POWERS.get(measure, 0),
            )
            for name, members in options.sets.items()
        }
        for measure in sorted(measures)
    }
    axes = next(iter(inputs.values())).axes
    return sheet_figure(
        [_panel(cell, found[cell.measure or options.measure], axes, options) for cell in options.cells],
        columns=options.columns,
        caption=options.title or listed(shared_params(inputs.values())),
        width=options.inches,
        height=options.height,
    )


def _panel(cell: BestCell, found: Mapping[str, Worth], axes: tuple[str, ...], options: BestOptions) -> Panel:
    import numpy as np

    from vines.figures import BestMap, LeadMap
    from vines.stages.plots._best import rank

    names = tuple(options.sets)
    chosen = cell.of or names
    any_of = found[chosen[0]]
    log = (_logarithmic(any_of.x), _logarithmic(any_of.y))
    if cell.show == "over":
        return _along(cell, cell.measure or options.measure, {name: found[name] for name in chosen}, axes, names, log)
    values = [found[name].worst if cell.count == "worst" else found[name].best for name in chosen]
    place, lead = rank(values, options.better)
    shared: dict[str, Any] = {"axes": axes, "x": any_of.x, "y": any_of.y, "lead": lead, "log": log}
    if cell.show == "lead":
        return LeadMap(**shared, title=cell.title, limits=cell.y)
    numbers = np.array([*(names.index(name) for name in chosen), -1])
    return BestMap(**shared, best=numbers[place], names=names, close=options.close, title=cell.title)


def _along(
    cell: BestCell,
    measure: str,
    found: Mapping[str, Worth],
    axes: tuple[str, ...],
    names: tuple[str, ...],
    log: tuple[bool, bool],
) -> SetPanel:
    import numpy as np

    from vines.figures import SetCurve, SetPanel
    from vines.stages.plots._caption import listed

    [(fixed, value)] = cell.at.items()
    fixed_x = fixed == axes[0]
    any_of = next(iter(found.values()))
    at = int(np.argmin(np.abs((any_of.x if fixed_x else any_of.y) - value)))
    part: Any = (slice(None), at) if fixed_x else at
    curves = [
        SetCurve(each.y if fixed_x else each.x, each.best[part], each.worst[part], names.index(name))
        for name, each in found.items()
    ]
    along = any_of.y if fixed_x else any_of.x
    return SetPanel(
        axis=axes[1] if fixed_x else axes[0],
        quantity=measure,
        curves=curves,
        names=names,
        without=(along, any_of.without[part]) if measure == "max_abs_x1" else None,
        log=(log[1] if fixed_x else log[0], cell.log),
        title=cell.title or listed(cell.at),
        y=cell.y,
    )


def _logarithmic(values: Any) -> bool:
    """Say whether values are evenly spaced on a logarithmic scale, and not on a plain one."""
    import numpy as np

    if len(values) < 3 or values[0] <= 0:
        return False
    return bool(np.ptp(np.diff(np.log(values))) < 1e-6 * np.log(values[-1] / values[0]))


PLOT = Plot(
    summary="which of several sets of sweeps is best over two parameters, the worst attractor counted",
    options=BestOptions,
    draw=_draw,
    check=_check,
    tables=("points",),
)
