"""Body of the kind ``branch`` for systems beside the VI-NES: families of orbits, with bifurcations."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from vines.orbits import bifurcation_row, branch_row
from vines.pipeline import Batch, WholeJob
from vines.schema import system_table
from vines.stages.bodies._branch import branches_of
from vines.stages.bodies._family_rows import family_orbit, only_own, parameters_of

if TYPE_CHECKING:
    from vines.stages.kinds._family import FamilyBranchOptions

__all__ = ["compute"]


def compute(job: WholeJob[FamilyBranchOptions]) -> Batch:
    """Follow one orbit from end to end of the range, or all families, and what comes out of them."""
    options = job.options
    branches = branches_of(job, partial(parameters_of, options.system))
    met = [(each, one) for one in branches for each in (*one.bifurcations, *one.events)]
    rows = {
        "orbits": [family_orbit(orbit, one.branch_id, options.harvest) for one in branches for orbit in one.orbits],
        "branches": [branch_row(one) for one in branches],
        "bifurcations": [
            only_own(each.orbit.params, "bifurcations", bifurcation_row(each, branch_id=one.branch_id))
            for each, one in met
        ],
    }
    return Batch(tables={system_table(options.system, name): own for name, own in rows.items()})
