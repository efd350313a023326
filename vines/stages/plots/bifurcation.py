"""The plot ``bifurcation``: simulated impacts as dots and orbits as lines over one parameter, a panel a quantity."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated

from msgspec import Meta

from vines.figures import PANELS
from vines.model import with_one_ball
from vines.stages.plots._checks import check_panels, check_window, one_axis, one_system
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "BifurcationOptions"]


class BifurcationOptions(PlotOptions, frozen=True, tag="bifurcation"):
    """Stages that vary one parameter: those with impacts as dots, those with orbits as lines, a panel a quantity.

    Parameters that all stages share stand in the caption; those that differ in the labels.
    """

    panels: Annotated[tuple[str, ...], Meta(min_length=1, description=f"Quantities shown: {', '.join(PANELS)}")] = (
        "w_dot",
        "dt",
    )
    window: Annotated[tuple[float, float] | None, Meta(description="The part of the parameter that is shown")] = None
    mirror: Annotated[bool, Meta(description="Whether mirror images of asymmetric orbits are drawn too")] = False


def _check(stage: Stage, pipeline: Pipeline) -> None:
    check_window(stage.options)
    one_axis(stage, pipeline)
    system = one_system((pipeline.stages[name] for name in stage.needs), "a bifurcation diagram")
    without = with_one_ball(system).without
    check_panels(stage.options, [panel for panel in PANELS if panel not in without])


def _draw(inputs: Mapping[str, Input], options: BifurcationOptions) -> Figure:
    from vines.figures import bifurcation_figure
    from vines.stages.plots._caption import listed, shared_params
    from vines.stages.plots._diagram import diagram_parts

    stages = list(inputs.values())
    return bifurcation_figure(
        stages[0].axes[0],
        *diagram_parts(stages, mirror=options.mirror),
        panels=options.panels,
        caption=options.title or listed(shared_params(stages)),
        width=options.inches,
        window=options.window,
    )


PLOT = Plot(
    summary="impacts and orbits over one parameter, a panel a quantity",
    options=BifurcationOptions,
    draw=_draw,
    check=_check,
    tables=("impacts", "orbits"),
)
