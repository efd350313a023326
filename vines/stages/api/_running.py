"""Running pipelines and saying where they stand."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from vines.errors import EngineError, PackageMissingError, StoreError, VinesError, is_of_the_machine
from vines.pipeline import available, code_digests, plan
from vines.stages.api._home import Home, current
from vines.stages.api._parts import Part, load_parts, members_of

if TYPE_CHECKING:
    from vines.pipeline import CodeDigests, Declaration, Event, RunSummary, StageOutcome, StagePlan
    from vines.store import Store

__all__ = ["estimate", "list_pipelines", "run", "status", "status_of_each"]


def run(
    name: str | Declaration,
    *,
    stages: Iterable[str] | None = None,
    overrides: Mapping[str, Any] | None = None,
    jobs: int | None = None,
    engine: Literal["local", "dask"] = "local",
    scheduler: str | None = None,
    shard: str | None = None,
    merge: bool = False,
    force: bool = False,
    retry_failed: bool = False,
    report: Callable[[Event], None] | None = None,
    study: Home | None = None,
) -> RunSummary:
    """Compute what a pipeline still lacks, or all pipelines of a collection, one after the other.

    Parameters
    ----------
    name : str or Declaration
        Name of a pipeline or collection, the path of a declaration, or one made in Python.
    stages : iterable of str, optional
        Only these stages and those they need; of a collection only these pipelines, or ``<pipeline>.<stage>``.
    overrides : mapping, optional
        Values by dotted key that replace those of the file, such as ``{"stages.up.vary.A.count": 801}``; in a
        collection the name of the pipeline stands first, ``{"fig3.params.r": 0.6}``.
    jobs : int, optional
        Number of processes; all cores if left out, one where the work is too small to pay for more.
    engine : {"local", "dask"}
        Processes of this machine, or a dask cluster.
    scheduler : str, optional
        Address of a dask scheduler, such as ``tcp://node1:8786``; without one dask gets a cluster of its own here.
    shard : str, optional
        ``"i/n"``: compute the i-th of n shares of the points, put no result together. Shards may run at the same time.
    merge : bool
        Put results together from what shards computed; compute no point.
    force : bool
        Compute everything again.
    retry_failed : bool
        Try the points again that failed.
    report : callable, optional
        Gets an event for everything that happens.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    RunSummary
        Stage by stage what was there and what was computed; in a collection stages are ``<pipeline>.<stage>``.

    Raises
    ------
    DeclarationError, ParameterError, StateError, UnknownNameError
        Before anything is computed or written.
    RunFailed
        After the run, if points or stages failed; the rest is stored.
    PackageMissingError
        If dask is asked for and not installed.
    EngineError
        If the scheduler of dask does not answer any more; what was computed is stored.
    """
    study = study or current()
    parts = load_parts(name, stages, overrides, study=study)
    from vines.pipeline import RunSummary, Shard

    asked: dict[str, Any] = {
        "jobs": jobs,
        "engine": engine,
        "scheduler": scheduler,
        "shard": Shard.read(shard) if shard is not None else None,
        "merge": merge,
        "force": force,
        "retry_failed": retry_failed,
    }
    outcomes = [outcome for part in parts for outcome in _run_part(part, asked, report, study.store)]
    label = next((part.collection or part.pipeline.name for part in parts), str(name))
    summary = RunSummary(label, tuple(outcomes))
    summary.check()
    return summary


def _run_part(
    part: Part, asked: dict[str, Any], report: Callable[[Event], None] | None, store: Store
) -> Iterable[StageOutcome]:
    """Run one pipeline. In a collection an error of one, such as a damaged result, is an outcome: the others go on."""
    from vines.pipeline import Event, Journal, StageOutcome, run_pipeline, silent

    tell = report or silent

    def told(event: Event) -> None:
        tell(replace(event, stage=part.prefix + event.stage) if event.stage else event)

    name = part.pipeline.name
    try:
        with Journal(store.logs, name, {"stages": part.stages, **asked, "set": part.overrides}, told) as journal:
            summary = run_pipeline(part.pipeline, store, stages=part.stages, **asked, report=journal)
    except (EngineError, PackageMissingError):
        raise
    except VinesError as error:
        if not part.collection:
            raise
        tell(Event("failed", name, text=str(error)))
        return [StageOutcome(name, "failed", reason=str(error))]
    except OSError as error:
        if not is_of_the_machine(error):
            raise
        what = f"{error.filename or store.data}: {error.strerror}"
        raise StoreError(f"{what}; once that is mended, the next run goes on from what is finished") from error
    return [replace(outcome, name=part.prefix + outcome.name) for outcome in summary.stages]


def list_pipelines(*, study: Home | None = None) -> list[dict[str, Any]]:
    """Return name, title, source and number of stages of the pipelines of the project and of those that ship.

    A collection has no stages, and its pipelines under ``pipelines``.
    """
    from vines.pipeline import with_included

    rows = []
    for name, path in available((study or current()).root).items():
        try:
            form = with_included(path)
        except VinesError as error:
            rows.append({"name": name, "title": f"cannot be read: {error}", "source": "", "stages": 0, "pipelines": []})
            continue
        stages = form.get("stages")
        rows.append(
            {
                "name": name,
                "title": str(form.get("title", "")),
                "source": str(form.get("source", "")),
                "stages": len(stages) if isinstance(stages, dict) else 0,
                "pipelines": list(form.get("pipelines", [])),
            }
        )
    return rows


def status(
    name: str | Declaration,
    *,
    stages: Iterable[str] | None = None,
    overrides: Mapping[str, Any] | None = None,
    study: Home | None = None,
) -> list[StagePlan]:
    """Return where each stage of a pipeline stands, with the reason why it is stale.

    In a collection stages are ``<pipeline>.<stage>``; points that two pipelines share are wanted by both.
    """
    study = study or current()
    return _plans(load_parts(name, stages, overrides, study=study), study.store, code_digests(study.store))


def estimate(
    name: str | Declaration,
    *,
    stages: Iterable[str] | None = None,
    overrides: Mapping[str, Any] | None = None,
    jobs: int | None = None,
    force: bool = False,
    retry_failed: bool = False,
    study: Home | None = None,
) -> dict[str, float]:
    """Return how many seconds the points would take that :func:`run` would compute with the same arguments, by stage.

    Some points of each stage are computed for it and not kept. Stages that are not made of points are left out.
    """
    from vines.pipeline import estimate as estimate_points

    study = study or current()
    asked: dict[str, Any] = {"jobs": jobs, "force": force, "retry_failed": retry_failed}
    return {
        part.prefix + stage: seconds
        for part in load_parts(name, stages, overrides, study=study)
        for stage, seconds in estimate_points(part.pipeline, study.store, part.stages, **asked).items()
    }


def status_of_each(*names: str, study: Home | None = None) -> tuple[dict[str, list[StagePlan]], dict[str, str]]:
    """Return where the stages of several pipelines stand; the sources of their kinds are looked at once for all.

    Parameters
    ----------
    *names : str
        Pipelines, and collections for those in them; all pipelines there are if none is named.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    plans : dict of str to list of StagePlan
        By name of the pipeline.
    unreadable : dict of str to str
        Why the others cannot be read.

    Raises
    ------
    VinesError
        If a named pipeline itself cannot be read.
    """
    study = study or current()
    store = study.store
    if names:
        wanted = [str(each) for name in names for each in members_of(name, study=study)]
    else:
        wanted = [r["name"] for r in list_pipelines(study=study) if not r["pipelines"]]
    code = code_digests(store)
    plans: dict[str, list[StagePlan]] = {}
    unreadable: dict[str, str] = {}
    for each in dict.fromkeys(wanted):
        try:
            plans[each] = _plans(load_parts(each, study=study), store, code)
        except VinesError as error:
            if each in names:
                raise
            unreadable[each] = str(error)
    return plans, unreadable


def _plans(parts: Iterable[Part], store: Store, code: CodeDigests) -> list[StagePlan]:
    return [
        replace(each, name=part.prefix + each.name)
        for part in parts
        for each in plan(part.pipeline, store, part.stages, code=code)
    ]
