"""What a report tells of a pipeline, or a collection of them, and the file that it becomes."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

from vines.errors import FileMissingError, UnknownNameError, nearest
from vines.pipeline import available, with_included
from vines.stages.api._home import Home, current
from vines.stages.api._stored import stored_pipelines
from vines.stages.reports._page import Section, page
from vines.stages.reports._section import section_of
from vines.store import Store, write_text

__all__ = ["report"]


def report(name: str, out: Path | None = None, *, study: Home | None = None) -> Path:
    """Write one self-contained HTML page about a pipeline or a collection: figures, checks, tables, runs, provenance.

    Parameters
    ----------
    name : str
        The pipeline or collection. Of a collection, members that were never run are left out.
    out : Path, optional
        The file; ``data/reports/<name>.html`` if left out. An existing one is replaced.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    UnknownNameError
        If there is no such pipeline, or nothing of it is stored.
    FileMissingError
        If the folder of `out` does not exist.
    """
    study = study or current()
    store = study.store
    files = available(study.root)
    pinned, damaged = store.readable_pins()
    known = {*pinned, *damaged}
    if name not in files and name not in known:
        raise UnknownNameError(f"unknown pipeline {name!r}: {nearest(name, {*files, *known})}")
    pipelines = stored_pipelines([name], known, study.root)
    path = (out or store.data / "reports" / f"{name}.html").absolute()
    if out is not None and not path.parent.is_dir():
        raise FileMissingError(f"{out}: the folder {path.parent} does not exist; make it first")
    title, source = _declared(name, files)
    sections = [_section(store, pipeline, files, path.parent) for pipeline in pipelines]
    write_text(path, page(name, title, source, sections))
    return path


def _declared(name: str, files: dict[str, Path]) -> tuple[str, str]:
    form = with_included(files[name]) if name in files else {}
    return str(form.get("title", "")), str(form.get("source", ""))


def _section(store: Store, pipeline: str, files: dict[str, Path], folder: Path) -> Section:
    pins = store.pins(pipeline)
    order = [stage for stage in _stages(pipeline, files) if stage in pins]
    stages = [*order, *(stage for stage in sorted(pins) if stage not in order)]
    results = {stage: store.result(pins[stage]["result"]) for stage in stages if store.has(pins[stage]["result"])}
    title, source = _declared(pipeline, files)
    return section_of(pipeline, title, source, results, folder, _seconds(store, pipeline))


def _stages(pipeline: str, files: dict[str, Path]) -> list[str]:
    stages = with_included(files[pipeline]).get("stages", {}) if pipeline in files else {}
    return list(stages) if isinstance(stages, dict) else []


def _seconds(store: Store, pipeline: str) -> dict[str, float]:
    """Return how long each stage took when it was last computed to its end, as the log files of the runs tell."""
    found: dict[str, float] = {}
    for path in sorted(store.logs.glob(f"*-{pipeline}-*.log")):
        began: dict[str, datetime] = {}
        for line in path.read_text("utf-8", errors="replace").splitlines():
            stamp, _, said = line.partition(" ")
            stage, _, event = said.partition(": ")
            if not event.startswith(("started", "done")):
                continue
            try:
                at = datetime.fromisoformat(stamp)
            except ValueError:
                continue
            if event.startswith("started"):
                began[stage] = at
            elif stage in began:
                found[stage] = (at - began[stage]).total_seconds()
    return found
