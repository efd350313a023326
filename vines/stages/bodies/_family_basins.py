"""Body of the kind ``basins`` for systems beside the VI-NES."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import pyarrow as pa

from vines.pipeline import Batch, WholeJob
from vines.schema import system_table
from vines.stages.bodies._basins import attractors_of, cells_of, found_of
from vines.stages.bodies._family_rows import family_outline, only_own, parameters_of

if TYPE_CHECKING:
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
    rows = [
        only_own(p, "attractors", row) for row in attractors_of(found, partial(family_outline, law=options.harvest))
    ]
    tables = {"attractors": rows, "basins": pa.table(cells_of(found))}
    return Batch(tables={system_table(options.system, name): made for name, made in tables.items()})
