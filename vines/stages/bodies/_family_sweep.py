"""Body of the kind ``sweep`` for systems beside the VI-NES: what each point settles to, and what is beside."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from vines.attractors import coexisting, random_starts, settle_from
from vines.model import Parameters
from vines.pipeline import Batch, Job
from vines.schema import system_table
from vines.stages.bodies._family_rows import family_attractors, family_impacts, family_point, parameters_of, start_of
from vines.stages.bodies._sweep import representative

if TYPE_CHECKING:
    from vines.stages.kinds._family import FamilySweepOptions

__all__ = ["compute"]


def compute(job: Job[FamilySweepOptions]) -> Batch:
    """Settle every point of the job, one by one; carried points start where the one before them ended."""
    options, law = job.options, job.options.harvest
    waiting: dict[str, Any] = {"settle": options.settle, "record": options.record, "watch": options.watch}
    waiting["largest_p"] = options.largest_p or None
    drawn = options.seed if options.start == "random" and job.carry is None else None
    rows: list[dict[str, Any]] = []
    own = []
    before = job.start
    for point in job.points:
        p = parameters_of(options.system, point.params)
        start = _start(p, options, before if job.carry is not None else None)
        found = settle_from(p, start, **waiting)
        own.append(found)
        row = family_point(point.id, found, start, job.carry, law, drawn)
        rows.append(row)
        before = row
    # A law is applied to impacts, whether they are kept or not.
    recorded = options.keep > 0 or law is not None
    listed = coexisting(own, random=options.random, seed=options.seed, impacts=recorded, **waiting)
    impacts: list[dict[str, Any]] = []
    attractors: list[dict[str, Any]] = []
    for identity, found in zip(job.points.ids, listed, strict=True):
        attractors += family_attractors(identity, found, options.random, law)
        for number, (each, _) in enumerate(found if options.keep else ()):
            impacts += family_impacts(identity, each.params, representative(each, options.keep), number)
    tables = {"points": rows, "impacts": impacts, "attractors": attractors}
    return Batch(tables={system_table(options.system, name): made for name, made in tables.items()})


def _start(p: Parameters, options: FamilySweepOptions, before: Mapping[str, Any] | None) -> dict[str, float]:
    """Return the start of a point: as declared or drawn, or where the point before it ended."""
    if options.start != "random" or before is not None:
        return start_of(p, {} if options.start == "random" else options.start, before)
    (drawn,) = random_starts(p, 1, options.seed).tolist()
    names = [each.name for each in p.system.state]
    return dict(zip(names, drawn, strict=True)) | {p.system.phase.name: 0.0}
