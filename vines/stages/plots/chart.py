"""The plot ``chart``: curves of bifurcations in two parameters, over the region where an orbit is stable."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from vines.errors import DeclarationError
from vines.stages.plots._checks import called, one_system
from vines.stages.plots._lines import lines
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures import Region, SpecialMark
    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "ChartOptions"]


class ChartOptions(PlotOptions, frozen=True, tag="chart"):
    """Stages of kind `curve` over the same two parameters; one of kind `reduced` shades where the orbit is stable."""


def _check(stage: Stage, pipeline: Pipeline) -> None:
    needed = [pipeline.stages[name] for name in stage.needs]
    curves = [one.name for one in needed if called(one.kind.tables, "curves")]
    wrong = [one.name for one in needed if one.name not in curves and "reduced" not in one.kind.tables]
    if wrong or not curves:
        told = f"; {', '.join(wrong)} is of another" if wrong else ""
        raise DeclarationError(f"a chart draws stages of kind 'curve', and shades one of kind 'reduced'{told}")
    one_system(needed, "a chart")
    if len({frozenset(axis.name for axis in one.axes) for one in needed}) != 1:
        raise DeclarationError("the stages of a chart have to vary the same two parameters")


def _draw(inputs: Mapping[str, Input], options: ChartOptions) -> Figure:
    from vines.figures import chart_figure
    from vines.stages.plots._caption import listed

    curves = [stage for stage in inputs.values() if called(stage.tables, "curves")]
    # Along x is A where it varies, as in the diagrams.
    first, second = sorted(curves[0].axes, key=lambda axis: axis != "A")
    shown = [line for stage in curves for line in lines(stage, first, second)]
    special = [mark for stage in curves for mark in _special(stage, first, second)]
    regions = [_stable(stage, first, second) for stage in inputs.values() if "reduced" in stage.tables]
    return chart_figure(
        (first, second),
        shown,
        special,
        regions,
        caption=options.title or listed(curves[0].params),
        width=options.inches,
    )


def _special(stage: Input, first: str, second: str) -> Iterable[SpecialMark]:
    from vines.figures import SpecialMark

    for row in stage.table().to_pylist():
        if row["special"] is not None:
            yield SpecialMark(row["special"], row[first], row[second])


def _stable(stage: Input, first: str, second: str) -> Region:
    from vines.figures import Region
    from vines.stages.plots._grid import grid_of

    grid = grid_of(stage.table(), first, second)
    holds = grid.rows["exact_stable"].eq(True) & grid.rows["exact_admissible"].eq(True)
    return Region(grid.x, grid.y, grid.of(holds, False), "1:1 symmetric is stable")


PLOT = Plot(
    summary="curves of bifurcations in two parameters",
    options=ChartOptions,
    draw=_draw,
    check=_check,
    tables=("curves",),
)
