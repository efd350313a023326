"""Body of the kind ``figure``: tables of other stages into a picture."""

from __future__ import annotations

from typing import Any

from vines.figures import basins_figure, reduced_figure, regimes_figure, save
from vines.pipeline import Batch, WholeJob
from vines.stages.plots._basin_map import basin_map
from vines.stages.plots._chart import chart
from vines.stages.plots._diagram import bifurcation_diagram
from vines.stages.plots._error_map import error_map
from vines.stages.plots._multipliers import multipliers
from vines.stages.plots._regime_map import regime_map
from vines.stages.plots._response import response
from vines.stages.plots._rig_figures import PLOTS as RIG_PLOTS
from vines.stages.plots._sheet import sheet

__all__ = ["compute"]


def compute(job: WholeJob) -> Batch:
    """Draw the needed stages."""
    options: Any = job.options
    if options.plot == "basins":
        (stage,) = job.inputs.values()
        figure = basins_figure(basin_map(stage), title=options.title, width=options.width)
    elif options.plot == "reduced":
        maps = [error_map(stage) for stage in job.inputs.values()]
        figure = reduced_figure(maps, panels=options.panels, title=options.title, width=options.width)
    elif options.plot == "regimes":
        (stage,) = job.inputs.values()
        figure = regimes_figure(regime_map(stage), title=options.title, width=options.width)
    elif options.plot == "multipliers":
        figure = multipliers(job.inputs, options)
    elif options.plot == "chart":
        figure = chart(job.inputs, options)
    elif options.plot in RIG_PLOTS:
        figure = RIG_PLOTS[options.plot](job.inputs, options)
    elif options.plot == "sheet":
        figure = sheet(job.inputs, options)
    elif options.plot == "response":
        figure = response(job.inputs, options)
    else:
        figure = bifurcation_diagram(job.inputs, options)
    save(figure, job.folder)
    return Batch()
