"""Running a pipeline: plan each stage, compute what is missing, put the result together, pin it."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from vines.errors import DamageError, SchemaError
from vines.pipeline._declaration import Pipeline
from vines.pipeline._events import Event, Report, RunSummary, StageOutcome, silent
from vines.pipeline._plan import Planner, Prepared, StagePlan
from vines.pipeline._whole import WholeTask, compute_whole, whole_task
from vines.store import Store, show_pictures

if TYPE_CHECKING:
    from concurrent.futures import Future

    from vines.pipeline._engine import Engine
    from vines.pipeline._kinds import Kind
    from vines.pipeline._shard import Shard

__all__ = ["run_pipeline"]


def run_pipeline(
    pipeline: Pipeline,
    store: Store,
    *,
    stages: Iterable[str] | None = None,
    jobs: int | None = None,
    engine: Literal["local", "dask"] = "local",
    scheduler: str | None = None,
    shard: Shard | None = None,
    merge: bool = False,
    force: bool = False,
    retry_failed: bool = False,
    report: Report = silent,
) -> RunSummary:
    """Compute what a pipeline asks for and the store does not have yet.

    Interrupted at any time, by Ctrl-C or otherwise, what was stored stays, and the same call goes on.

    Parameters
    ----------
    pipeline : Pipeline
        The declared pipeline.
    store : Store
        Where results are kept.
    stages : iterable of str, optional
        Only these stages and what they need.
    jobs : int, optional
        Processes for the points; all cores if left out. Small work stays in this process.
    engine : {"local", "dask"}
        Who computes the points.
    scheduler : str, optional
        Address of a dask scheduler; without one dask gets a cluster of its own on this machine.
    shard : Shard, optional
        Compute this share of the points and nothing else: no result is put together. Several shards may run at the same
        time.
    merge : bool
        Put results together from points that shards computed; compute no point.
    force : bool
        Compute the named stages (all if none are named) again, whether or not they are there.
    retry_failed : bool
        Compute points again whose rows have the status ``failed``.
    report : callable
        Told what happens, see :class:`Event`.

    Returns
    -------
    RunSummary
        Failed points and stages are counted there; :meth:`RunSummary.check` makes an error of them.

    Raises
    ------
    UnknownNameError
        If there is no such stage.
    FileMissingError
        If a file that a stage needs is missing.
    StoreError
        If the store is damaged, or workers die again and again.
    EngineError
        If dask is missing, or its scheduler is gone.
    """
    named = None if stages is None else tuple(stages)
    order = pipeline.select(named)
    planner = Planner(pipeline, store)
    plans = [planner.plan(name) for name in order]
    if shard is not None:
        crew = _crew(engine, scheduler, jobs, store)
        return _share(planner.afresh(), order, shard, crew, retry_failed=retry_failed, report=report)
    gone = [name for name in planner.pins if name not in pipeline.stages]
    if not (force or gone) and all(_settled(each, retry_failed) for each in plans):
        planner.code.save()
        for each in plans:
            report(_event("up_to_date", each))
        return RunSummary(pipeline.name, tuple(_kept(each) for each in plans))
    with store.writing(lambda: report(Event("waiting"))):
        # another process may have done some of it meanwhile
        run = _Run(planner.afresh(), _crew(engine, scheduler, jobs, store), retry_failed, merge, report)
        forced = set(order if named is None else named) if force else set()
        left = {each.name for each in plans if each.name in forced or not _settled(each, retry_failed)}
        last = max(
            (place for place, name in enumerate(order) if name in left and _is_heavy(pipeline.stages[name].kind)),
            default=-1,
        )
        with run.engine:
            for place, name in enumerate(order):
                run.stage(name, force=name in forced, more=place < last)
            run.finish()
        run.planner.code.save()
        if gone:
            store.unpin(pipeline.name, gone)
    return RunSummary(pipeline.name, tuple(run.outcomes[name] for name in order))


def _is_heavy(kind: Kind) -> bool:
    """Say whether a stage takes long enough for a picture to be drawn beside it."""
    return kind.shape == "points" or kind.pictures


def _crew(engine: str, scheduler: str | None, jobs: int | None, store: Store) -> Engine:
    from vines.cores import cores
    from vines.pipeline._engine import Engine
    from vines.pipeline._processes import Processes

    count = jobs if jobs is not None else cores()
    if engine == "local":
        return Engine(Processes(count), store)
    from vines.pipeline._dask import Dask

    return Engine(Dask(scheduler, count), store)


def _share(
    planner: Planner, order: Iterable[str], shard: Shard, engine: Engine, *, retry_failed: bool, report: Report
) -> RunSummary:
    """Compute one share of the points of each stage. Without the lock: parts of pools stand in nobody's way."""
    from vines.pipeline._sweep import Sweep

    outcomes = []
    with engine:
        for name in order:
            each = planner.plan(name)
            prepared = planner.prepare(name)
            if prepared.stage.kind.shape == "whole" or _settled(each, retry_failed):
                continue
            sweep = Sweep(prepared, planner.store, engine, report, retry_failed=retry_failed, shard=shard)
            if not sweep.has_start():
                reason = "the point that it starts from belongs to another shard; run the shards once more"
                report(Event("skipped", name, text=reason))
                outcomes.append(StageOutcome(name, "skipped", reason=reason))
                continue
            report(_event("started", each, f"shard {shard}; {each.reason}"))
            failed = sweep.compute()
            wanted = sweep.new
            report(Event("done", name, wanted, wanted, failed))
            outcomes.append(StageOutcome(name, "computed", wanted, sweep.new, failed, reason=each.reason))
    planner.code.save()
    return RunSummary(planner.pipeline.name, tuple(outcomes))


