"""Body of the kind ``trajectory``: a run of the simulator as an MCAP log, and the attractor it is on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np
import pyarrow as pa

from vines.attractors import settle
from vines.dynamics import simulate
from vines.logs import write_run
from vines.model import START_NAMES, STATE_NAMES, Params
from vines.pipeline import Batch, Job
from vines.stages.bodies._rows import impact_rows, point_row
from vines.stages.bodies._sweep import representative

if TYPE_CHECKING:
    from vines.stages.kinds.trajectory import TrajectoryOptions

__all__ = ["CLASSIFY_AFTER", "CLASSIFY_OVER", "compute"]

CLASSIFY_AFTER = 400
"""Forcing periods before the attractor is named when the log itself starts without any transient left out."""
CLASSIFY_OVER = 64


def compute(job: Job[TrajectoryOptions]) -> Batch:
    """Run every point: `settle` periods unrecorded, `record` periods into a log, and on to name the attractor.

    Carried points start where the one before them, or the point of a sweep that starts the chain, ended.
    """
    options = job.options
    rows: list[dict[str, Any]] = []
    impacts: list[dict[str, Any]] = []
    logs: dict[str, str] = {}
    start = {name: getattr(options.start, name) for name in STATE_NAMES} | {"phase": 0.0}
    if job.start is not None:
        start = {name: float(job.start[f"end_{name}"]) for name in START_NAMES}
    for point in job.points:
        p = Params(**point.params)
        state = start
        if options.settle:
            state = simulate(p, **_initial(start), periods=options.settle).final
        run = simulate(p, **_initial(state), periods=options.record)
        wait = 0 if options.settle else CLASSIFY_AFTER
        attractor = settle(p, **_initial(run.final), settle=wait, record=CLASSIFY_OVER)
        before = options.settle + options.record
        rows.append(point_row(point.id, attractor, start, carry=job.carry, before=before))
        impacts.append(impact_rows(point.id, p, representative(attractor, CLASSIFY_OVER)))
        logs[point.id] = f"{point.id}.mcap"
        write_run(
            job.folder / logs[point.id],
            states=run.sample(per_period=options.per_period, at_events=True),
            impacts=run.impacts,
            sticks=run.sticks,
            provenance=job.provenance,
            parameters=p.as_dict(),
            name=f"{attractor.name or attractor.regime}, A = {p.A:g}",
            attractor=attractor.name or attractor.regime,
            bare=options.bare,
        )
        if job.carry is not None:
            start = {name: attractor.final[name] for name in START_NAMES}
    columns = {name: np.concatenate([part[name] for part in impacts]) for name in impacts[0]}
    return Batch(tables={"points": rows, "impacts": pa.table(columns)}, logs=logs)


class _Initial(TypedDict):
    x1: float
    v1: float
    x2: float
    v2: float
    t: float
    phi: float


def _initial(state: dict[str, float]) -> _Initial:
    """Return the arguments with which `simulate` and `settle` go on from a state, at time 0 and in its phase."""
    return _Initial(x1=state["x1"], v1=state["v1"], x2=state["x2"], v2=state["v2"], t=0.0, phi=state["phase"])
