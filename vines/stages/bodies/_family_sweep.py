"""Body of the kind ``sweep`` for systems beside the VI-NES: the settled attractor of each point, one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vines.attractors import settle_from
from vines.pipeline import Batch, Job
from vines.schema import system_table
from vines.stages.bodies._family_rows import family_impacts, family_point, parameters_of, start_of
from vines.stages.bodies._sweep import representative

if TYPE_CHECKING:
    from vines.stages.kinds._family import FamilySweepOptions

__all__ = ["compute"]


def compute(job: Job[FamilySweepOptions]) -> Batch:
    """Settle every point of the job; carried points start where the one before them ended."""
    options = job.options
    rows: list[dict[str, Any]] = []
    impacts: list[dict[str, Any]] = []
    before = job.start
    for point in job.points:
        p = parameters_of(options.system, point.params)
        start = start_of(p, options.start, before if job.carry is not None else None)
        found = settle_from(
            p,
            start,
            settle=options.settle,
            record=options.record,
            watch=options.watch,
            largest_p=options.largest_p or None,
        )
        row = family_point(point.id, found, start, job.carry, options.harvest)
        rows.append(row)
        before = row
        if options.keep:
            impacts += family_impacts(point.id, p, representative(found, options.keep))
    return Batch(
        tables={system_table(options.system, "points"): rows, system_table(options.system, "impacts"): impacts}
    )
