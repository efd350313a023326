"""Body of the kind ``transient`` for systems beside the VI-NES: where the energy of a run without forcing goes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vines.dynamics import simulate
from vines.dynamics.runs import IN_TURN
from vines.pipeline import Batch, Job
from vines.schema import system_table
from vines.stages.bodies._family_rows import only_own, parameters_of
from vines.stages.bodies._transient import transient_row

if TYPE_CHECKING:
    from vines.stages.kinds._family import FamilyTransientOptions

__all__ = ["compute"]


def compute(job: Job[FamilyTransientOptions]) -> Batch:
    """Run every point of the job from x1 = 0, v1 = V."""
    options = job.options
    rows: list[dict[str, Any]] = []
    for point in job.points:
        own = {name: value for name, value in point.params.items() if name != "V"}
        p = parameters_of(options.system, own | {"A": 0.0})
        at_rest = {each.name: 0.0 for each in p.system.state}
        given = p.system.started(at_rest | options.start)
        start: dict[str, Any] = {name: given[name] for name in at_rest} | {"v1": point.params["V"]}
        run = simulate(p, **start, periods=options.periods, ties=IN_TURN)
        row = transient_row(point, run)
        lost = run.measures().travel_loss / row["energy"]
        more = dict.fromkeys(("electric_share", "friction_share"), lost)
        rows.append(only_own(p, "transients", row | more))
    return Batch(tables={system_table(options.system, "transients"): rows})
