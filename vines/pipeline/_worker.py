"""What a process does with a chunk of points: call the body, find the points that fail, store a part.

Runs in the main process for small work and in worker processes for more; those import nothing else of the pipeline.
"""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines import schema
from vines.errors import SchemaError, is_of_the_machine
from vines.late_pandas import load_pandas_late
from vines.pipeline._demand import Demand
from vines.pipeline._jobs import Batch, Job, Point, Points
from vines.store import Store, commit_part

if TYPE_CHECKING:
    import msgspec
    import pyarrow as pa

__all__ = ["Done", "Task", "body_of", "compute_apart", "compute_task", "one_thread", "prepare_worker"]


@dataclass(frozen=True, slots=True)
class Task:
    """A chunk of points of one stage; travels to a worker process.

    Attributes
    ----------
    number : int
        Number of the part that it will be.
    body, tables, options, provenance
        As in :class:`Kind` and :class:`Job`.
    points : Points
        The points, in the order of the chain if carried.
    carry : str or None
        The carried axis.
    start : dict or None
        Row of the predecessor.
    broken : str
        Why the points cannot be computed, because the chain broke before them; empty if they can.
    data : Path
        The folder of the store.
    pool : Path
        The folder of the pool.
    demand : Demand
        What a process has to prove before its points are stored.
    """

    number: int
    body: str
    tables: tuple[str, ...]
    options: msgspec.Struct
    provenance: dict[str, Any]
    points: Points
    carry: str | None
    start: dict[str, Any] | None
    broken: str
    data: Path
    pool: Path
    demand: Demand


@dataclass(frozen=True, slots=True)
class Done:
    """What became of a task.

    Attributes
    ----------
    number, points : int
        Number of the part, and how many points it has.
    failed : tuple of str
        Those that failed.
    seconds : float
        How long it took.
    last : dict or None
        The last row if carried and not failed.
    why : str
        Why the first of those that failed did; empty if none did.
    logs : tuple of Path
        The logs that it brought, in their place in the pool.
    """

    number: int
    points: int
    failed: tuple[str, ...]
    seconds: float
    last: dict[str, Any] | None
    why: str = ""
    logs: tuple[Path, ...] = ()


@dataclass
class _Gathered:
    """Rows of a chunk as they come in, by table."""

    tables: dict[str, list[pa.Table]]
    logs: dict[str, str] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)


def one_thread() -> None:
    """See that numba and the libraries under numpy use one thread in this process, if they are not loaded yet."""
    import os

    for name in ("NUMBA", "OMP", "OPENBLAS", "MKL"):
        os.environ[f"{name}_NUM_THREADS"] = "1"


def prepare_worker(parent: int) -> None:
    """Set up a worker process: one thread each, the parent decides when to stop, and no worker outlives it.

    Parameters
    ----------
    parent : int
        Process id of the parent.
    """
    import os
    import signal
    import threading

    one_thread()
    load_pandas_late()
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def body_of(path: str) -> Callable[[Any], Batch]:
    """Import the body of a kind, given as ``"package.module:function"``."""
    module, _, name = path.partition(":")
    return getattr(importlib.import_module(module), name)


def compute_task(task: Task) -> Done:
    """Compute a chunk and store it as a part of the pool.

    An exception of the body is narrowed down by halves to the points that cause it; each becomes a row with status
    ``failed`` and the reason. In a carried chain the points after a failed one have no start and fail with it.

    Raises
    ------
    SchemaError
        If the body returns rows that don't fit: a mistake in the kind, not in a point.
    ImportError
        If the body needs a package that is not installed here.
    CodeError
        If this process has imported other code than that of the key.
    """
    began = time.perf_counter()
    body_of(task.body)
    task.demand.check_code()
    gathered = _Gathered({name: [] for name in task.tables})
    with Store(task.data).staging() as place:
        part = place / "part"
        part.mkdir()
        if task.broken:
            _fail(task, task.points, task.broken, gathered)
        else:
            _attempt(task, task.points, task.start, part, gathered)
        task.demand.check_code()  # the body may have imported more
        import pyarrow as pa

        tables = {name: pa.concat_tables(pieces) for name, pieces in gathered.tables.items()}
        failed = gathered.failed
        kept = commit_part(
            task.pool,
            part,
            task.number,
            tables,
            ids=task.points.key,
            failed=failed,
            logs=gathered.logs,
            code=task.demand.code,
        )
    last = None
    if task.carry is not None and task.points.key.take([-1]).text() not in failed:
        last = _last_row(tables[task.tables[0]])
    why = next(iter(failed.values()), "")
    logs = tuple(kept / name for name in gathered.logs.values())
    return Done(task.number, len(task.points), tuple(failed), time.perf_counter() - began, last, why, logs)


