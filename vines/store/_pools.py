"""Pools: every point of a stage that was ever computed, in parts that were committed as a whole."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines import schema
from vines.errors import DamageError, StoreError
from vines.store._atomic import commit_folder, write_text
from vines.store._described import damage_of, describe_files
from vines.store._keys import canonical, key_of
from vines.store._object import is_lasting, read_object
from vines.store._parquet import write_parquet
from vines.store._provenance import versions
from vines.store._results import seal

if TYPE_CHECKING:
    import numpy as np
    import pyarrow as pa

    from vines.store._ids import Ids

__all__ = ["Located", "Part", "Pool", "commit_part"]

_REMEDY = "a run that needs its points, or one with --force, computes them again"


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
    files : dict of str to dict
        Size and SHA-256 of its other files; empty for a part of an earlier version, which did not say.
    code : str
        Digest of the code that the process ran that computed it; empty as well.
    """

    folder: Path
    ids: Ids
    failed: frozenset[str]
    logs: dict[str, str]
    versions: dict[str, str]
    files: dict[str, dict[str, Any]]
    code: str

    def table(self, name: str) -> pa.Table:
        """Return the rows of a table; columns that are empty throughout are not stored and come back empty."""
        return schema.cast(name, self.stored(name))

    def stored(self, name: str) -> pa.Table:
        """Return the rows of a table with the columns that are stored.

        Raises
        ------
        DamageError
            If the file is not what was written.
        """
        import pyarrow as pa
        import pyarrow.parquet as pq

        path = self.folder / f"{name}.parquet"
        self.check(path.name)
        try:
            found: Any = pq.read_table(path)
        except (OSError, pa.ArrowException) as error:
            raise DamageError(f"{path} cannot be read: {str(error).splitlines()[0]}; {_REMEDY}") from None
        return found.replace_schema_metadata(None)

    def check(self, name: str) -> None:
        """See that a file is what was written; reads it.

        Raises
        ------
        DamageError
            If it is not.
        """
        if name in self.files and (problem := damage_of(self.folder, name, self.files[name])):
            raise DamageError(f"{self.folder}: {problem}; {_REMEDY}")

    def damage(self) -> str:
        """Return in words what is wrong with its files; empty if every checksum is right."""
        try:
            for name in self.files:
                self.check(name)
        except DamageError as error:
            return str(error)
        return ""


@dataclass(frozen=True, slots=True)
class Located:
    """Where wanted points are.

    Attributes
    ----------
    parts : list of Part
        The parts that were there when the points were looked up: another process may add some at any time.
    part : numpy.ndarray of int32
        Number of the part in `parts`, -1 for a point that is not there.
    row : numpy.ndarray of int32
        Its place among the points of the part.
    failed : numpy.ndarray of bool
        Whether it failed whenever it was tried.
    """

    parts: list[Part]
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
        self.damaged: dict[str, str] = {}
        """Names of the parts that are not what was written, and why; nothing is taken from them."""
        self._parts: dict[str, Part] = {}

    def names(self) -> list[str]:
        """Return the names of the committed parts in the order of their numbers, without reading them."""
        return sorted(path.name for path in self.folder.iterdir() if path.is_dir()) if self.folder.is_dir() else []

    def parts(self) -> list[Part]:
        """Return the committed parts in the order of their numbers, without those that are damaged at a first look."""
        names = self.names()
        for name in names:
            if name not in self._parts and name not in self.damaged:
                try:
                    self._parts[name] = _read_part(self.folder / name)
                except DamageError as error:
                    self.damaged[name] = str(error)
        return [self._parts[name] for name in names if name in self._parts]

    def examine(self) -> dict[str, str]:
        """Read all parts and return the names of those that are damaged, and why."""
        for part in self.parts():
            if damage := part.damage():
                self.damaged[part.folder.name] = damage
                del self._parts[part.folder.name]
        return self.damaged

    def discard_damaged(self, trash: Path) -> None:
        """Move the parts that are known to be damaged into another folder, so that their points are computed again."""
        for name in self.damaged:
            with contextlib.suppress(OSError):  # another process was quicker
                (self.folder / name).rename(trash / name)
        self.damaged.clear()

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
            return Located(parts, none, none, there)
        at[~there] = 0
        return Located(
            parts,
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
        text = canonical(dict(ingredients)) + "\n"
        if not path.is_file() or path.read_bytes() != text.encode():
            write_text(path, text)

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
        return found.parts[found.part[0]].table(table).slice(int(found.row[0]), 1).to_pylist()[0]


def commit_part(
    pool: Path,
    source: Path,
    number: int,
    tables: Mapping[str, Any],
    *,
    ids: Ids,
    failed: Iterable[str],
    logs: Mapping[str, str],
    code: str = "",
) -> Path:
    """Write tables beside the log files in `source`, make the folder a part of the pool, and return its place.

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
    code : str
        Digest of the code that this process has shown to run.
    """
    for name, table in tables.items():
        write_parquet(source / f"{name}.parquet", name, table, provenance={}, sparse=True)
    text = ids.text()
    about = {
        "ids": text,
        "failed": sorted(failed),
        "logs": dict(logs),
        "versions": versions(),
        "code": code,
        "files": describe_files(source),
    }
    (source / "part.json").write_text(canonical(seal(about)) + "\n", encoding="utf-8")
    place = pool / f"{number:08d}-{key_of(text)[:12]}"
    commit_folder(source, place)
    return place


def _read_part(folder: Path) -> Part:
    """Read what a part says of itself, and see that its files are there in their sizes.

    Raises
    ------
    DamageError
        If something is missing or not what was written.
    """
    from vines.store._ids import Ids

    try:
        about = read_object(folder / "part.json")
        check = about.pop("check", None)
        text = about["ids"] if isinstance(about["ids"], str) else "".join(about["ids"])
        ids = Ids.from_hex(text)
        named = folder.name.partition("-")[2]
        if check not in (None, key_of(about)) or (check is not None and named != key_of(text)[:12]):
            raise DamageError(f"{folder / 'part.json'} is damaged: it is not what was written; {_REMEDY}")
        for name, said in about.get("files", {}).items():
            if problem := damage_of(folder, name, said, contents=False):
                raise DamageError(f"{folder}: {problem}; {_REMEDY}")
        return Part(
            folder=folder,
            ids=ids,
            failed=frozenset(about["failed"]),
            logs=about["logs"],
            versions=about.get("versions", {}),
            files=about.get("files", {}),
            code=about.get("code", ""),
        )
    except OSError as error:
        if not is_lasting(error):
            raise
        raise DamageError(f"{folder}: part.json: {error.strerror}; {_REMEDY}") from None
    except KeyError as error:
        raise DamageError(f"{folder}: {error} is missing in part.json; {_REMEDY}") from None
    except (ValueError, TypeError, AttributeError) as error:
        raise DamageError(f"{folder}: part.json: {error}; {_REMEDY}") from None
