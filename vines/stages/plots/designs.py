"""The plot ``designs``: what absorbers are worth over a range of forcing, with all attractors that were found."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError, nearest
from vines.schema import table
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures import Panel
    from vines.pipeline import Input, Pipeline, Stage
    from vines.stages.plots._designs import Designs

__all__ = ["PLOT", "DesignsCell", "DesignsOptions"]

_PAIR = "give the lower end first, both above 0"


class DesignsCell(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A panel about some of the sets.

    `over` shows the measure of the best design of each set over the forcing, as a band between the best and the worst
    attractor; `factor` the least worst measure against the width of the range; `map` that of one set over the two
    parameters of its designs.
    """

    show: Annotated[Literal["over", "factor", "map"], Meta(description="What is shown")]
    of: Annotated[tuple[str, ...], Meta(min_length=1, description="The sets that it shows")]
    title: Annotated[str, Meta(description="Written above the panel")] = ""
    y: Annotated[tuple[float, float] | None, Meta(description="The part of the measure shown, also of colours")] = None


class DesignsOptions(PlotOptions, frozen=True, tag="designs"):
    """Sets of sweeps over one grid of designs that differ in their starts, each design at the size that suits it best.

    The measure of a design at a value of the forcing is that of the worst attractor found; over a range, that at the
    worst value. All lengths times a size is the same motion at the forcing over the size, so that one sweep tells of
    all sizes.
    """

    sets: Annotated[dict[str, tuple[str, ...]], Meta(description="Names of the sets, and the sweeps of each")] = (
        msgspec.field(default_factory=dict)
    )
    over: Annotated[str, Meta(description="The parameter of the forcing, a length")] = "A"
    span: Annotated[tuple[float, float], Meta(description="The range of the forcing that a design is for")] = (0.0, 0.0)
    measure: Annotated[str, Meta(description="A column of the points; less is better")] = "reduction"
    cells: Annotated[tuple[DesignsCell, ...], Meta(description="The panels, row by row")] = ()
    columns: Annotated[int, Meta(ge=1, description="Panels in a row")] = 2
    height: Annotated[float, Meta(gt=0, description="Height of a row [inch]")] = 2.6


def _check(stage: Stage, pipeline: Pipeline) -> None:
    options: Any = stage.options
    low, high = options.span
    if not 0 < low < high:
        raise DeclarationError(f"span is {low:g} to {high:g}; {_PAIR}")
    if not options.sets or not options.cells:
        raise DeclarationError("designs have sets of sweeps and [[cells]]; declare at least one of each")
    for name, members in options.sets.items():
        _check_set(name, [_member(stage, pipeline, each) for each in members], options)
    for number, cell in enumerate(options.cells, 1):
        for name in cell.of:
            if name not in options.sets:
                raise DeclarationError(f"cell {number} ({cell.show}): no set {name!r}: {nearest(name, options.sets)}")
        designs = [axis.name for axis in pipeline.stages[options.sets[cell.of[0]][0]].axes if axis.name != options.over]
        if cell.show == "map" and (len(cell.of) != 1 or len(designs) != 2):
            varied = f"{', '.join(cell.of)} over {' and '.join(designs) or 'nothing'}"
            raise DeclarationError(f"cell {number} (map) shows one set of designs with two parameters, not {varied}")
        if cell.y is not None and not cell.y[0] < cell.y[1]:
            raise DeclarationError(f"cell {number}: y is {cell.y[0]:g} to {cell.y[1]:g}; give the lower end first")


def _member(stage: Stage, pipeline: Pipeline, name: str) -> Stage:
    if name not in stage.needs:
        raise DeclarationError(f"sets: {name!r} is not needed: {nearest(name, stage.needs)}")
    return pipeline.stages[name]


