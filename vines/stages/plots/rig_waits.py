"""The plot ``rig_waits``: times between impacts of runs and of the model."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

from vines.stages.plots._checks import needs_table
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Input

__all__ = ["PLOT", "RigWaitsOptions"]


class RigWaitsOptions(PlotOptions, frozen=True, tag="rig_waits"):
    """Stages of kind `compare`: histograms of the times between impacts, measured and of the model, a panel a run."""


def _draw(inputs: Mapping[str, Input], options: RigWaitsOptions) -> Figure:
    from vines.figures import rig_waits_figure
    from vines.stages.plots._rig import cycles_of

    return rig_waits_figure(cycles_of(inputs), caption=options.title, width=options.inches)


PLOT = Plot(
    summary="times between impacts of runs and of the model",
    options=RigWaitsOptions,
    draw=_draw,
    check=partial(needs_table, table="rig_cycles", kind="compare"),
    tables=("comparisons",),
)
