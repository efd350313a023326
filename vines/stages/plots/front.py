"""The plot ``front``: designs by two measures, of which one is to be small and the other large."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from msgspec import Meta

from vines.errors import DeclarationError, nearest
from vines.schema import table
from vines.stages.plots._checks import called
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "FrontOptions"]


class FrontOptions(PlotOptions, frozen=True, tag="front"):
    """Every point of sweeps by two measures, in the colours of a parameter, with the front that none is beyond.

    A point stands for the worst of the attractors that were found there: the largest value of `least` and the smallest
    of `most` among them. The front joins the points that no other beats in both. A panel a parameter of `colours`.
    """

    least: Annotated[str, Meta(description="A column of numbers of which less is better")] = "reduction"
    most: Annotated[str, Meta(description="A column of numbers of which more is better")] = "impact_power"
    colours: Annotated[
        tuple[str, ...], Meta(description="Varied parameters, a panel each; the varied ones if empty")
    ] = ()
    columns: Annotated[int, Meta(ge=1, description="Panels in a row")] = 3
    height: Annotated[float, Meta(gt=0, description="Height of a row [inch]")] = 2.6


def _check(stage: Stage, pipeline: Pipeline) -> None:
    options: Any = stage.options
    for one in (pipeline.stages[name] for name in stage.needs):
        points = called(one.kind.tables, "points")
        if not points or one.kind.tables[0] != points:
            raise DeclarationError(f"{one.name} is of kind {one.kind.name!r}; a front is of sweeps")
        for name in (options.least, options.most):
            forms = [table(each) for each in (points, called(one.kind.tables, "attractors")) if each]
            numbers = [column.name for column in forms[-1].columns if column.dtype == "float64"]
            if name not in numbers:
                raise DeclarationError(f"{one.name} has no column {name!r} of numbers: {nearest(name, numbers)}")
        varied = [axis.name for axis in one.axes]
        for name in options.colours:
            if name not in varied:
                raise DeclarationError(f"colours: {one.name} does not vary {name}; it varies {', '.join(varied)}")


def _draw(inputs: Mapping[str, Input], options: FrontOptions) -> Figure:
    import numpy as np

    from vines.figures import FrontPanel, sheet_figure
    from vines.stages.plots._caption import listed, shared_params

    colours = options.colours or next(iter(inputs.values())).axes
    found = [_worst(stage, options, colours) for stage in inputs.values()]
    least, most, hollow, *values = (np.concatenate(each) for each in zip(*found, strict=True))
    panels = [
        FrontPanel(
            axes=(options.least, options.most),
            x=least,
            y=most,
            parameter=name,
            values=own,
            log=bool(own.min() > 0 and own.max() > 20 * own.min()),
            hollow=hollow.astype(bool),
        )
        for name, own in zip(colours, values, strict=True)
    ]
    return sheet_figure(
        panels,
        columns=options.columns,
        caption=options.title or listed(shared_params(inputs.values())),
        width=options.inches,
        height=options.height,
    )


def _worst(stage: Input, options: FrontOptions, colours: tuple[str, ...]) -> list[Any]:
    """Return the worst measures of each point, whether its ball is never hit, and its parameters."""
    import numpy as np

    points = stage.table()
    place = {identity: k for k, identity in enumerate(points["point_id"].to_pylist())}
    rows = [points, *(stage.table(name) for name in (called(stage.tables, "attractors"),) if name)]
    least, most, hits = np.full(len(place), -np.inf), np.full(len(place), np.inf), np.zeros(len(place))
    for each in rows:
        at = np.array([place[identity] for identity in each["point_id"].to_pylist()], dtype=np.int64)
        np.maximum.at(least, at, _numbers(each, options.least))
        np.minimum.at(most, at, _numbers(each, options.most))
        np.maximum.at(hits, at, np.nan_to_num(_numbers(each, "impacts_per_period")))
    return [least, most, hits == 0, *(_numbers(points, name) for name in colours)]


def _numbers(rows: Any, name: str) -> Any:
    import numpy as np

    return rows[name].to_numpy(zero_copy_only=False).astype(np.float64)


PLOT = Plot(
    summary="designs by two measures, one to be small and the other large, and the front of the best compromises",
    options=FrontOptions,
    draw=_draw,
    check=_check,
    tables=("points",),
)
