"""Running pipelines and saying where they stand."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from vines.errors import VinesError
from vines.pipeline import available, find, kind, load, plan
from vines.places import data_folder, find_root
from vines.stages._kinds import register_kinds
from vines.stages._sense import check_name, check_stages
from vines.store import Store

if TYPE_CHECKING:
    from vines.pipeline import Declaration, Event, Pipeline, RunSummary, StagePlan

__all__ = ["compile_if_cold", "list_pipelines", "load_pipeline", "open_store", "run", "status", "warm_up"]


def open_store() -> Store:
    """Return the store of the project that the current folder belongs to (see :func:`vines.places.data_folder`)."""
    return Store(data_folder())


def load_pipeline(name: str | Declaration, overrides: Mapping[str, Any] | None = None) -> Pipeline:
    """Read the declaration of a pipeline, by name, by the path of its file, or as it was made in Python.

    Raises
    ------
    UnknownNameError, FileMissingError, DeclarationError, ParameterError, StateError
        One line each: no such pipeline or file, or what is wrong in it.
    """
    register_kinds()
    root = find_root()
    if isinstance(name, str):
        path = find(name, root)
        check_name(path, root)
        pipeline = load(path, overrides, root=root)
    else:
        pipeline = name.load(overrides, root=root)
    check_stages(pipeline)
    return pipeline


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
) -> RunSummary:
    """Compute what a pipeline still lacks.

    Parameters
    ----------
    name : str or Declaration
        Name of a pipeline, the path of a declaration, or one made in Python.
    stages : iterable of str, optional
        Only these stages and those they need.
    overrides : mapping, optional
        Values by dotted key that replace those of the file, such as ``{"stages.up.vary.A.count": 801}``.
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

    Returns
    -------
    RunSummary
        Stage by stage what was there and what was computed.

    Raises
    ------
    DeclarationError, ParameterError, StateError, UnknownNameError
        Before anything is computed or written.
    RunFailed
        After the run, if points or stages failed; the rest is stored.
    EngineError
        If dask is not installed, or its scheduler does not answer any more; what was computed is stored.
    """
    pipeline = load_pipeline(name, overrides)
    from vines.pipeline import Journal, Shard, run_pipeline, silent

    store = open_store()
    asked: dict[str, Any] = {
        "stages": tuple(stages) if stages is not None else None,
        "jobs": jobs,
        "engine": engine,
        "scheduler": scheduler,
        "shard": Shard.read(shard) if shard is not None else None,
        "merge": merge,
        "force": force,
        "retry_failed": retry_failed,
    }
    with Journal(store.logs, pipeline.name, {**asked, "set": overrides}, report or silent) as journal:
        summary = run_pipeline(pipeline, store, **asked, report=journal)
    summary.check()
    return summary


def list_pipelines() -> list[dict[str, Any]]:
    """Return name, title, source and number of stages of the pipelines of the project and of those that ship."""
    from vines.pipeline import with_included

    rows = []
    for name, path in available(find_root()).items():
        try:
            form = with_included(path)
        except VinesError as error:
            rows.append({"name": name, "title": f"cannot be read: {error}", "source": "", "stages": 0})
            continue
        stages = form.get("stages")
        rows.append(
            {
                "name": name,
                "title": str(form.get("title", "")),
                "source": str(form.get("source", "")),
                "stages": len(stages) if isinstance(stages, dict) else 0,
            }
        )
    return rows


def status(
    name: str | Declaration, *, stages: Iterable[str] | None = None, overrides: Mapping[str, Any] | None = None
) -> list[StagePlan]:
    """Return where each stage of a pipeline stands, with the reason why it is stale."""
    return plan(load_pipeline(name, overrides), open_store(), stages)


def warm_up(report: Callable[[str], object] = print) -> None:
    """Compile all kernels, or load them from the cache, with one line for each group."""
    from vines import attractors, orbits

    for room in (attractors, orbits):  # the first compiles the dynamics as well
        room.warm_up(report)
    _compiled().touch()


def compile_if_cold(plans: Iterable[StagePlan], report: Callable[[str], object]) -> None:
    """Compile the kernels visibly if these plans will need them and no cache of theirs exists yet."""
    if not any(p.done < p.wanted and kind(p.kind).parameters for p in plans):
        return
    if not _compiled().is_file():
        report("compiling the kernels, once for this version of their sources:")
        warm_up(report)


def _compiled() -> Path:
    """Return the file whose presence says that a warm-up went to its end; the folder alone may hold a part."""
    from vines.dynamics import CACHE

    return CACHE / "complete"
