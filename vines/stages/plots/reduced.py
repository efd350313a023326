"""The plot ``reduced``: where the multiple-scales reduction may be trusted, maps of its errors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated

from msgspec import Meta

from vines.errors import DeclarationError
from vines.figures import ERRORS
from vines.stages.plots._checks import check_panels
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures import ErrorMap
    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "ReducedPlotOptions"]


class ReducedPlotOptions(PlotOptions, frozen=True, tag="reduced"):
    """Stages of kind `reduced` over two parameters each: a map of an error for each stage, a row a quantity."""

    panels: Annotated[tuple[str, ...], Meta(min_length=1, description=f"Errors shown: {', '.join(ERRORS)}")] = (
        "max_abs_x1",
    )


def _check(stage: Stage, pipeline: Pipeline) -> None:
    check_panels(stage.options, ERRORS)
    for one in (pipeline.stages[name] for name in stage.needs):
        if "reduced" not in one.kind.tables or len(one.axes) != 2:
            raise DeclarationError(
                f"stage {one.name!r} is of kind {one.kind.name!r} and varies {len(one.axes)} parameters; "
                "an error map needs stages of kind 'reduced' that vary two"
            )


def _draw(inputs: Mapping[str, Input], options: ReducedPlotOptions) -> Figure:
    from vines.figures import reduced_figure

    maps = [_map(stage) for stage in inputs.values()]
    return reduced_figure(maps, panels=options.panels, title=options.title, width=options.inches)


def _map(stage: Input) -> ErrorMap:
    """Return the errors of a stage on its grid."""
    import numpy as np

    from vines.figures import ErrorMap
    from vines.stages.plots._caption import fixed
    from vines.stages.plots._grid import grid_of

    # Along y is A where it varies: the range of the forcing is what one reads off.
    first, second = sorted(stage.axes, key=lambda axis: axis == "A")
    grid = grid_of(stage.table(), first, second)
    rows, A = grid.rows, grid.rows["A"]
    return ErrorMap(
        axes=(first, second),
        x=grid.x,
        y=grid.y,
        errors={name: grid.of(rows[f"error_{name}"], math.nan) for name in ERRORS},
        valid=grid.of(rows["exact_stable"].eq(True) & rows["exact_admissible"].eq(True), False),
        inside=grid.of(np.minimum(A - rows["stable_from"], rows["stable_to"] - A), math.nan),
        caption=fixed(stage, stage.axes),
    )


PLOT = Plot(
    summary="errors of the multiple-scales reduction over two parameters",
    options=ReducedPlotOptions,
    draw=_draw,
    check=_check,
    tables=("reduced",),
)
