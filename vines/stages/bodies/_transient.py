"""Body of the kind ``transient``: where the energy of one run without forcing goes, and how fast."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from vines.dynamics import Trajectory, decay, simulate
from vines.model import Params
from vines.pipeline import Batch, Job, Point

if TYPE_CHECKING:
    from vines.stages.kinds.transient import TransientOptions

__all__ = ["compute", "transient_row"]


def compute(job: Job[TransientOptions]) -> Batch:
    """Run every point of the job from x1 = 0, v1 = V."""
    options = job.options
    rows: list[dict[str, Any]] = []
    for point in job.points:
        own = {name: value for name, value in point.params.items() if name != "V"}
        p = Params(**own, A=0.0)
        run = simulate(p, v1=point.params["V"], x2=options.x2, v2=options.v2, periods=options.periods)
        rows.append(transient_row(point, run))
    return Batch(tables={"transients": rows})


def transient_row(point: Point, run: Trajectory) -> dict[str, Any]:
    """Return the row of one undriven run."""
    found = decay(run)
    return {
        "point_id": point.id,
        **point.params,
        "periods": (run.t_end - run.t_start) / run.params.period,
        "energy": found.energy,
        "impact_share": found.impact_share,
        "damper_share": found.damper_share,
        "left_share": found.frame_share + found.ball_share,
        "ball_share": found.ball_share,
        "t_tenth": _there(found.times[0]),
        "t_hundredth": _there(found.times[1]),
        "impacts": found.impacts,
        "t_first": _there(found.first_impact),
        "t_last": _there(found.last_impact),
        "status": "ok" if run.status == "complete" else run.status,
        "reason": "" if run.status == "complete" else "more events in a period than are followed",
    }


def _there(time: float) -> float | None:
    return None if math.isnan(time) else time
