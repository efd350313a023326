"""Body of the kind ``optimum``: the best stable orbit over ranges of parameters, and how robust it is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from vines.errors import DeclarationError
from vines.model import Params
from vines.orbits import Optimum, optimise, orbit_row
from vines.pipeline import Batch, WholeJob

if TYPE_CHECKING:
    from vines.stages.kinds.optimum import OptimumOptions

__all__ = ["compute", "optimum_row"]


def compute(job: WholeJob[OptimumOptions]) -> Batch:
    """Search over the declared ranges."""
    options = job.options
    if not job.ranges:
        raise DeclarationError(
            "an optimum is sought over the range of at least one parameter; give vary.A = { from, to }"
        )
    if job.params.get("b", 1.0) != 1.0:
        raise DeclarationError(
            f"b is {job.params['b']:g}; it is the length of the cavity in units of the one that A is for, so "
            "vary it or give another A"
        )
    over = {name: (min(span.start, span.stop), max(span.start, span.stop)) for name, span in job.ranges.items()}
    # Where a varied parameter has no value of its own the search begins in the middle.
    middle = {name: (low + high) / 2 for name, (low, high) in over.items()}
    given = {name: value for name, value in {**middle, **job.params}.items() if name != "b"}
    best = optimise(
        options.word, options.objective, Params(**given), over, largest_multiplier=options.largest_multiplier
    )
    return Batch(tables={"optima": [optimum_row(best)], "orbits": [orbit_row(best.orbit)]})


def optimum_row(best: Optimum) -> dict[str, Any]:
    """Return the row of the table `optima`."""
    orbit = best.orbit
    distance, name, kind = best.nearest
    row = {
        "word": str(orbit.word),
        "name": orbit.name,
        "objective": best.objective,
        "value": best.value,
        "over": ", ".join(f"{key} = {low:g} … {high:g}" for key, (low, high) in best.over.items()),
        "active": ", ".join(best.active),
        **orbit.params.as_dict(),
        "b": best.b,
        "orbit_id": orbit.orbit_id,
        "max_abs_x1": orbit.measures.max_abs_x1,
        "kinetic_ratio": orbit.measures.kinetic_ratio,
        "max_multiplier": orbit.max_multiplier,
        "min_clearance": orbit.min_clearance,
        "nearest": distance if math.isfinite(distance) else None,
        "nearest_parameter": name,
        "nearest_type": kind,
    }
    for key, margin in best.margins.items():
        row |= {
            f"{key}_below": margin.below,
            f"{key}_below_type": margin.below_type,
            f"{key}_above": margin.above,
            f"{key}_above_type": margin.above_type,
        }
    return row
