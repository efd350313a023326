"""Body of the kind ``dimensionless``: what a rig in SI units is in the model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vines.model import PhysicalParams
from vines.pipeline import Batch, Job

if TYPE_CHECKING:
    from vines.stages.kinds.dimensionless import DimensionlessOptions

__all__ = ["compute"]

RIG = ("M", "c", "k", "b", "r")
_COLUMNS = {"M": "mass", "m": "ball_mass", "omega": "forcing_frequency"}
"""SQL does not tell capitals from small letters."""


def compute(job: Job[DimensionlessOptions]) -> Batch:
    """Convert every point of the job by (6) of the paper."""
    rows = []
    for point in job.points:
        rig = PhysicalParams(**{name: point.params[name] for name in RIG})
        p = rig.dimensionless(**{name: point.params[name] for name in ("E", "omega", "m")})
        rows.append(
            {
                "point_id": point.id,
                **{_COLUMNS.get(name, name): value for name, value in point.params.items()},
                "omega0": rig.omega0,
                **{name: getattr(p, name) for name in ("mu", "A", "Omega", "lam")},
                "status": "ok",
                "reason": "",
            }
        )
    return Batch(tables={"dimensionless": rows})
