"""The plot ``rig_residual``: what fits of runs leave, over the temperature."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

from vines.stages.plots._checks import needs_table
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Input

__all__ = ["PLOT", "RigResidualOptions"]


class RigResidualOptions(PlotOptions, frozen=True, tag="rig_residual"):
    """Stages of kind `reconstruct`: the residual of each run and the noise of its channel over its temperature."""


def _draw(inputs: Mapping[str, Input], options: RigResidualOptions) -> Figure:
    import numpy as np

    from vines.figures import rig_residual_figure
    from vines.stages.plots._rig import column, reconstructed

    runs = reconstructed(inputs)
    return rig_residual_figure(
        column(runs, "temperature"),
        column(runs, "residual"),
        column(runs, "noise"),
        [row["protocol"] for row in runs],
        np.array([row["accepted"] for row in runs], dtype=bool),
        caption=options.title,
        width=options.inches,
    )


PLOT = Plot(
    summary="what fits of runs leave over the temperature",
    options=RigResidualOptions,
    draw=_draw,
    check=partial(needs_table, table="reconstructions", kind="reconstruct"),
    tables=("reconstructions",),
)
