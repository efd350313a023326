"""Body of the kind ``dimensionless``: what a rig in SI units is in the model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vines.model import PARAMETER_NAMES, VI_NES, PhysicalParams
from vines.pipeline import Batch, Job

if TYPE_CHECKING:
    from vines.stages.kinds.dimensionless import DimensionlessOptions

__all__ = ["compute"]

_COLUMNS = {"M": "mass", "m": "ball_mass", "omega": "forcing_frequency"}
"""SQL does not tell capitals from small letters."""


def compute(job: Job[DimensionlessOptions]) -> Batch:
    """Convert every point of the job by (6) of the paper."""
    rows = []
    for point in job.points:
        rig = PhysicalParams(**{each.name: point.params[each.name] for each in VI_NES.rig})
        p = rig.dimensionless(**{each.name: point.params[each.name] for each in VI_NES.run})
        rows.append(
            {
                "point_id": point.id,
                **{_COLUMNS.get(name, name): value for name, value in point.params.items()},
                "omega0": rig.omega0,
                **{name: getattr(p, name) for name in PARAMETER_NAMES if name != "r"},
                "status": "ok",
                "reason": "",
            }
        )
    return Batch(tables={"dimensionless": rows})
