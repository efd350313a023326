"""Body of the kind ``branch``: a family of periodic orbits, with multipliers and bifurcations."""

from __future__ import annotations

from typing import Any

import numpy as np

from vines.errors import DeclarationError
from vines.model import Params
from vines.orbits import bifurcation_row, branch_row, continue_orbit, find_orbit, orbit_row
from vines.pipeline import Batch, WholeJob

__all__ = ["compute"]


def compute(job: WholeJob) -> Batch:
    """Find the orbit at one end of the range and follow it to the other."""
    options: Any = job.options
    if len(job.ranges) != 1:
        raise DeclarationError(f"a branch is followed in one parameter, this one varies {len(job.ranges)}")
    (axis, span), *_ = job.ranges.items()
    start = Params(**{**job.params, axis: span.start})
    at = np.linspace(span.start, span.stop, options.points).tolist()
    branch = continue_orbit(find_orbit(options.word, start), axis, stop=span.stop, at=at)
    row = branch_row(branch)
    name = row["branch_id"]
    return Batch(
        tables={
            "orbits": [orbit_row(orbit, branch_id=name) for orbit in branch.orbits],
            "branches": [row],
            "bifurcations": [
                bifurcation_row(found, branch_id=name) for found in (*branch.bifurcations, *branch.events)
            ],
        }
    )
