"""Body of the kind ``branch`` for systems beside the VI-NES: a family of periodic orbits, and its bifurcations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vines.errors import DeclarationError
from vines.orbits import bifurcation_row, branch_row, continue_orbit, find_orbit
from vines.pipeline import Batch, WholeJob
from vines.schema import system_table
from vines.stages.bodies._family_rows import family_orbit, only_own, parameters_of

if TYPE_CHECKING:
    from vines.stages.kinds._family import FamilyBranchOptions

__all__ = ["compute"]


def compute(job: WholeJob[FamilyBranchOptions]) -> Batch:
    """Follow the orbit of the word from end to end of the range."""
    options = job.options
    if len(job.ranges) != 1:
        raise DeclarationError(f"a branch is followed in one parameter, this one varies {len(job.ranges)}")
    (axis, span), *_ = job.ranges.items()
    start = parameters_of(options.system, {**job.params, axis: span.start})
    at = np.linspace(span.start, span.stop, options.points).tolist()
    branch = continue_orbit(find_orbit(options.word, start), axis, span.stop, at=at)
    met = [bifurcation_row(each, branch_id=branch.branch_id) for each in (*branch.bifurcations, *branch.events)]
    rows = {
        "orbits": [family_orbit(orbit, branch.branch_id, options.harvest) for orbit in branch.orbits],
        "branches": [branch_row(branch)],
        "bifurcations": [only_own(start, "bifurcations", row) for row in met],
    }
    return Batch(tables={system_table(options.system, name): own for name, own in rows.items()})
