"""Body of the kind ``curve`` for systems beside the VI-NES."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from vines.pipeline import Batch, WholeJob
from vines.schema import system_table
from vines.stages.bodies._curve import followed, rows_of
from vines.stages.bodies._family_rows import only_own, parameters_of

if TYPE_CHECKING:
    from vines.stages.kinds.curve import FamilyCurveOptions

__all__ = ["compute"]


def compute(job: WholeJob[FamilyCurveOptions]) -> Batch:
    """Find the bifurcations on lines through the box and follow each that lies on no curve yet, both ways."""
    system = job.options.system
    curves = followed(job, partial(parameters_of, system))
    rows = [only_own(curve.orbits[0].params, "curves", row) for curve in curves for row in rows_of(curve)]
    return Batch(tables={system_table(system, "curves"): rows})