def compute_apart(function: Callable[[Any], Any], work: Any) -> Any:
    """Compute in a process that others started: with one thread, and kernels kept beside the results.

    Parameters
    ----------
    function : callable
        What computes.
    work : Task, WholeTask, or an item of a whole stage
        What it computes; the first two say what is demanded of the process.

    Raises
    ------
    EngineError
        If this process does not see the store.
    """
    import os
    import sys

    if isinstance(demanded := getattr(work, "demand", None), Demand):
        demanded.check_store()
        if "vines.kernels" not in sys.modules:  # else kernels have their place, and this process may be the user's
            os.environ.setdefault("NUMBA_CACHE_DIR", str(work.data / "cache"))
    if "numba" in sys.modules:
        sys.modules["numba"].set_num_threads(1)
    else:
        one_thread()
    return function(work)


def _attempt(
    task: Task, points: Points, start: dict[str, Any] | None, part: Path, gathered: _Gathered
) -> dict[str, Any] | None:
    """Compute points, by halves where that fails; return the last row if they are carried and none failed."""
    folder = part.parent / f"work-{points[0].id}-{len(points)}"
    folder.mkdir()
    job = Job(task.options, points, task.carry, start, folder, task.provenance)
    compute = body_of(task.body)  # that it cannot be imported is no property of a point
    try:
        batch = compute(job)
    except ImportError:  # a package is missing on this machine: no property of a point, which another may compute
        raise
    except Exception as error:  # whatever else a body raises is a property of a point, and the others go on
        if is_of_the_machine(error):
            raise
        if len(points) == 1:
            _fail(task, points, _say(error), gathered)
            return None
        half = len(points) // 2
        last = _attempt(task, points[:half], start, part, gathered)
        if task.carry is not None and last is None:
            _fail(task, points[half:], "a point before it in the carried chain failed", gathered)
            return None
        return _attempt(task, points[half:], last, part, gathered)
    tables = _check(task, points, batch)
    for name, table in tables.items():
        gathered.tables[name].append(table)
    for point, name in batch.logs.items():
        kept = f"{point}{Path(name).suffix}"
        (folder / name).rename(part / kept)
        gathered.logs[point] = kept
    return _last_row(tables[task.tables[0]]) if task.carry is not None else None


def _check(task: Task, points: Points, batch: Batch) -> dict[str, pa.Table]:
    """Cast the tables of a batch and see that they are those of its points; the primary one in their order."""
    import pyarrow.compute

    pc: Any = pyarrow.compute
    ids = points.key.arrow()
    unknown = set(batch.tables) - set(task.tables)
    if unknown:
        raise SchemaError(f"{task.body}: returned table {min(unknown)!r}, which its kind does not name")
    tables = {name: schema.cast(name, batch.tables.get(name, ())) for name in task.tables}
    primary = task.tables[0]
    given: Any = tables[primary].column("point_id").combine_chunks()
    if not given.equals(ids):
        order = pc.index_in(ids, given)
        if len(given) != len(ids) or order.null_count:
            text = f"needs exactly one row for each of its {len(ids)} points"
            raise SchemaError(f"{task.body}: table {primary!r} {text}")
        tables[primary] = tables[primary].take(order)
    for name, table in tables.items():
        known = pc.is_in(table.column("point_id"), ids)
        if not pc.all(known).as_py() and table.num_rows:
            strange = table.filter(pc.invert(known)).column("point_id")[0]
            raise SchemaError(f"{task.body}: table {name!r} has rows of point {strange}, which was not asked for")
    strangers = set(batch.logs) - set(points.ids) if batch.logs else ()
    if strangers:
        raise SchemaError(f"{task.body}: a log of point {min(strangers)}, which was not asked for")
    return tables


def _fail(task: Task, points: Iterable[Point], reason: str, gathered: _Gathered) -> None:
    primary = task.tables[0]
    columns = schema.table(primary).names
    points = list(points)
    rows = [_failed_row(point, task.carry, reason, columns) for point in points]
    gathered.tables[primary].append(schema.cast(primary, rows))
    for name in task.tables[1:]:
        gathered.tables[name].append(schema.cast(name, ()))
    gathered.failed.update((point.id, reason) for point in points)


def _failed_row(point: Point, carry: str | None, reason: str, columns: Sequence[str]) -> Mapping[str, Any]:
    row = {**point.params, "point_id": point.id, "carry": carry, "status": "failed", "reason": reason}
    return {name: value for name, value in row.items() if name in columns}


def _last_row(table: pa.Table) -> dict[str, Any]:
    return table.slice(table.num_rows - 1).to_pylist()[0]


def _say(error: Exception) -> str:
    text = (str(error).splitlines() or [""])[0]
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
