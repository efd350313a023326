"""Putting the result of a stage together from the parts of its pool, block by block, so that memory stays flat."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vines import schema
from vines.errors import StoreError
from vines.pipeline._links import with_links
from vines.pipeline._plan import Prepared
from vines.store import Located, Part, Store, TableFile, describe_table

if TYPE_CHECKING:
    import pyarrow as pa

    from vines.pipeline._grid import Grid
    from vines.pipeline._refined import Refined

__all__ = ["Gathered", "put_together"]

_BLOCK = 2**15
_KEPT_ROWS = 4 * _BLOCK


@dataclass(frozen=True, slots=True)
class Gathered:
    """The result of a stage: its key, how many of its points failed, and the versions that computed them."""

    key: str
    failed: int
    versions: dict[str, str]


def put_together(
    prepared: Prepared, grid: Grid | Refined, store: Store, *, replace: bool, remark: str = ""
) -> Gathered:
    """Make the result of a stage from its pool.

    The rows are in the order of the grid, so that the bytes don't depend on who computed which point when.

    Parameters
    ----------
    prepared : Prepared
        The stage.
    grid : Grid or Refined
        Its points, all of them in the pool.
    store : Store
        Where it goes.
    replace : bool
        Whether to replace a result of the same key that differs.
    remark : str
        Why the refinement ended early, for the manifest.

    Raises
    ------
    StoreError
        If points or rows are not there after all; then nothing is stored.
    """
    stage = prepared.stage
    located = store.pool(prepared.pool_key).locate(grid.ids)
    absent = located.part < 0
    if absent.any():
        raise _lost(prepared, grid, np.flatnonzero(absent))
    failed = grid.ids.take(located.failed).hex()
    key = prepared.result_key(grid, failed)
    versions = _versions(located.parts[number] for number in np.unique(located.part).tolist())
    if store.has(key) and not replace:
        return Gathered(key, len(failed), versions)
    provenance = prepared.ingredients.provenance(key)
    with store.staging() as place:
        folder = place / "result"
        folder.mkdir()
        about = {}
        for name in stage.kind.tables:
            sorted_by = _sorted_by(grid, name)
            with TableFile(folder / f"{name}.parquet", name, provenance=provenance, sorted_by=sorted_by) as file:
                for start, rows in _blocks(located, name):
                    if name == stage.kind.tables[0]:
                        _match(prepared, grid, start, rows)
                    file.add(rows)
            about[name] = describe_table(name, file.rows)
        manifest = {
            "kind": stage.kind.name,
            "ingredients": prepared.ingredients.form,
            "provenance": provenance,
            "versions": versions,
            "pool": prepared.pool_key,
            "points": len(grid),
            "failed": len(failed),
            "remark": remark,
            "tables": about,
            "logs": _logs(prepared, grid, located, folder) if stage.kind.logs else [],
        }
        store.commit(key, folder, manifest, replace=replace)
    return Gathered(key, len(failed), versions)


@dataclass
class _Tables:
    """Tables of parts that were read lately."""

    parts: list[Part]
    name: str
    kept: dict[int, pa.Table] = field(default_factory=dict)

    def of(self, number: int) -> pa.Table:
        """Return the table of a part."""
        table = self.kept.pop(number, None)
        if table is None:
            table = self.parts[number].stored(self.name)
        self.kept[number] = table
        while len(self.kept) > 1 and sum(each.num_rows for each in self.kept.values()) > _KEPT_ROWS:
            del self.kept[next(iter(self.kept))]
        return table


def _match(prepared: Prepared, grid: Grid | Refined, start: int, rows: pa.Table) -> None:
    """See that these are the rows of the points from a place on, one each."""
    wanted = grid.ids.take(slice(start, start + _BLOCK)).hex()
    there: list[Any] = rows.column("point_id").to_pylist()
    if there != wanted:
        known = set(there)
        lost = [start + place for place, identity in enumerate(wanted) if identity not in known]
        raise _lost(prepared, grid, np.array(lost or [start]))


def _lost(prepared: Prepared, grid: Grid | Refined, places: np.ndarray) -> StoreError:
    """Return the error that names points which should be in the pool and are not."""
    first = ", ".join(f"{name} = {values[0]:.12g}" for name, values in grid.columns(places[:1]).items())
    where = f", the first at {first}" if first else ""
    return StoreError(
        f"{len(places)} of {len(grid)} points of stage {prepared.stage.name} were told to be stored and are not in "
        f"{prepared.pool_key[:12]} below data/points{where}; nothing was put together; they were removed "
        "meanwhile, or whoever computed them does not see this folder; run again"
    )


def _blocks(located: Located, name: str) -> Iterator[tuple[int, pa.Table]]:
    """Yield where a block of points begins, and its rows of a table in their order; rows of one point keep theirs."""
    import pyarrow as pa
    import pyarrow.compute

    pc: Any = pyarrow.compute
    parts = located.parts
    tables = _Tables(parts, name)
    for start in range(0, len(located.part), _BLOCK):
        numbers = located.part[start : start + _BLOCK]
        at = located.row[start : start + _BLOCK]
        pieces, ranks = [], []
        for number in np.unique(numbers).tolist():
            places = np.flatnonzero(numbers == number)
            rank = np.full(len(parts[number].ids), -1, dtype=np.int64)
            rank[at[places]] = places
            table: Any = tables.of(number)
            rows = pc.index_in(table.column("point_id"), parts[number].ids.arrow())
            mine = rank[np.asarray(rows)]
            if (mine < 0).any():
                table = table.filter(pa.array(mine >= 0))
                mine = mine[mine >= 0]
            pieces.append(table)
            ranks.append(mine)
        whole = pa.concat_tables(pieces, promote_options="default")
        order = np.concatenate(ranks)
        if (np.diff(order) < 0).any():
            whole = whole.take(pa.array(np.argsort(order, kind="stable")))
        yield start, whole


def _logs(prepared: Prepared, grid: Grid | Refined, located: Located, folder: Path) -> list[dict[str, Any]]:
    """Put the log files into the result and return what the manifest says of them."""
    import pyarrow.parquet as pq

    names: dict[str, Any] = {}
    primary = prepared.stage.kind.tables[0]
    if "name" in schema.table(primary).names:
        rows: Any = pq.read_table(folder / f"{primary}.parquet", columns=["point_id", "name"])
        names = dict(zip(rows.column("point_id").to_pylist(), rows.column("name").to_pylist(), strict=True))
    columns = with_links(prepared.stage, grid.columns(range(len(grid))))
    found = []
    for i, point in enumerate(grid.ids.hex()):
        part = located.parts[located.part[i]]
        log = part.logs.get(point)
        if log is not None:
            part.check(log)
            _link(part.folder / log, folder / "logs" / log)
            params = {**grid.fixed(), **{name: float(values[i]) for name, values in columns.items()}}
            found.append({"point_id": point, "file": f"logs/{log}", "params": params, "name": names.get(point)})
    return found


def _versions(parts: Iterator[Part]) -> dict[str, str]:
    """Return the versions that computed some parts, several of one package with commas between them."""
    found: dict[str, set[str]] = {}
    for part in parts:
        for package, version in part.versions.items():
            found.setdefault(package, set()).add(version)
    return {package: ", ".join(sorted(versions)) for package, versions in sorted(found.items())}


def _sorted_by(grid: Grid | Refined, name: str) -> list[str]:
    """Return the axes that rows of a table are sorted by; of axes that run together the first may fall or repeat."""
    columns = schema.table(name).names
    zipped = {axis for names in grid.stage.zipped for axis in names}
    found: list[str] = []
    for axis in grid.names:
        if axis not in columns or axis in zipped:
            break
        found.append(axis)
    return found


def _link(source: Path, target: Path) -> None:
    """Put a file into a second folder without a second copy of its bytes, where the file system can."""
    target.parent.mkdir(exist_ok=True)
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)
