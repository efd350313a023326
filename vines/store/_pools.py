"""Pools: every point of a stage that was ever computed, in parts that were committed as a whole."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import StoreError
from vines.store._atomic import commit_folder, write_text
from vines.store._keys import canonical, key_of
from vines.store._parquet import write_parquet

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["Part", "Pool", "commit_part"]


@dataclass(frozen=True, slots=True)
class Part:
    """One committed part: a folder with one Parquet file a table, log files, and ``part.json``."""

    folder: Path
    ids: tuple[str, ...]
    failed: frozenset[str]
    logs: dict[str, str]


class Pool:
    """The pool of one key. Reading it needs no lock: a part is there as a whole or not at all.

    Parameters
    ----------
    folder : Path
        ``data/points/<key>``; need not exist yet.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._parts: dict[str, Part] = {}

    def parts(self) -> list[Part]:
        """Return the committed parts in the order of their numbers."""
        names = sorted(path.name for path in self.folder.iterdir() if path.is_dir()) if self.folder.is_dir() else []
        for name in names:
            if name not in self._parts:
                self._parts[name] = _read_part(self.folder / name)
        return [self._parts[name] for name in names]

    def computed(self) -> dict[str, Part]:
        """Return the part that holds each point that was computed and did not fail."""
        return {point: part for part in self.parts() for point in part.ids if point not in part.failed}

    def failed(self) -> dict[str, Part]:
        """Return the latest part of each point that failed whenever it was tried."""
        computed = self.computed()
        parts = self.parts()
        return {point: part for part in parts for point in part.failed if point not in computed}

    def next_number(self) -> int:
        """Return the number for the next part."""
        return 1 + max((int(part.folder.name.split("-")[0]) for part in self.parts()), default=0)

    def describe(self, ingredients: Mapping[str, Any]) -> None:
        """Write down what the pool is a pool of, if that was not done yet."""
        path = self.folder / "pool.json"
        if not path.exists():
            write_text(path, canonical(dict(ingredients)) + "\n")

    def row(self, table: str, point: str) -> dict[str, Any]:
        """Return the row of a point in a table.

        Raises
        ------
        StoreError
            If the point was not computed.
        """
        import pyarrow.parquet as pq

        part = self.computed().get(point)
        if part is None:
            raise StoreError(f"point {point} is not in the pool {self.folder.name[:12]}; run the stage again")
        rows = pq.read_table(part.folder / f"{table}.parquet", filters=[("point_id", "=", point)])
        return rows.to_pylist()[0]

    def gather(self, table: str, wanted: list[str]) -> pa.Table:
        """Return the rows of a table for the wanted points, in their order; rows of a point keep theirs.

        Parameters
        ----------
        table : str
            Table of ``schemas/``.
        wanted : list of str
            Ids of points, all of them computed or failed.
        """
        import pyarrow as pa
        import pyarrow.compute
        import pyarrow.parquet as pq

        pc: Any = pyarrow.compute
        holder = {**self.failed(), **self.computed()}
        order = pa.array(wanted, type=pa.string())
        pieces = []
        for part in self.parts():
            mine = [point for point in part.ids if holder[point] is part]
            rows = pq.read_table(part.folder / f"{table}.parquet")
            pieces.append(rows.filter(pc.is_in(rows.column("point_id"), pa.array(mine, type=pa.string()))))
        rows = pa.concat_tables([piece.replace_schema_metadata(None) for piece in pieces])
        rank = pc.index_in(rows.column("point_id"), order)
        rows = rows.append_column("__rank", rank).append_column("__place", pa.array(range(rows.num_rows)))
        rows = rows.filter(pc.is_valid(rank)).sort_by([("__rank", "ascending"), ("__place", "ascending")])
        return rows.drop_columns(["__rank", "__place"])


def commit_part(
    pool: Path,
    source: Path,
    number: int,
    tables: Mapping[str, Any],
    *,
    ids: Iterable[str],
    failed: Iterable[str],
    logs: Mapping[str, str],
) -> None:
    """Write tables beside the log files in `source` and make the folder a part of the pool.

    Called by worker processes. The name says number and points, so that a part which comes late, from a
    worker whose run was killed, cannot stand in the way of another.
    """
    for name, table in tables.items():
        write_parquet(source / f"{name}.parquet", name, table, provenance={})
    points = list(ids)
    about = {"ids": points, "failed": sorted(failed), "logs": dict(logs)}
    write_text(source / "part.json", canonical(about) + "\n")
    commit_folder(source, pool / f"{number:08d}-{key_of(points)[:12]}")


def _read_part(folder: Path) -> Part:
    try:
        about = json.loads((folder / "part.json").read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise StoreError(f"{folder}: {error}; remove this folder and run again") from None
    return Part(folder, tuple(about["ids"]), frozenset(about["failed"]), about["logs"])
