"""What a report tells of a pipeline, or a collection of them, and the file that it becomes."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

from vines.errors import DamageWarning, FileMissingError, UnknownNameError, nearest
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
        The file; ``data/reports/<name>.html`` if left out. An existing one is replaced. What is pinned and damaged or
        gone is named on it, and by a `DamageWarning`.
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
    sections = [
        _section(store, pipeline, pinned.get(pipeline, {}), damaged.get(pipeline, ""), files, path.parent)
        for pipeline in pipelines
    ]
    write_text(path, page(name, title, source, sections))
    for missing in (each for section in sections for each in section.missing):
        warnings.warn(f"{missing}; the page is without it", DamageWarning, stacklevel=2)
    return path


def _declared(name: str, files: dict[str, Path]) -> tuple[str, str]:
    form = with_included(files[name]) if name in files else {}
    return str(form.get("title", "")), str(form.get("source", ""))


def _section(
    store: Store, pipeline: str, pins: Mapping[str, Any], damage: str, files: dict[str, Path], folder: Path
) -> Section:
    order = [stage for stage in _stages(pipeline, files) if stage in pins]
    stages = [*order, *(stage for stage in sorted(pins) if stage not in order)]
    problems = {stage: store.problem(pins[stage]["result"]) for stage in stages}
    results = {stage: store.result(pins[stage]["result"]) for stage in stages if not problems[stage]}
    missing = [
        f"{pipeline}.{stage}: result {pins[stage]['result'][:12]}: {problem}; 'vines run {pipeline}' mends it"
        for stage, problem in problems.items()
        if problem
    ]
    title, source = _declared(pipeline, files)
    told = [damage, *missing] if damage else missing
    return section_of(pipeline, title, source, results, folder, _seconds(store, pipeline), told)


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
