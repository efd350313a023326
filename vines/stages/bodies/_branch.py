"""Body of the kind ``branch``: families of periodic orbits, with multipliers and bifurcations."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.errors import DeclarationError, OrbitNotFound
from vines.model import Params
from vines.orbits import (
    Branch,
    bifurcation_row,
    branch_row,
    find_orbit,
    follow_cascade,
    follow_families,
    orbit_row,
)
from vines.pipeline import Batch, WholeJob

if TYPE_CHECKING:
    from vines.stages.kinds.branch import BranchOptions

__all__ = ["branch_tables", "branches_of", "compute"]


def compute(job: WholeJob[BranchOptions]) -> Batch:
    """Follow one orbit from end to end of the range, or all families, and what comes out of them."""
    return Batch(tables=branch_tables(branches_of(job, lambda values: Params(**values))))


def branches_of(job: WholeJob[Any], form: Callable[[dict[str, float]], Any]) -> list[Branch]:
    """Return the branches of a stage.

    Parameters
    ----------
    job : WholeJob
        With the options of the kind, whatever the system.
    form : callable
        Makes the parameters of the system from their flat names.

    Raises
    ------
    OrbitNotFound
        If there is no orbit to follow.
    """
    if len(job.ranges) != 1:
        raise DeclarationError(f"a branch is followed in one parameter, this one varies {len(job.ranges)}")
    (axis, span), *_ = job.ranges.items()
    options = job.options
    start = form({**job.params, axis: span.start})
    at = np.linspace(span.start, span.stop, options.points).tolist()
    if options.families == "one":
        orbit = find_orbit(options.word, start)
        return follow_cascade(orbit, axis, span.stop, depth=options.switch, at=at)
    seeds = np.linspace(span.start, span.stop, options.seeds).tolist()
    ends = (span.start, span.stop)
    followed = follow_families(options.word, start, axis, ends, seeds=seeds, depth=options.switch, at=at)
    if not followed:
        raise OrbitNotFound(
            f"no admissible {options.word} orbit at any of {options.seeds} values of {axis} from {span.start:g} to "
            f"{span.stop:g}; give another range or more seeds"
        )
    return list(followed)


def branch_tables(branches: list[Branch]) -> dict[str, list[dict[str, Any]]]:
    """Return the rows of ``orbits``, ``branches`` and ``bifurcations``."""
    return {
        "orbits": [orbit_row(orbit, branch_id=one.branch_id) for one in branches for orbit in one.orbits],
        "branches": [branch_row(one) for one in branches],
        "bifurcations": [
            bifurcation_row(found, branch_id=one.branch_id)
            for one in branches
            for found in (*one.bifurcations, *one.events)
        ],
    }
