"""Running pipelines and saying where they stand."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from vines.pipeline import available, find, kind, load, plan
from vines.places import data_folder, find_root
from vines.stages._kinds import register_kinds
from vines.store import Store

if TYPE_CHECKING:
    from vines.pipeline import Event, Pipeline, RunSummary, StagePlan

__all__ = ["compile_if_cold", "list_pipelines", "load_pipeline", "open_store", "run", "status", "warm_up"]


def open_store() -> Store:
    """Return the store of the project that the current folder belongs to (see :func:`vines.places.data_folder`)."""
    return Store(data_folder())


def load_pipeline(name: str, overrides: Mapping[str, Any] | None = None) -> Pipeline:
    """Read the declaration of a pipeline, by name or by the path of its file.

    Raises
    ------
    UnknownNameError, FileMissingError, DeclarationError, ParameterError, StateError
        One line each: no such pipeline or file, or what is wrong in it.
    """
    register_kinds()
    root = find_root()
    return load(find(name, root), overrides, root=root)


def run(
    name: str,
    *,
    stages: Iterable[str] | None = None,
    overrides: Mapping[str, Any] | None = None,
    jobs: int | None = None,
    force: bool = False,
    retry_failed: bool = False,
    report: Callable[[Event], None] | None = None,
) -> RunSummary:
    """Compute what a pipeline still lacks.

    Parameters
    ----------
    name : str
        Name of a pipeline, or the path of a declaration.
    stages : iterable of str, optional
        Only these stages and those they need.
    overrides : mapping, optional
        Values by dotted key that replace those of the file, such as ``{"stages.up.vary.A.count": 801}``.
    jobs : int, optional
        Number of processes; all cores if left out, one where the work is too small to pay for more.
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
    """
    pipeline = load_pipeline(name, overrides)
    from vines.pipeline import run_pipeline, silent

    summary = run_pipeline(
        pipeline,
        open_store(),
        stages=stages,
        jobs=jobs,
        force=force,
        retry_failed=retry_failed,
        report=report or silent,
    )
    summary.check()
    return summary


def list_pipelines() -> list[dict[str, Any]]:
    """Return name, title, source and number of stages of the pipelines of the project and of those that ship."""
    import tomllib

    rows = []
    for name, path in available(find_root()).items():
        try:
            form = tomllib.loads(path.read_text("utf-8"))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
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
    name: str, *, stages: Iterable[str] | None = None, overrides: Mapping[str, Any] | None = None
) -> list[StagePlan]:
    """Return where each stage of a pipeline stands, with the reason why it is stale."""
    return plan(load_pipeline(name, overrides), open_store(), stages)


def warm_up(report: Callable[[str], object] = print) -> None:
    """Compile all kernels, or load them from the cache, with one line for each group."""
    from vines import attractors, orbits

    for room in (attractors, orbits):  # the first compiles the dynamics as well
        room.warm_up(report)


def compile_if_cold(plans: Iterable[StagePlan], report: Callable[[str], object]) -> None:
    """Compile the kernels visibly if these plans will need them and no cache of theirs exists yet."""
    if not any(p.state != "up_to_date" and kind(p.kind).parameters for p in plans):
        return
    from vines.dynamics import CACHE

    if not CACHE.is_dir():
        report("compiling the kernels, once for this version of their sources:")
        warm_up(report)
