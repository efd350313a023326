"""The plot ``rig_cycles``: w' over w of runs and of the model."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

from vines.stages.plots._checks import needs_table
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Input

__all__ = ["PLOT", "RigCyclesOptions"]


class RigCyclesOptions(PlotOptions, frozen=True, tag="rig_cycles"):
    """Stages of kind `compare`: w' over w of each run and of the nearest branch, a panel a run."""


def _draw(inputs: Mapping[str, Input], options: RigCyclesOptions) -> Figure:
    from vines.figures import rig_cycles_figure
    from vines.stages.plots._rig import cycles_of

    return rig_cycles_figure(cycles_of(inputs), caption=options.title, width=options.inches)


PLOT = Plot(
    summary="w' over w of runs and of the model",
    options=RigCyclesOptions,
    draw=_draw,
    check=partial(needs_table, table="rig_cycles", kind="compare"),
    tables=("comparisons",),
)
