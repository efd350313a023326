"""How long a run would take, by points that are really computed and not kept."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vines.cores import cores
from vines.pipeline._jobs import Job, Points
from vines.pipeline._plan import Planner, Prepared
from vines.pipeline._processes import WORTH_SECONDS
from vines.pipeline._worker import body_of

if TYPE_CHECKING:
    from vines.pipeline._declaration import Pipeline
    from vines.store import Store

__all__ = ["estimate", "seconds_a_point"]

_ENOUGH = 0.3
"""Seconds of points that are measured; beside them the clock and the start of a call are small."""
_GROWTH = 8


def estimate(
    pipeline: Pipeline,
    store: Store,
    stages: Iterable[str] | None = None,
    *,
    jobs: int | None = None,
    force: bool = False,
    retry_failed: bool = False,
) -> dict[str, float]:
    """Return how many seconds the points of each stage would take that a run would compute.

    A point from the middle of what is missing is computed, and more of them until the clock tells them well; nothing is
    stored. Stages of the whole shape, and those whose points fail, are left out; what a refinement would add is not
    counted.

    Parameters
    ----------
    pipeline, store, stages, jobs, force, retry_failed
        As for :func:`vines.pipeline.run_pipeline`.
    """
    planner = Planner(pipeline, store)
    found: dict[str, float] = {}
    for name in pipeline.select(stages):
        planner.plan(name)
        prepared = planner.prepare(name)
        if prepared.stage.kind.shape == "whole":
            continue
        located = store.pool(prepared.pool_key).locate(prepared.grid.ids)
        wanted = (located.part < 0) | (located.failed if retry_failed else False) | force
        places = np.flatnonzero(wanted)
        if not len(places):
            continue
        try:
            seconds = len(places) * _seconds_a_point(prepared, places)
        except Exception:  # whatever a body raises is told by the run, point by point
            continue
        chains = prepared.grid.chains
        width = sum(bool(wanted[chain.places].any()) for chain in chains) if chains else len(places)
        found[name] = seconds / min(jobs or cores(), width) if seconds >= WORTH_SECONDS else seconds
    return found


def _seconds_a_point(prepared: Prepared, places: np.ndarray) -> float:
    """Return how long a point of a stage takes that is not there yet."""
    stage, grid = prepared.stage, prepared.grid
    middle = int(places[len(places) // 2])
    if stage.carry is not None:
        chain = next(chain.places for chain in grid.chains if middle in chain.places)
        order = np.asarray(chain[chain.index(middle) :])
    else:
        order = np.roll(places, -(len(places) // 2))
    body = body_of(stage.kind.body)

    def compute(count: int) -> int:
        taken = order[:count]
        points = Points(grid.fixed(), grid.columns(taken), grid.ids.take(taken))
        carry = stage.carry.axis if stage.carry is not None else None
        with tempfile.TemporaryDirectory() as folder:
            body(Job(stage.options, points, carry, None, Path(folder), prepared.ingredients.provenance("")))
        return len(taken)

    return seconds_a_point(compute)


def seconds_a_point(compute: Callable[[int], int], clock: Callable[[], float] = time.perf_counter) -> float:
    """Return how long a point takes, without what the first one loads and compiles.

    Parameters
    ----------
    compute : callable
        Computes so many points, or all there are where those are fewer, and returns how many.
    clock : callable
        Tells the time in seconds.

    Examples
    --------
    >>> passed = [0.0, 0.5]
    >>> seconds_a_point(lambda count: count, iter(passed).__next__)
    0.5
    """
    compute(1)
    size = 1
    while True:
        began = clock()
        done = compute(size)
        took = clock() - began
        if took >= _ENOUGH or done < size:
            return took / done
        size *= _GROWTH