class _Aside(NamedTuple):
    """A stage of the whole shape that is being computed, perhaps by another process."""

    prepared: Prepared
    each: StagePlan
    task: WholeTask
    future: Future[str] | None


class _Run:
    """One run, stage by stage."""

    def __init__(self, planner: Planner, engine: Engine, retry_failed: bool, merge: bool, report: Report) -> None:
        self.pipeline = planner.pipeline
        self.store = planner.store
        self.engine = engine
        self.retry_failed = retry_failed
        self.merge = merge
        self.report = report
        self.planner = planner
        self.outcomes: dict[str, StageOutcome] = {}
        self.aside: dict[str, _Aside] = {}

    def stage(self, name: str, *, force: bool, more: bool) -> None:
        """Bring one stage up to date; a picture may be drawn in another process while there is more to do."""
        stage = self.pipeline.stages[name]
        for need in stage.after:
            if need in self.aside:
                self._end(need)
        lost = [need for need in stage.after if self.outcomes[need].state in ("failed", "skipped")]
        if lost:
            reason = f"stage {lost[0]}, which it needs, has no result"
            self.report(Event("skipped", name, text=reason))
            self.outcomes[name] = StageOutcome(name, "skipped", reason=reason)
            return
        each = self.planner.plan(name)
        if not force and _settled(each, self.retry_failed):
            self.report(_event("up_to_date", each))
            self.outcomes[name] = _kept(each)
            return
        self.report(_event("started", each, "forced" if force and not each.reason else each.reason))
        prepared = self.planner.prepare(name)
        if stage.kind.shape == "points":
            self._done(prepared, self._points(prepared, each, force=force))
        elif self.store.has(each.key) and not force:
            self._done(prepared, StageOutcome(name, "computed", 1, 0, 0, each.key, each.reason))
        else:
            task = whole_task(prepared, self.store, self.planner, replace=force, token=self.engine.token)
            future = self.engine.aside(compute_whole, task) if more and stage.kind.pictures else None
            self.aside[name] = _Aside(prepared, each, task, future)
            if future is None:
                self._end(name)

    def finish(self) -> None:
        """Wait for the pictures that are still being drawn."""
        for name in list(self.aside):
            self._end(name)

    def _end(self, name: str) -> None:
        """Note how a stage of the whole shape ended; compute it here if no other process did."""
        prepared, each, task, future = self.aside.pop(name)
        problem = None if future is None else self.engine.outcome(future)
        if problem is None:
            spread = partial(self.engine.spread, told=partial(self._part, name))
            problem = compute_whole(task, spread)
        if problem:
            self._done(prepared, StageOutcome(name, "failed", 1, reason=problem))
        else:
            self._done(prepared, StageOutcome(name, "computed", 1, 1, 0, each.key, each.reason))

    def _done(self, prepared: Prepared, outcome: StageOutcome) -> None:
        """Pin the result of a stage and tell how it ended."""
        name = outcome.name
        if outcome.key:
            self.planner.set_key(name, outcome.key)
            self.store.pin(self.pipeline.name, name, _pin(prepared, outcome))
            if prepared.stage.kind.pictures:
                show_pictures(self.store.data, self.store.results / outcome.key, f"{self.pipeline.name}.{name}")
        self.outcomes[name] = outcome
        what = "failed" if outcome.state == "failed" else "done"
        text = outcome.reason if outcome.state == "failed" else outcome.remark
        self.report(Event(what, name, outcome.wanted, outcome.wanted, outcome.failed, text=text))

    def _part(self, name: str, done: int, of: int, processes: int) -> None:
        """Tell that a part of a stage of the whole shape is done."""
        self.report(Event("progress", name, of, done, jobs=processes))

    def _points(self, prepared: Prepared, each: StagePlan, *, force: bool) -> StageOutcome:
        """Compute what is missing and put the result together; again without the parts that turn out to be damaged."""
        pool = self.store.pool(prepared.pool_key)
        if force and pool.examine():
            self.store.discard_damaged(pool)
        while True:
            try:
                return self._once(prepared, each, force=force)
            except DamageError:
                if not pool.examine():
                    raise
            self.store.discard_damaged(pool)

    def _once(self, prepared: Prepared, each: StagePlan, *, force: bool) -> StageOutcome:
        from vines.pipeline._gather import put_together
        from vines.pipeline._sweep import Sweep

        sweep = Sweep(prepared, self.store, self.engine, self.report, force=force, retry_failed=self.retry_failed)
        try:
            if self.merge:
                sweep.look()
            else:
                sweep.compute()
        except (SchemaError, ImportError) as error:  # a mistake in the kind, not in a point: the other stages go on
            reason = f"{type(error).__name__}: {error}"
            return StageOutcome(each.name, "failed", each.wanted, reason=reason)
        if sweep.left:
            count = f"{sweep.left} of {len(sweep.grid)} points are missing"
            reason = f"{count}; run the shards again, or 'vines run {self.pipeline.name}' computes them here"
            return StageOutcome(each.name, "failed", len(sweep.grid), reason=reason)
        made = put_together(prepared, sweep.grid, self.store, replace=force, remark=sweep.remark)
        return StageOutcome(
            each.name,
            "computed",
            len(sweep.grid),
            sweep.new,
            made.failed,
            made.key,
            each.reason,
            sweep.remark,
            tuple(made.versions.items()),
        )


def _settled(each: StagePlan, retry_failed: bool) -> bool:
    return each.state == "up_to_date" and not (retry_failed and each.failed)


def _event(what: Any, each: StagePlan, text: str = "") -> Event:
    return Event(what, each.name, each.wanted, each.done, each.failed, text=text)


def _kept(each: StagePlan) -> StageOutcome:
    return StageOutcome(each.name, "up_to_date", each.wanted, 0, each.failed, each.key)


def _pin(prepared: Prepared, outcome: StageOutcome) -> dict[str, Any]:
    from vines.store import versions

    return {
        "result": outcome.key,
        **({"pool": prepared.pool_key} if prepared.stage.kind.shape == "points" else {}),
        "request": prepared.request,
        "kind": prepared.stage.kind.name,
        "points": outcome.wanted,
        "failed": outcome.failed,
        "ingredients": prepared.ingredients.form,
        "versions": dict(outcome.versions) or versions(),
        "remark": outcome.remark,
    }
