"""Body of the kind ``sweep``: the settled attractor of each point, its impacts and its energy measures."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyarrow as pa

from vines.attractors import Attractor, settle
from vines.model import Params
from vines.pipeline import Batch, Job
from vines.stages._coexisting import attractor_rows, coexisting
from vines.stages._rows import STATE, impact_rows, point_row

__all__ = ["compute"]


def compute(job: Job) -> Batch:
    """Settle every point of the job; carried points start where the one before them ended."""
    options: Any = job.options
    at_rest = {name: getattr(options.start, name) for name in STATE[:4]} | {"phase": 0.0}
    start = at_rest if job.start is None else {name: float(job.start[f"end_{name}"]) for name in STATE}
    rows: list[dict[str, Any]] = []
    impacts: list[dict[str, Any]] = []
    attractors: list[dict[str, Any]] = []
    for point in job.points:
        attractor = settle(
            Params(**point.params),
            x1=start["x1"],
            v1=start["v1"],
            x2=start["x2"],
            v2=start["v2"],
            phi=start["phase"],
            settle=options.settle,
            record=options.record,
        )
        rows.append(point_row(point.id, attractor, start, carry=job.carry, before=0, record=options.record))
        impacts.append(impact_rows(point.id, attractor.params, representative(attractor, options.keep)))
        found = coexisting(
            attractor, random=options.random, seed=options.seed, settle_for=options.settle, record=options.record
        )
        attractors += attractor_rows(point.id, found, options.random)
        if job.carry is not None:
            start = {name: attractor.final[name] for name in STATE}
    columns = {name: np.concatenate([part[name] for part in impacts]) for name in impacts[0]}
    return Batch(tables={"points": rows, "impacts": pa.table(columns), "attractors": attractors})


def representative(attractor: Attractor, keep: int) -> np.ndarray:
    """Return the last impacts of an attractor and one more: one repetition if it is periodic, else `keep` periods.

    The time of the first kept one is not changed; it counts from the start of the recording.
    """
    recorded = attractor.impacts
    if not len(recorded):
        return recorded
    periods = attractor.p if attractor.settled and attractor.p else keep
    # The end of the last whole repetition is the last impact that has a successor.
    cut = recorded["t"][-1] - periods * attractor.params.period
    # Half of the shortest flight separates "exactly one repetition ago" from the impact before it.
    slack = 0.5 * float(np.min(np.diff(recorded["t"]), initial=attractor.params.period))
    return recorded[recorded["t"] > cut - min(slack, 1e-6)]
