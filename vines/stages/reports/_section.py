"""What a report tells of the stages of one pipeline, from their stored results."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from vines import schema
from vines.stages.reports._page import Figure, Head, Run, Section, StageFacts
from vines.store import Result, canonical

__all__ = ["section_of"]

_FEW = 10
_ALL = ("checks", "bifurcations", "branches", "comparisons", "optima", "reconstructions")
_MOST = 200
"""Rows that are shown of a table: few, but of tables that are read line by line up to this many."""


def section_of(
    pipeline: str,
    title: str,
    source: str,
    results: Mapping[str, Result],
    folder: Path,
    seconds: Mapping[str, float] | None = None,
    missing: Sequence[str] = (),
) -> Section:
    """Return what a page tells of a pipeline.

    Parameters
    ----------
    pipeline, title, source : str
        Its name, and what its declaration says of it.
    results : mapping of str to Result
        Results by stage.
    folder : Path
        Where the page will lie, for links to logs.
    seconds : mapping of str to float, optional
        How long stages took. If left out, nothing is told that a clock says, so that the page of the same results
        is the same.
    missing : sequence of str
        What the page is without, and why.
    """
    clock, took = seconds is not None, seconds or {}
    return Section(
        name=pipeline,
        title=title,
        source=source,
        figures=[figure for stage, r in results.items() for figure in _figures(f"{pipeline}.{stage}", r, title)],
        checks=_rows(results, "checks"),
        comparisons=_rows(results, "comparisons"),
        runs=[run for stage, result in results.items() for run in _runs(f"{pipeline}.{stage}", result, folder)],
        tables=[head for stage, result in results.items() for head in _heads(f"{pipeline}.{stage}", result)],
        stages=[_facts(stage, result, took.get(stage), clock) for stage, result in results.items()],
        missing=missing,
    )


def _rows(results: Mapping[str, Result], table: str) -> list[dict[str, Any]]:
    return [row for result in results.values() if table in result.tables for row in result.table(table).to_pylist()]


def _figures(where: str, result: Result, title: str) -> Iterator[Figure]:
    """Yield the picture of a stage: what can be enlarged without loss if it is there, a PDF by its name only."""
    for ending in ("svg", "png", "pdf"):
        path = result.folder / f"picture.{ending}"
        if path.is_file():
            own = result.manifest["ingredients"]["options"].get("title")
            yield Figure(where, own or title or where, path.read_bytes(), ending)
            return


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


def _facts(stage: str, result: Result, seconds: float | None, clock: bool) -> StageFacts:
    manifest = result.manifest
    told: dict[str, Any] = manifest["provenance"]
    provenance = {"key": result.key, "code": told["code"], "revision": told["revision"] or "no checkout"}
    provenance["versions"] = ", ".join(f"{name} {version}" for name, version in told["versions"].items())
    for name in ("params", "options", "vary", "inputs"):
        if told.get(name):
            provenance[name] = canonical(told[name])
    if clock:
        provenance["written"] = str(manifest.get("written", ""))
    size = sum(about["bytes"] for about in manifest["files"].values())
    return StageFacts(stage, manifest["kind"], manifest["points"], manifest["failed"], size, seconds, provenance)
