"""Pools: every point of a stage that was ever computed, in parts that were committed as a whole."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines import schema
from vines.errors import StoreError
from vines.store._atomic import commit_folder, write_text
from vines.store._keys import canonical, key_of
from vines.store._parquet import write_parquet
from vines.store._provenance import versions

if TYPE_CHECKING:
    import numpy as np
    import pyarrow as pa

    from vines.store._ids import Ids

__all__ = ["Located", "Part", "Pool", "commit_part"]


@dataclass(frozen=True, slots=True)
class Part:
    """One committed part: a folder with one Parquet file a table, log files, and ``part.json``.

    Attributes
    ----------
    folder : Path
        Where it lies.
    ids : Ids
        Its points, in the order of the rows of its primary table.
    failed : frozenset of str
        Those of them that failed.
    logs : dict of str to str
        Log file of each point that has one.
    versions : dict of str to str
        Versions of the packages that computed it.
    """

    folder: Path
    ids: Ids
    failed: frozenset[str]
    logs: dict[str, str]
    versions: dict[str, str]

    def table(self, name: str) -> pa.Table:
        """Return the rows of a table; columns that are empty throughout are not stored and come back empty."""
        return schema.cast(name, self.stored(name))

    def stored(self, name: str) -> pa.Table:
        """Return the rows of a table with the columns that are stored."""
        import pyarrow.parquet as pq

        found: Any = pq.read_table(self.folder / f"{name}.parquet")
        return found.replace_schema_metadata(None)


@dataclass(frozen=True, slots=True)
class Located:
    """Where wanted points are.

    Attributes
    ----------
    part : numpy.ndarray of int32
        Number of the part in :meth:`Pool.parts`, -1 for a point that is not there.
    row : numpy.ndarray of int32
        Its place among the points of the part.
    failed : numpy.ndarray of bool
        Whether it failed whenever it was tried.
    """

    part: np.ndarray
    row: np.ndarray
    failed: np.ndarray


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

    def names(self) -> list[str]:
        """Return the names of the committed parts in the order of their numbers, without reading them."""
        return sorted(path.name for path in self.folder.iterdir() if path.is_dir()) if self.folder.is_dir() else []

    def parts(self) -> list[Part]:
        """Return the committed parts in the order of their numbers."""
        names = self.names()
        for name in names:
            if name not in self._parts:
                self._parts[name] = _read_part(self.folder / name)
        return [self._parts[name] for name in names]

    def locate(self, wanted: Ids) -> Located:
        """Return where points are: what was computed goes before what failed, then the later part."""
        import numpy as np

        from vines.store._ids import Ids

        parts = self.parts()
        lengths = [len(part.ids) for part in parts]
        number = np.repeat(np.arange(len(parts), dtype=np.int32), lengths)
        row = np.concatenate([np.arange(n, dtype=np.int32) for n in lengths]) if parts else number
        every = Ids.joined([part.ids for part in parts])
        failed = np.zeros(len(every), dtype=bool)
        first = np.cumsum([0, *lengths])
        for part, start in zip(parts, first[:-1], strict=True):
            if part.failed:
                failed[start + part.ids.locate(Ids.of(sorted(part.failed)))] = True
        if failed.any():  # the last of equal ids is found, so those that failed stand before the others
            order = np.concatenate([np.flatnonzero(failed), np.flatnonzero(~failed)])
            every, number, row, failed = every.take(order), number[order], row[order], failed[order]
        at = every.locate(wanted)
        there = at >= 0
        if not len(every):
            none = np.full(len(wanted), -1, dtype=np.int32)
            return Located(none, none, there)
        at[~there] = 0
        return Located(
            np.where(there, number[at], -1).astype(np.int32),
            np.where(there, row[at], -1).astype(np.int32),
            there & failed[at],
        )

    def next_number(self) -> int:
        """Return the number for the next part."""
        return 1 + max((int(name.split("-")[0]) for name in self.names()), default=0)

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
        from vines.store._ids import Ids

        found = self.locate(Ids.of([point]))
        if found.part[0] < 0 or found.failed[0]:
            raise StoreError(f"point {point} is not in the pool {self.folder.name[:12]}; run the stage again")
        return self.parts()[found.part[0]].table(table).slice(int(found.row[0]), 1).to_pylist()[0]


def commit_part(
    pool: Path,
    source: Path,
    number: int,
    tables: Mapping[str, Any],
    *,
    ids: Ids,
    failed: Iterable[str],
    logs: Mapping[str, str],
) -> None:
    """Write tables beside the log files in `source` and make the folder a part of the pool.

    Called by worker processes. The name says number and points, so that a part which comes late, from a
    worker whose run was killed, cannot stand in the way of another.

    Parameters
    ----------
    pool : Path
        Folder of the pool.
    source : Path
        Staged folder.
    number : int
        Number of the part.
    tables : mapping of str to pyarrow.Table
        Rows of each table, cast to its schema; those of the primary table in the order of `ids`.
    ids : Ids
        The points.
    failed : iterable of str
        Those of them that failed.
    logs : mapping of str to str
        Log file of each point that has one.
    """
    for name, table in tables.items():
        write_parquet(source / f"{name}.parquet", name, table, provenance={}, sparse=True)
    text = ids.text()
    about = {"ids": text, "failed": sorted(failed), "logs": dict(logs), "versions": versions()}
    (source / "part.json").write_text(canonical(about) + "\n", encoding="utf-8")
    commit_folder(source, pool / f"{number:08d}-{key_of(text)[:12]}")


def _read_part(folder: Path) -> Part:
    from vines.store._ids import Ids

    try:
        about = json.loads((folder / "part.json").read_text("utf-8"))
        ids = Ids.from_hex(about["ids"] if isinstance(about["ids"], str) else "".join(about["ids"]))
    except (OSError, ValueError) as error:
        raise StoreError(f"{folder}: {error}; remove this folder and run again") from None
    return Part(folder, ids, frozenset(about["failed"]), about["logs"], about.get("versions", {}))
