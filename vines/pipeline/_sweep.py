"""Stages of the points shape: compute the points that the pool does not have, and put the result together."""

from __future__ import annotations

import os
import shutil
from collections import deque
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines import schema
from vines.pipeline._engine import compute_all, cores
from vines.pipeline._events import Event, Report
from vines.pipeline._plan import Prepared
from vines.pipeline._work import Chunk, Work
from vines.pipeline._worker import Done, Task
from vines.store import Store, describe_table, write_parquet

if TYPE_CHECKING:
    from vines.store import Pool

__all__ = ["compute_points", "put_together"]


def compute_points(
    prepared: Prepared, store: Store, *, jobs: int | None, force: bool, retry_failed: bool, report: Report
) -> int:
    """Compute the points of a stage that are not in its pool and return how many that were.

    Parameters
    ----------
    prepared : Prepared
        The stage.
    store : Store
        Where its pool is.
    jobs : int or None
        How many processes there may be; all cores if None.
    force : bool
        Compute all of them again.
    retry_failed : bool
        Compute those again that failed.
    report : callable
        Told of each chunk that is stored.
    """
    stage, grid = prepared.stage, prepared.grid
    pool = store.pool(prepared.pool_key)
    pool.describe(prepared.ingredients.form)
    there = {} if force else pool.computed()
    tried = {} if force or retry_failed else pool.failed()
    work = _work(prepared, store, pool, set(there) | set(tried), set(tried))
    total = len(grid.ids)
    new = work.left
    done_before = total - new
    failed = sum(point in tried for point in grid.ids)
    numbers = iter(range(pool.next_number(), 10**8))
    provenance = prepared.ingredients.provenance(prepared.pool_key)

    def make(chunk: Chunk) -> Task:
        return Task(
            number=next(numbers),
            body=stage.kind.body,
            tables=stage.kind.tables,
            options=stage.options,
            provenance=provenance,
            points=tuple(grid.point(i) for i in chunk.places),
            carry=stage.carry.axis if stage.carry is not None else None,
            start=chunk.start,
            broken="a point before it in the carried chain failed" if chunk.broken else "",
            data=store.data,
            pool=pool.folder,
        )

    count = {"done": done_before, "failed": failed}

    def stored(done: Done, processes: int) -> None:
        count["done"] += done.points
        count["failed"] += len(done.failed)
        report(Event("progress", stage.name, total, count["done"], count["failed"], processes))

    compute_all(work, make, stored, max(1, jobs if jobs is not None else cores()))
    return new


def put_together(prepared: Prepared, store: Store, *, replace: bool) -> tuple[str, int]:
    """Make the result of a stage from its pool; return its key and how many of its points failed.

    The rows are sorted by the values of the axes, so that the bytes don't depend on who computed which point when.

    Parameters
    ----------
    prepared : Prepared
        The stage; all its points are in the pool.
    store : Store
        Where it goes.
    replace : bool
        Whether to replace a result of the same key.
    """
    stage, grid = prepared.stage, prepared.grid
    pool = store.pool(prepared.pool_key)
    holders = {**pool.failed(), **pool.computed()}
    computed = pool.computed()
    failed = [point for point in grid.ids if point not in computed]
    key = prepared.result_key(failed)
    if store.has(key) and not replace:
        return key, len(failed)
    provenance = prepared.ingredients.provenance(key)
    with store.staging() as place:
        folder = place / "result"
        folder.mkdir()
        about = {}
        names: dict[str, Any] = {}
        for name in stage.kind.tables:
            rows = pool.gather(name, grid.ids)
            sorted_by = _sorted_by(prepared, name)
            count = write_parquet(folder / f"{name}.parquet", name, rows, provenance=provenance, sorted_by=sorted_by)
            about[name] = describe_table(name, count)
            if stage.kind.logs and not names and "name" in rows.column_names:
                ids = rows.column("point_id").to_pylist()
                names = dict(zip(ids, rows.column("name").to_pylist(), strict=True))
        logs = []
        for i, point in enumerate(grid.ids):
            log = holders[point].logs.get(point)
            if log is not None:
                _link(holders[point].folder / log, folder / "logs" / log)
                params = grid.point(i).params
                logs.append({"point_id": point, "file": f"logs/{log}", "params": params, "name": names.get(point)})
        manifest = {
            "kind": stage.kind.name,
            "ingredients": prepared.ingredients.form,
            "provenance": provenance,
            "pool": prepared.pool_key,
            "points": len(grid.ids),
            "failed": len(failed),
            "tables": about,
            "logs": logs,
        }
        store.commit(key, folder, manifest, replace=replace)
    return key, len(failed)


def _work(prepared: Prepared, store: Store, pool: Pool, there: set[str], failed: set[str]) -> Work:
    grid = prepared.grid
    if prepared.stage.carry is None:
        return Work(free=deque(i for i, point in enumerate(grid.ids) if point not in there))
    work = Work()
    primary = prepared.stage.kind.tables[0]
    origin = partial(_origin_row, prepared, store, primary)
    for chain in grid.chains:
        segment: list[int] = []
        before: int | None = None
        start: int | None = None
        for i in chain:
            if grid.ids[i] not in there:
                if not segment:
                    start = before
                segment.append(i)
            elif segment:
                _add(work, segment, start, grid.ids, pool, primary, origin, failed)
                segment = []
            before = i
        if segment:
            _add(work, segment, start, grid.ids, pool, primary, origin, failed)
    return work


def _add(
    work: Work,
    segment: list[int],
    start: int | None,
    ids: list[str],
    pool: Pool,
    primary: str,
    origin: Any,
    failed: set[str],
) -> None:
    if start is None:
        work.add_chain(segment, origin, broken=False)
    else:
        work.add_chain(segment, partial(pool.row, primary, ids[start]), broken=ids[start] in failed)


def _origin_row(prepared: Prepared, store: Store, primary: str) -> dict[str, Any] | None:
    if not prepared.origin:
        return None
    key, _, point = prepared.origin.partition("/")
    return store.pool(key).row(primary, point)


def _sorted_by(prepared: Prepared, name: str) -> list[str]:
    columns = schema.table(name).names
    found: list[str] = []
    for axis in prepared.stage.axes:
        if axis.name not in columns:
            break
        found.append(axis.name)
    return found


def _link(source: Path, target: Path) -> None:
    """Put a file into a second folder without a second copy of its bytes, where the file system can."""
    target.parent.mkdir(exist_ok=True)
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)
