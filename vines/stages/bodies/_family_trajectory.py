"""Body of the kind ``trajectory`` for systems beside the VI-NES: a run as an MCAP log, and the attractor it is on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vines.attractors import settle_from
from vines.dynamics import Trajectory, simulate
from vines.dynamics.runs import IN_TURN
from vines.logs import write_run
from vines.model import Parameters
from vines.pipeline import Batch, Job
from vines.schema import system_table
from vines.stages.bodies._family_rows import family_impacts, family_point, parameters_of, start_of
from vines.stages.bodies._sweep import representative
from vines.stages.bodies._trajectory import CLASSIFY_AFTER, CLASSIFY_OVER

if TYPE_CHECKING:
    from vines.stages.kinds._family import FamilyTrajectoryOptions

__all__ = ["compute"]


def compute(job: Job[FamilyTrajectoryOptions]) -> Batch:
    """Run every point: `settle` periods unrecorded, `record` periods into a log, and on to name the attractor."""
    options = job.options
    rows: list[dict[str, Any]] = []
    impacts: list[dict[str, Any]] = []
    logs: dict[str, str] = {}
    before = job.start
    for point in job.points:
        p = parameters_of(options.system, point.params)
        start = start_of(p, options.start, before if job.carry is not None else None)
        state = _run(p, start, options.settle).final if options.settle else start
        run = _run(p, state, options.record)
        wait = 0 if options.settle else CLASSIFY_AFTER
        found = settle_from(p, run.final, settle=wait, record=CLASSIFY_OVER)
        row = family_point(point.id, found, start, job.carry, None)
        row["settle_periods"] += options.settle + options.record
        rows.append(row)
        before = row
        impacts += family_impacts(point.id, p, representative(found, CLASSIFY_OVER))
        logs[point.id] = f"{point.id}.mcap"
        called = found.name or found.regime
        write_run(
            job.folder / logs[point.id],
            states=run.sample(per_period=options.per_period, at_events=True),
            impacts=run.impacts,
            sticks=run.rests,
            provenance=job.provenance,
            parameters=p.as_dict(),
            name=f"{called}, {', '.join(f'{name} = {value:g}' for name, value in p.as_dict().items())}",
            attractor=called,
            system=options.system,
            bare=options.bare,
        )
    tables = {"points": rows, "impacts": impacts}
    return Batch(tables={system_table(options.system, name): own for name, own in tables.items()}, logs=logs)


def _run(p: Parameters, state: dict[str, float], periods: float) -> Trajectory:
    """Go on from a state, at time 0 and in its phase, as runs that settle do."""
    at: dict[str, Any] = {name: value for name, value in state.items() if name not in ("t", "phase")}
    return simulate(p, phi=state["phase"], periods=periods, ties=IN_TURN, **at)
