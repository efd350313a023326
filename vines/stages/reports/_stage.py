"""Body of the kind ``report``: the page about the needed stages, as a result."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vines.pipeline import Batch, WholeJob
from vines.stages.reports._page import page
from vines.stages.reports._section import section_of
from vines.store import read_result, write_text

if TYPE_CHECKING:
    from vines.stages.kinds.report import ReportOptions

__all__ = ["compute"]


def compute(job: WholeJob[ReportOptions]) -> Batch:
    """Write ``report.html``; it tells nothing that a clock says, so that it has the same bytes again."""
    options = job.options
    results = {name: read_result(stage.folder) for name, stage in job.inputs.items()}
    # results lie beside each other, and so will this one
    folder = next(iter(job.inputs.values())).folder.parent / "report"
    section = section_of(options.pipeline, options.title, options.source, results, folder)
    write_text(job.folder / "report.html", page(options.pipeline, options.title, options.source, [section]))
    return Batch()
