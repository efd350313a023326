"""Running a pipeline: plan each stage, compute what is missing, put the result together, pin it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from vines.errors import SchemaError
from vines.pipeline._declaration import Pipeline
from vines.pipeline._events import Event, Report, RunSummary, StageOutcome, silent
from vines.pipeline._plan import Planner, Prepared, StagePlan
from vines.store import Store

__all__ = ["run_pipeline"]


def run_pipeline(
    pipeline: Pipeline,
    store: Store,
    *,
    stages: Iterable[str] | None = None,
    jobs: int | None = None,
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
        If the store is damaged.
    """
    named = None if stages is None else tuple(stages)
    order = pipeline.select(named)
    planner = Planner(pipeline, store)
    plans = [planner.plan(name) for name in order]
    gone = [name for name in planner.pins if name not in pipeline.stages]
    if not (force or gone) and all(_settled(each, retry_failed) for each in plans):
        planner.code.save()
        for each in plans:
            report(_event("up_to_date", each))
        return RunSummary(pipeline.name, tuple(_kept(each) for each in plans))
    with store.writing(lambda: report(Event("waiting"))):
        # another process may have done some of it meanwhile
        run = _Run(planner.afresh(), jobs, retry_failed, report)
        forced = set(order if named is None else named) if force else set()
        for name in order:
            run.stage(name, force=name in forced)
        run.planner.code.save()
        if gone:
            store.unpin(pipeline.name, gone)
    return RunSummary(pipeline.name, tuple(run.outcomes.values()))


class _Run:
    """One run, stage by stage."""

    def __init__(self, planner: Planner, jobs: int | None, retry_failed: bool, report: Report) -> None:
        self.pipeline = planner.pipeline
        self.store = planner.store
        self.jobs = jobs
        self.retry_failed = retry_failed
        self.report = report
        self.planner = planner
        self.outcomes: dict[str, StageOutcome] = {}

    def stage(self, name: str, *, force: bool) -> None:
        """Bring one stage up to date."""
        stage = self.pipeline.stages[name]
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
        if stage.kind.shape == "whole":
            outcome = self._whole(prepared, each, force=force)
        else:
            outcome = self._points(prepared, each, force=force)
        if outcome.key:
            self.planner.set_key(name, outcome.key)
            self.store.pin(self.pipeline.name, name, _pin(prepared, outcome))
        self.outcomes[name] = outcome
        what = "failed" if outcome.state == "failed" else "done"
        self.report(Event(what, name, outcome.wanted, outcome.wanted, outcome.failed, text=outcome.reason))

    def _whole(self, prepared: Prepared, each: StagePlan, *, force: bool) -> StageOutcome:
        from vines.pipeline._whole import compute_whole

        if self.store.has(each.key) and not force:
            return StageOutcome(each.name, "computed", 1, 0, 0, each.key, each.reason)
        problem = compute_whole(prepared, self.store, self.planner, replace=force)
        if problem:
            return StageOutcome(each.name, "failed", 1, reason=problem)
        return StageOutcome(each.name, "computed", 1, 1, 0, each.key, each.reason)

    def _points(self, prepared: Prepared, each: StagePlan, *, force: bool) -> StageOutcome:
        from vines.pipeline._sweep import compute_points, put_together

        try:
            new = compute_points(
                prepared, self.store, jobs=self.jobs, force=force, retry_failed=self.retry_failed, report=self.report
            )
        except (SchemaError, ImportError) as error:  # a mistake in the kind, not in a point: the other stages go on
            reason = f"{type(error).__name__}: {error}"
            return StageOutcome(each.name, "failed", each.wanted, reason=reason)
        key, failed = put_together(prepared, self.store, replace=force)
        return StageOutcome(each.name, "computed", each.wanted, new, failed, key, each.reason)


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
        "request": prepared.request,
        "kind": prepared.stage.kind.name,
        "points": outcome.wanted,
        "failed": outcome.failed,
        "ingredients": prepared.ingredients.form,
        "versions": versions(),
    }
