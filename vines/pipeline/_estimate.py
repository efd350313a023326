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
from vines.pipeline._links import with_links
from vines.pipeline._plan import Planner, Prepared
from vines.pipeline._processes import WORTH_SECONDS
from vines.pipeline._worker import body_of

if TYPE_CHECKING:
    from vines.pipeline._declaration import Pipeline
    from vines.store import Store

__all__ = ["estimate", "seconds_a_point"]

_ENOUGH, _LEAST = 1.0, 120
"""Seconds of points, and how many of them, that are measured: few say little where some take a hundred times longer."""
_MOST = 5.0
"""Seconds after which no more are computed, however few there were."""
_GROWTH = 8
_SEED = 0


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

    Points drawn from what is missing are computed until the clock tells them well; nothing is stored. Stages of the
    whole shape, those of which a single point takes long, and those whose points fail, are left out; what a refinement
    would add is not counted.

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
        kind = prepared.stage.kind
        if kind.shape == "whole" or kind.again == "long_points":
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
    """Return how long a point of a stage takes that is not there yet.

    What a point takes differs a hundredfold between a motion that repeats and chaos, which lie in regions: so the
    points are drawn from all that are missing, always the same ones. Carried ones are taken in the order of their
    chains, each from where the one before it that was drawn ended.
    """
    stage, grid = prepared.stage, prepared.grid
    drawn = np.random.default_rng(_SEED).permutation(places)
    ranks = np.empty(len(grid), np.int64)
    if stage.carry is not None:
        ranks[np.concatenate([np.asarray(chain.places) for chain in grid.chains])] = np.arange(len(grid))
    body = body_of(stage.kind.body)

    def compute(first: int, count: int) -> None:
        taken = drawn[first : first + count]
        if stage.carry is not None:
            taken = taken[np.argsort(ranks[taken])]
        points = Points(grid.fixed(), with_links(stage, grid.columns(taken)), grid.ids.take(taken))
        carry = stage.carry.axis if stage.carry is not None else None
        with tempfile.TemporaryDirectory() as folder:
            body(Job(stage.options, points, carry, None, Path(folder), prepared.ingredients.provenance("")))

    return seconds_a_point(compute, len(drawn))


def seconds_a_point(
    compute: Callable[[int, int], object], total: int, clock: Callable[[], float] = time.perf_counter
) -> float:
    """Return how long a point takes, without what the first one loads and compiles.

    Parameters
    ----------
    compute : callable
        ``compute(first, count)`` computes so many points of those that were drawn, from the first on.
    total : int
        How many there are, > 0.
    clock : callable
        Tells the time in seconds.

    Examples
    --------
    >>> passed = []
    >>> compute = lambda first, count: passed.extend([0.01] * count)
    >>> round(seconds_a_point(compute, 1000, lambda: sum(passed)), 6), len(passed) < 200
    (0.01, True)
    """
    compute(0, 1)
    took, done, size = 0.0, 0, 1
    batches: list[tuple[int, float]] = []
    while True:
        began = clock()
        compute(done, size)
        batches.append((size, clock() - began))
        took, done = took + batches[-1][1], done + size
        if (took >= _ENOUGH and done >= _LEAST) or took >= _MOST or done == total:
            break
        rate = done / max(took, 1e-9)
        wanted = max((_ENOUGH - took) * rate, _LEAST - done)
        size = max(1, min(_GROWTH * size, int(min(wanted, (_MOST - took) * rate)), total - done))
    # Many points go other ways than few, whose code the first of them load too: the large batches tell.
    largest = max(size for size, _ in batches)
    large = [each for each in batches if 2 * each[0] >= largest]
    return sum(seconds for _, seconds in large) / sum(size for size, _ in large)
