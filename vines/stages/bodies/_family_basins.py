"""Body of the kind ``basins`` for systems beside the VI-NES."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import pyarrow as pa

from vines.attractors import Attractor, settle_from
from vines.pipeline import Batch, WholeJob
from vines.schema import system_table
from vines.stages.bodies._basins import attractors_of, cells_of, found_of
from vines.stages.bodies._family_rows import family_outline, only_own, parameters_of

if TYPE_CHECKING:
    from vines.stages.kinds._family import HarvestLaw
    from vines.stages.kinds.basins import FamilyBasinsOptions

__all__ = ["compute"]


def compute(job: WholeJob[FamilyBasinsOptions]) -> Batch:
    """Find the basins and describe the attractors."""
    options = job.options
    p = parameters_of(options.system, job.params)
    at_zero = {each.name: 0.0 for each in p.system.start}
    axes = (options.x.name, options.y.name)
    others = {name: value for name, value in p.system.started(at_zero | options.start).items() if name not in axes}
    found = found_of(p, options, others)
    told = partial(_told, law=options.harvest)
    rows = [only_own(p, "attractors", row) for row in attractors_of(found, told)]
    tables = {"attractors": rows, "basins": pa.table(cells_of(found))}
    return Batch(tables={system_table(options.system, name): made for name, made in tables.items()})


def _told(attractor: Attractor, law: HarvestLaw | None) -> dict[str, Any]:
    """Return what is told of an attractor; a law is applied to its impacts, which the search did not keep."""
    if law is not None and not len(attractor.impacts):
        shown = settle_from(attractor.params, attractor.final, settle=0, patience=0)
        attractor = replace(attractor, impacts=shown.impacts)
    return family_outline(attractor, law)
