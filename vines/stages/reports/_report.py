"""What a report tells of a pipeline, or a collection of them, and the file that it becomes."""

from __future__ import annotations

import os
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

from vines import schema
from vines.errors import FileMissingError, UnknownNameError, nearest
from vines.pipeline import available, with_included
from vines.stages.api._home import Home, current
from vines.stages.api._stored import stored_pipelines
from vines.stages.reports._page import Figure, Head, Run, Section, StageFacts, page
from vines.store import Result, Store, canonical, write_text

__all__ = ["report"]

_FEW = 10
_ALL = ("checks", "bifurcations", "branches", "comparisons", "optima", "reconstructions")
_MOST = 200
"""Rows that are shown of a table: few, but of tables that are read line by line up to this many."""


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
    seconds = _seconds(store, pipeline)
    title, source = _declared(pipeline, files)
    checks = [row for r in results.values() if "checks" in r.tables for row in r.table("checks").to_pylist()]
    return Section(
        name=pipeline,
        title=title,
        source=source,
        figures=[figure for stage, r in results.items() for figure in _figures(f"{pipeline}.{stage}", r, title)],
        checks=checks,
        comparisons=[
            row for r in results.values() if "comparisons" in r.tables for row in r.table("comparisons").to_pylist()
        ],
        runs=[run for stage, result in results.items() for run in _runs(f"{pipeline}.{stage}", result, folder)],
        tables=[head for stage, result in results.items() for head in _heads(f"{pipeline}.{stage}", result)],
        stages=[_facts(stage, result, seconds.get(stage)) for stage, result in results.items()],
    )


def _stages(pipeline: str, files: dict[str, Path]) -> list[str]:
    stages = with_included(files[pipeline]).get("stages", {}) if pipeline in files else {}
    return list(stages) if isinstance(stages, dict) else []


def _figures(where: str, result: Result, title: str) -> Iterator[Figure]:
    path = result.folder / "picture.svg"
    if path.is_file():
        own = result.manifest["ingredients"]["options"].get("title")
        yield Figure(where, own or title or where, path.read_bytes())


def _runs(where: str, result: Result, folder: Path) -> Iterator[Run]:
    logs = result.manifest["logs"]
    for log in logs:
        params = ", ".join(f"{name} = {value:g}" for name, value in log["params"].items() if name != "lam")
        called = where if len(logs) == 1 else f"{where}/{log['point_id']}"
        told = f"{log['name'] or 'run'} at {params}" if params else str(log["name"] or "")
        link = Path(os.path.relpath(result.folder / log["file"], folder)).as_posix()
        yield Run(called, told, link)


def _heads(where: str, result: Result) -> Iterator[Head]:
    import pyarrow as pa
    import pyarrow.parquet as pq

    for number, (name, about) in enumerate(result.manifest["tables"].items()):
        view = where if number == 0 else f"{where}.{name}"
        if not about["rows"] or name == "checks":
            continue
        most = _MOST if name in _ALL else _FEW
        with pq.ParquetFile(result.folder / f"{name}.parquet") as file:
            first: Any = pa.Table.from_batches([next(file.iter_batches(batch_size=most))])
        columns = [c for c in schema.table(name).names if c in first.column_names]
        told = [c for c in columns if c != "point_id" and first.column(c).null_count < first.num_rows]
        rows = list(zip(*(first.column(c).to_pylist() for c in told), strict=True))
        yield Head(view, name, about["rows"], told, rows)


def _facts(stage: str, result: Result, seconds: float | None) -> StageFacts:
    manifest = result.manifest
    told: dict[str, Any] = manifest["provenance"]
    provenance = {"key": result.key, "code": told["code"], "revision": told["revision"] or "no checkout"}
    provenance["versions"] = ", ".join(f"{name} {version}" for name, version in told["versions"].items())
    for name in ("params", "options", "vary", "inputs"):
        if told.get(name):
            provenance[name] = canonical(told[name])
    provenance["written"] = str(manifest.get("written", ""))
    size = sum(about["bytes"] for about in manifest["files"].values())
    return StageFacts(stage, manifest["kind"], manifest["points"], manifest["failed"], size, seconds, provenance)


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
