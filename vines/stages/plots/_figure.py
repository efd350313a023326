"""Body of the kind ``figure``: tables of other stages into a picture."""

from __future__ import annotations

from vines.figures import save
from vines.pipeline import Batch, WholeJob
from vines.stages.plots._look import worn_by
from vines.stages.plots._plot import PlotOptions, plot_of

__all__ = ["compute"]


def compute(job: WholeJob[PlotOptions]) -> Batch:
    """Draw the needed stages."""
    look = job.options.worn
    with worn_by(look):
        save(plot_of(job.options).draw(job.inputs, job.options), job.folder, formats=look.formats, dpi=look.dpi)
    return Batch()
