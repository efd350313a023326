"""Body of the kind ``reduced``: the multiple-scales approximation of the 1:1 response beside the exact orbit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from vines.model import Params
from vines.orbits import Orbit, Reduced, reduced_orbits, reduced_range, symmetric_orbits
from vines.pipeline import Batch, Job

if TYPE_CHECKING:
    from vines.stages.kinds.reduced import ReducedOptions

__all__ = ["compute", "reduced_row"]


def compute(job: Job[ReducedOptions]) -> Batch:
    """Compare approximation and orbit at every point of the job."""
    return Batch(tables={"reduced": [reduced_row(point.id, Params(**point.params)) for point in job.points]})


def reduced_row(point_id: str, p: Params) -> dict[str, Any]:
    """Return the row of the table `reduced` at p.

    Of several solutions it has the one of largest V, the only one that can be stable.
    """
    responses, orbits = reduced_orbits(p), symmetric_orbits(p)
    low, high = reduced_range(p)
    row = {
        "point_id": point_id,
        **p.as_dict(),
        "stable_from": low,
        "stable_to": high,
        "responses": len(responses),
        "exact_orbits": len(orbits),
        "status": "ok",
        "reason": "",
    }
    if responses:
        row |= _response(responses[0])
    if orbits:
        row |= _exact(orbits[0])
    if responses and orbits:
        for name in ("max_abs_x1", "kinetic_ratio", "w_dot"):
            row[f"error_{name}"] = row[name] / row[f"exact_{name}"] - 1
        row["error_phase"] = math.remainder(row["phase"] - row["exact_phase"], 2 * math.pi)
    return row


def _response(found: Reduced) -> dict[str, Any]:
    return {
        "ball_speed": found.ball_speed,
        "max_abs_x1": found.max_abs_x1,
        "kinetic_ratio": found.kinetic_ratio,
        "w_dot": found.w_dot,
        "phase": found.phase,
        "min_clearance": found.min_clearance,
        "max_fast_multiplier": float(abs(found.fast_multipliers[0])),
        "max_slow_rate": float(found.slow_eigenvalues.real.max()),
        "stable": found.stable,
        "admissible": found.admissible,
    }


def _exact(orbit: Orbit) -> dict[str, Any]:
    return {
        "exact_ball_speed": -float(orbit.states[0, 3]),
        "exact_max_abs_x1": orbit.measures.max_abs_x1,
        "exact_kinetic_ratio": orbit.measures.kinetic_ratio,
        "exact_w_dot": float(orbit.w_dot[0]),
        "exact_phase": float(orbit.phase[0]),
        "exact_min_clearance": orbit.min_clearance,
        "exact_max_multiplier": orbit.max_multiplier,
        "exact_stable": orbit.stable,
        "exact_admissible": orbit.admissible,
    }
