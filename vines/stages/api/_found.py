"""The short screen at the end of a run: what was found, where it lies, and what to type next."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.model import VI_NES, system_names, with_one_ball
from vines.schema import system_table
from vines.schema import table as declared
from vines.stages.api._home import Home, current
from vines.stages.api._parts import load_parts
from vines.store import PICTURES, read_sealed, show_pictures, write_sealed

if TYPE_CHECKING:
    import pyarrow as pa

    from vines.pipeline import Pipeline
    from vines.stages.api._parts import Part
    from vines.store import Result, Store

__all__ = ["MOST_ABREAST", "found"]


MOST = 6
"""Bifurcations of a stage that the screen lists before it only counts them."""


def found(name: str, *, study: Home | None = None) -> list[str]:
    """Return the lines of the screen.

    What was found is read from the result tables once and kept in the cache, under a name made of the keys of the
    results, so that a run with nothing to do stays quick.
    """
    study = study or current()
    store = study.store
    parts = load_parts(name, study=study)
    if parts[0].collection:
        return _of_all(store, parts)
    pipeline = parts[0].pipeline.name
    results = _results(store, parts[0].pipeline)
    if not results:
        return []
    parts = {
        "Found": [f"  {line}" for line in _cached(store, pipeline, results)],
        "Files": list(_files(store, pipeline, results)),
        "Next": [_step(command, what) for command, what in _next(pipeline, results)],
    }
    return [line for head, lines in parts.items() if lines for line in ("", head, *lines)][1:]


def _results(store: Store, declared: Pipeline) -> dict[str, Result]:
    pins = store.pins(declared.name)
    return {
        stage: store.result(pins[stage]["result"])
        for stage in declared.stages
        if stage in pins and store.has(pins[stage]["result"])
    }


def _of_all(store: Store, parts: list[Part]) -> list[str]:
    """Return what a collection has: its pictures, and how many of the published values are reproduced."""
    results = {part.pipeline.name: _results(store, part.pipeline) for part in parts}
    lines = [line for name, each in results.items() for line in _pictures(store, name, each)]
    lines = ["Files", *lines, ""] if lines else []
    together = {f"{name}.{stage}": result for name, found in results.items() for stage, result in found.items()}
    checked = _verdicts(together)
    if checked:
        lines = ["Found", f"  {checked}", "", *lines, "Next"]
        lines.append(_step(f"vines check {parts[0].collection}", "compare with the published values"))
    return lines


def _step(command: str, what: str) -> str:
    return f"  {command:68s} {what}" if len(command) <= 68 else f"  {command}\n  {'':68s} {what}"


def _cached(store: Store, pipeline: str, results: dict[str, Result]) -> list[str]:
    source = {"results": {stage: r.key for stage, r in results.items()}, "text": Path(__file__).read_text("utf-8")}
    identity = hashlib.sha256(json.dumps(source).encode()).hexdigest()[:20]
    file = store.cache / "found" / f"{pipeline}-{identity}.json"
    text = read_sealed(file)
    if text is not None:
        return json.loads(text)
    lines = list(_findings(results))
    with contextlib.suppress(OSError):  # what may only be read is read again
        write_sealed(file, json.dumps(lines))
    return lines


def _findings(results: dict[str, Result]) -> Iterable[str]:
    for stage, result in results.items():
        if "atlas" in result.tables:
            yield f"{_atlas(result.table('atlas').to_pylist())}  ({stage})"
        elif bifurcations := _named(result, "bifurcations"):
            rows = result.table(bifurcations).to_pylist()
            for row in rows[:MOST]:
                what = row["type"].replace("_", " ")
                yield f"{what} at {row['parameter']} = {row['value']:.6g} on the {row['name']} orbit  ({stage})"
            if len(rows) > MOST:
                yield f"and {len(rows) - MOST} more bifurcations and events: vines query 'select * from {bifurcations}'"
        if curves := _named(result, "curves"):
            yield from (f"{line}  ({stage})" for line in _curves(result.table(curves).to_pylist()))
        if "reconstructions" in result.tables:
            rows = [row for row in result.table("reconstructions").to_pylist() if row["protocol"] != "ringdown"]
            accepted = sum(bool(row["accepted"]) for row in rows)
            failed = sum(row["status"] == "failed" for row in rows)
            lost = f", {failed} cannot be used (reasons in reconstructions)" if failed else ""
            yield f"{len(rows)} runs of a rig, {accepted} of them pass every gate and check{lost}  ({stage})"
        if "comparisons" in result.tables:
            yield from (f"{line}  ({stage})" for line in _compared(result.table("comparisons").to_pylist()))
        if points := _named(result, "points"):
            yield f"{_attractors(result.table(points), _symbols(result))}  ({stage})"
    checked = _verdicts(results)
    if checked:
        yield checked


def _named(result: Result, base: str) -> str:
    """Return what a table is called in a result, of whichever system; empty if it has none."""
    return next((name for name in result.tables if name in {system_table(each, base) for each in system_names()}), "")


def _symbols(result: Result) -> list[str]:
    """Return the parameters that a reader tells runs of a system apart by: those that have no default."""
    points = _named(result, "points")
    system = next(name for name in system_names() if system_table(name, "points") == points)
    if system == VI_NES.name:
        return ["mu", "A", "Omega"]
    return [each.name for each in with_one_ball(system).parameters if each.default is None]


def _verdicts(results: dict[str, Result]) -> str:
    """Return how many published values are reproduced; empty if none were checked."""
    verdicts = Counter(
        row["verdict"] for r in results.values() if "checks" in r.tables for row in r.table("checks").to_pylist()
    )
    return f"{verdicts['reproduced']} of {sum(verdicts.values())} published values reproduced" if verdicts else ""


def _compared(rows: list[dict[str, Any]]) -> Iterable[str]:
    """Yield the verdicts on the runs of a rig, at measured and at calibrated parameters."""
    for basis in ("measured", "calibrated"):
        counts = Counter(row["verdict"] for row in rows if row["basis"] == basis and row["rank"] == 0)
        if counts:
            listed = ", ".join(f"{count} {verdict.replace('_', ' ')}" for verdict, count in sorted(counts.items()))
            yield f"rig beside the model at {basis} parameters: {listed}"


def _atlas(rows: list[dict[str, Any]]) -> str:
    """Return what an atlas found on all its lines."""
    orbits, stable, branches = (sum(row[name] or 0 for row in rows) for name in ("orbits", "stable", "branches"))
    failed = sum(row["status"] == "failed" for row in rows)
    lines = f"{len(rows)} lines" + (f", {failed} of them failed" if failed else "")
    return f"{orbits} orbits on {branches} branches, {stable} of them stable, on {lines}"


def _curves(rows: list[dict[str, Any]]) -> Iterable[str]:
    """Yield what each curve is and which special points are on it."""
    for name in dict.fromkeys(row["curve_id"] for row in rows):
        mine = [row for row in rows if row["curve_id"] == name]
        first, (one, two) = mine[0], (mine[0]["parameter_1"], mine[0]["parameter_2"])
        special = [
            f"{row['special'].replace('_', ' ')} at {one} = {row[one]:.6g}, {two} = {row[two]:.6g}"
            for row in mine
            if row["special"]
        ]
        side = "symmetric " if first["symmetric"] else ""
        points = len(mine) - len(special)
        yield f"{first['type'].replace('_', ' ')} of {side}{first['name']} in ({one}, {two}): {points} points" + (
            f", {'; '.join(special)}" if special else ""
        )


def _attractors(points: pa.Table, symbols: list[str]) -> str:
    """Return what the points of a stage settled to, the most frequent first."""
    import pyarrow.compute as pc

    failed = points.filter(pc.field("status") == "failed")
    if failed.num_rows:
        reason = failed["reason"][0].as_py()
        return f"{failed.num_rows} of {points.num_rows} points failed, the first because: {reason}"
    if points.num_rows == 1:
        return _one_attractor(points.to_pylist()[0], symbols)
    # Counted in columns: a sweep may have a million points.
    counts: Counter[str] = Counter()
    for group in points.group_by(["settled", "name", "regime", "status"]).aggregate([([], "count_all")]).to_pylist():
        counts[_kind(group)] += group["count_all"]
    listed = ", ".join(f"{count} {kind}" for kind, count in counts.most_common(6))
    return f"{points.num_rows} points: {listed}"


def _one_attractor(row: dict[str, Any], symbols: list[str]) -> str:
    side = "" if row["symmetric"] is None else ("symmetric " if row["symmetric"] else "asymmetric ")
    alias = f" (the paper's {row['alias']})" if row.get("alias") not in (None, row["name"]) else ""
    bought = "" if row.get("reduction") is None else f", max|x1| {row['reduction']:.3g} of that with no ball"
    place = ", ".join(f"{name} = {row[name]:g}" for name in symbols if row.get(name) is not None)
    return f"{side}{_kind(row)}{alias} at {place}{bought}"


def _kind(row: dict[str, Any]) -> str:
    return row["name"] if row["settled"] and row["name"] else row["regime"] or row["status"]


def _files(store: Store, pipeline: str, results: dict[str, Result]) -> Iterable[str]:
    tables = sum(len(result.tables) for result in results.values())
    logs = [path for result in results.values() for path in result.logs.values()]
    yield f"  {_short(store.data / 'results')}: {tables} Parquet tables" + (f", {len(logs)} MCAP logs" if logs else "")
    yield from _pictures(store, pipeline, results)


def _pictures(store: Store, pipeline: str, results: dict[str, Result]) -> Iterable[str]:
    """Yield a line for each figure: its copy under the name of its stage, else where it lies itself.

    A copy that lacks or was changed is made again, unless nothing can be written.
    """
    for stage, result in results.items():
        drawn = [result.folder / name for name in PICTURES if (result.folder / name).is_file()]
        if drawn:
            with contextlib.suppress(OSError):
                show_pictures(store.data, result.folder, f"{pipeline}.{stage}")
            copy = store.data / "figures" / f"{pipeline}.{stage}{drawn[0].suffix}"
            others = ", ".join(each.suffix for each in drawn[1:])
            yield f"  {_short(copy if copy.is_file() else drawn[0])}{f' (and {others})' if others else ''}"


MOST_ABREAST = 8
"""Runs that `vines view` shows together at most."""


def _next(pipeline: str, results: dict[str, Result]) -> Iterable[tuple[str, str]]:
    logged = [stage for stage, result in results.items() if result.logs]
    if logged:
        several = f" (one of {len(logged)}, also {logged[1]})" if logged[1:] else ""
        many = results[logged[0]].logs
        point = f"/{next(iter(many)).partition('/')[0]}" if len(many) > MOST_ABREAST else ""
        yield f"vines view {pipeline}.{logged[0]}{point}", f"see a run in the Rerun viewer{several}"
    for stage, result in results.items():
        beside = [name for name in result.logs if name.endswith("/measured")]
        if beside:
            run = beside[0].removesuffix("/measured")
            yield f"vines view {pipeline}.{stage}/{run} --overlay", "a measured run over the model's"
    asked = _question(pipeline, results)
    if asked:
        yield asked, "ask the tables in SQL"
    if any("comparisons" in result.tables for result in results.values()):
        yield f"vines report {pipeline}", "verdicts, calibration and figures on one page"
    if any("checks" in result.tables for result in results.values()):
        yield f"vines check {pipeline}", "compare with the published values"


def _question(pipeline: str, results: dict[str, Result]) -> str:
    """Return the query of a table that the pipeline has, over what it varies; empty if it has no points or orbits."""
    axes = {stage: [axis[0] for axis in result.manifest["ingredients"]["vary"]] for stage, result in results.items()}
    for base, wanted in (("points", ("name", "reduction", "impact_power")), ("orbits", ("name", "stable"))):
        for stage in sorted((each for each in results if _named(results[each], base)), key=lambda each: not axes[each]):
            table = _named(results[stage], base)
            there = [column.name for column in declared(table).columns]
            columns = ", ".join([*axes[stage][:1], *[each for each in wanted if each in there][:2]])
            ordered = f" order by {axes[stage][0]}" if axes[stage] else ""
            return f"vines query \"select {columns} from {table} where pipeline = '{pipeline}'{ordered}\""
    return ""


def _short(path: Path) -> str:
    """Return a path as seen from the current folder where that is shorter."""
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)