def _check_set(name: str, members: list[Stage], options: Any) -> None:
    """Refuse sweeps that are not over one grid with the forcing on it, or that a size would change."""
    low, high = options.span
    if not members:
        raise DeclarationError(f"set {name!r} is empty; name sweeps")
    for one in members:
        form = table(one.kind.tables[0]) if one.kind.tables else None
        if form is None or form.like != "points":
            raise DeclarationError(f"set {name!r}: {one.name} is of kind {one.kind.name!r}; sets are of sweeps")
        numbers = [column.name for column in form.columns if column.dtype == "float64"]
        if options.measure not in numbers:
            known = nearest(options.measure, numbers)
            raise DeclarationError(f"set {name!r}: unknown measure {options.measure!r}: {known}")
        grid = {axis.name: axis.values() for axis in one.axes}
        if grid != {axis.name: axis.values() for axis in members[0].axes}:
            both = f"{members[0].name} and {one.name}"
            raise DeclarationError(f"set {name!r}: {both} do not vary the same values; give them one grid")
        if options.over not in grid:
            varied = ", ".join(grid) or "nothing"
            raise DeclarationError(f"set {name!r}: {one.name} does not vary {options.over}; it varies {varied}")
        values = grid[options.over]
        width = max(values) / min(values) if min(values) > 0 else 0.0
        if width < high / low * (1 - 1e-9):
            raise DeclarationError(
                f"set {name!r}: {one.name} varies {options.over} by a factor of {width:.4g}, "
                f"the span is one of {high / low:.4g}"
            )
        if width > high / low * (1 + 1e-9) and ("G" in grid or one.params.get("G", 0.0) != 0):
            raise DeclarationError(
                f"set {name!r}: {one.name} is tilted, so that lengths have no free size; "
                f"let it vary {options.over} over the span alone"
            )


def _draw(inputs: Mapping[str, Input], options: DesignsOptions) -> Figure:
    from vines.figures import sheet_figure
    from vines.stages.plots._designs import designs_of

    found = {}
    for name, members in options.sets.items():
        stages = [inputs[each] for each in members]
        axes = tuple(axis for axis in stages[0].axes if axis != options.over)
        found[name] = designs_of([stage.table() for stage in stages], axes, options.over, options.measure)
    return sheet_figure(
        [_panel(cell, found, options) for cell in options.cells],
        columns=options.columns,
        caption=options.title,
        width=options.width,
        height=options.height,
    )


def _panel(cell: DesignsCell, found: Mapping[str, Designs], options: DesignsOptions) -> Panel:
    import numpy as np

    from vines.figures import BandCurve, BandPanel, DesignMap, FactorPanel

    low, high = options.span
    colours = {name: place for place, name in enumerate(cell.of)}
    if cell.show == "factor":
        widths = {name: _widths(found[name], high / low) for name in cell.of}
        curves = [
            (name, x, np.array([found[name].windows(each).min(initial=np.inf) for each in x]), colours[name])
            for name, x in widths.items()
        ]
        return FactorPanel(options.over, options.measure, curves, high / low, title=cell.title, y=cell.y)
    if cell.show == "map":
        (name,) = cell.of
        designs = found[name]
        best = designs.best(low, high)
        at = tuple(float(values[k]) for values, k in zip(designs.values, best.place, strict=True)) if best else None
        worst = designs.windows(high / low).min(axis=-1)
        return DesignMap(
            axes=designs.axes,
            x=designs.values[0],
            y=designs.values[1],
            worst=worst.T,
            best=at,
            quantity=options.measure,
            title=cell.title,
            limits=cell.y,
        )
    bands = []
    for name in cell.of:
        designs, best = found[name], found[name].best(low, high)
        if best is None:
            continue
        bands.append(
            BandCurve(
                x=designs.over * best.size,
                least=designs.least[best.place],
                worst=designs.worst[best.place],
                label=f"{name}: worst {best.worst:.3f}",
                colour=colours[name],
            )
        )
    return BandPanel(options.over, options.measure, bands, (low, high), title=cell.title, y=cell.y)


def _widths(designs: Designs, most: float) -> Any:
    """Return the widths of ranges that are shown: those of the grid, to twice the one asked for."""
    found = designs.over / designs.over[0]
    return found[(found > 1) & (found <= 2 * most * (1 + 1e-9))]


PLOT = Plot(
    summary="what absorbers are worth over a range of forcing, the worst attractor counted",
    options=DesignsOptions,
    draw=_draw,
    check=_check,
    tables=("points",),
)
