"""Body of the kind ``sweep``: the settled attractor of each point, its impacts and its energy measures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from vines.attractors import Attractor, classify_many, coexisting, random_starts, settle
from vines.model import PARAMETER_NAMES, START_NAMES, STATE_NAMES, Params
from vines.pipeline import Batch, Job
from vines.stages.bodies._coexisting import attractor_rows
from vines.stages.bodies._rows import impact_rows, point_row

if TYPE_CHECKING:
    from vines.stages.kinds.sweep import SweepOptions

__all__ = ["compute", "representative"]


def compute(job: Job[SweepOptions]) -> Batch:
    """Settle every point of the job; carried points start where the one before them ended, all others run at once."""
    options = job.options
    starts, own = _along_the_chain(job) if job.carry is not None else _each_for_itself(job)
    drawn = options.seed if options.start == "random" and job.carry is None else None
    listed = coexisting(
        own,
        random=options.random,
        seed=options.seed,
        settle=options.settle,
        record=options.record,
        watch=options.watch,
        largest_p=options.largest_p or None,
        impacts=options.keep > 0,
    )
    rows: list[dict[str, Any]] = []
    impacts: list[dict[str, Any]] = []
    attractors: list[dict[str, Any]] = []
    for identity, start, attractor, found in zip(job.points.ids, starts, own, listed, strict=True):
        rows.append(point_row(identity, attractor, start, carry=job.carry, before=0, seed=drawn))
        if options.keep:
            for number, (each, _) in enumerate(found):
                kept = representative(each, options.keep)
                impacts.append(impact_rows(identity, each.params, kept, number))
        attractors += attractor_rows(identity, found, options.random)
    if not impacts:
        impacts.append(impact_rows("", own[0].params, own[0].impacts[:0]))
    columns = {name: np.concatenate([part[name] for part in impacts]) for name in impacts[0]}
    return Batch(tables={"points": rows, "impacts": pa.table(columns), "attractors": attractors})


def _along_the_chain(job: Job[SweepOptions]) -> tuple[list[dict[str, float]], list[Attractor]]:
    """Return starts and attractors where each point starts from the end of the one before."""
    options = job.options
    if job.start is not None:
        start = {name: float(job.start[f"end_{name}"]) for name in START_NAMES}
    else:
        (start,) = _starts(job, 1)
    starts, own = [], []
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
            watch=options.watch,
            largest_p=options.largest_p or None,
        )
        starts.append(start)
        own.append(attractor)
        start = {name: attractor.final[name] for name in START_NAMES}
    return starts, own


def _each_for_itself(job: Job[SweepOptions]) -> tuple[list[dict[str, float]], list[Attractor]]:
    """Return starts and attractors where every point starts as the options say."""
    options = job.options
    starts = _starts(job, len(job.points))
    many = classify_many(
        {name: job.points.column(name) for name in PARAMETER_NAMES},
        {name: np.array([start[name] for start in starts]) for name in START_NAMES},
        settle=options.settle,
        record=options.record,
        watch=options.watch,
        largest_p=options.largest_p or None,
        impacts=options.keep > 0,
    )
    return starts, [many.attractor(k) for k in range(len(many))]


def _starts(job: Job[SweepOptions], count: int) -> list[dict[str, float]]:
    """Return the starts of the first points: the same for all, or drawn at random for each."""
    options = job.options
    if options.start == "random":
        drawn = [random_starts(Params(**point.params), 1, options.seed)[0] for point in job.points[:count]]
    else:
        drawn = [[getattr(options.start, name) for name in STATE_NAMES]] * count
    return [dict(zip(START_NAMES, [*map(float, start), 0.0], strict=True)) for start in drawn]


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
