"""A copy of results that needs no vines: tables, the SQL of their views, schemas, provenance, checksums."""

from __future__ import annotations

import contextlib
import csv
import errno
import glob
import hashlib
import io
import json
import shutil
import uuid
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vines import schema
from vines.catalogue._deposit import citation, datacite, licence, package_fields
from vines.catalogue._readme import readme
from vines.catalogue._study import Deposit
from vines.catalogue._views import list_views
from vines.errors import DamageError, StoreError
from vines.store import Result, describe_file

__all__ = ["Collected", "export_results"]

_OF_THE_DISK = frozenset({errno.EDQUOT, errno.EFBIG, errno.ENOSPC, errno.ENOTEMPTY, errno.EROFS})
"""What can be wrong with where an export is written, not with what it is made of."""
_LOCAL = ("written", "host")
"""What a manifest says of when and where, which is no part of the data."""


@dataclass(frozen=True, slots=True)
class Collected:
    """What is exported.

    Attributes
    ----------
    results : sequence of (str, str, Result)
        Pipeline, stage, result.
    declarations : mapping of str to str
        Text of each declaration by the name of its file.
    titles : mapping of str to str
        Title of each pipeline.
    licence, citation : str
        Texts of LICENSE and CITATION.cff.
    logs : bool
        Whether the MCAP logs go along.
    stale : sequence of str
        Which stages are declared otherwise now, or not computed, a line each.
    deposit : Deposit, optional
        What a data repository is told, `[study]` of a declaration; its licence and citation then count.
    """

    results: Sequence[tuple[str, str, Result]]
    declarations: Mapping[str, str]
    titles: Mapping[str, str]
    licence: str
    citation: str
    logs: bool = False
    stale: Sequence[str] = ()
    deposit: Deposit | None = None

    def place(self, pipeline: str, stage: str, file: str) -> str | None:
        """Return where a file of a result lies in the export; None if it does not go along."""
        name = f"{pipeline}.{stage}"
        if file.endswith(".parquet"):
            return f"tables/{name}.{file}"
        if file.startswith("picture."):
            return f"figures/{name}{Path(file).suffix}"
        if file.startswith("logs/"):
            return f"logs/{name}/{Path(file).name}" if self.logs else None
        return f"others/{name}/{file}"


def export_results(collected: Collected, target: Path) -> list[str]:
    """Write an export, the whole of it or nothing, and return the names of its files.

    Parameters
    ----------
    collected : Collected
        What goes into it.
    target : Path
        Its folder: one that does not exist, or an empty one.

    Raises
    ------
    StoreError
        If the folder is not empty, another export writes there, or it cannot be written.
    DamageError
        If a file of a result is missing or damaged.
    """
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise StoreError(f"{target} is not an empty folder; name one that is, or that does not exist yet")
    if not target.parent.is_dir():
        raise StoreError(f"{target}: the folder {target.parent} does not exist; make it first")
    with _staged(target) as folder:
        for pipeline, stage, result in collected.results:
            for file, path in result.files.items():
                place = collected.place(pipeline, stage, file)
                if place is None:
                    continue
                _copy(path, folder / place)
                if describe_file(folder / place) != result.manifest["files"][file]:
                    raise DamageError(f"{path} is damaged; 'vines run {pipeline}' mends it, then export again")
            _write(folder / "provenance" / f"{pipeline}.{stage}.json", _provenance(collected, pipeline, stage, result))
        for name, text in collected.declarations.items():
            _write(folder / "declarations" / name, text)
        for name in _tables(collected):
            _write(folder / "schemas" / f"{name}.toml", schema.toml(name))
        told = collected.deposit
        if told is not None:
            _write(folder / "datacite.json", datacite(told))
        _write(folder / "LICENSE", collected.licence if told is None else licence(told))
        _write(folder / "CITATION.cff", collected.citation if told is None else citation(told))
        _write(folder / "load.sql", _load(collected))
        _write(folder / "dictionary.csv", _dictionary(collected))
        _write(folder / "datapackage.json", _datapackage(collected))
        text = readme(collected.results, collected.titles, collected.logs, collected.stale, told)
        _write(folder / "README.md", text)
        names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
        _write(folder / "SHA256SUMS", "".join(f"{_sha256(folder / name)}  {name}\n" for name in names))
    return [*names, "SHA256SUMS"]


@contextlib.contextmanager
def _staged(target: Path) -> Iterator[Path]:
    """Give a folder that takes the place of the target once it is whole; what a killed export left goes."""
    from filelock import FileLock, Timeout

    lock = FileLock(target.parent / f".{target.name}.export.lock")
    try:
        lock.acquire(timeout=0)
    except Timeout:
        raise StoreError(f"another export is writing {target}; wait for it, or name another folder") from None
    folder = target.parent / f"{lock.lock_file}.{uuid.uuid4().hex[:12]}"
    try:
        for left in target.parent.glob(f"{glob.escape(Path(lock.lock_file).name)}.*"):
            shutil.rmtree(left, ignore_errors=True)
        folder.mkdir()
        yield folder
        if target.is_dir():
            target.rmdir()
        folder.rename(target)
    except OSError as error:
        if error.errno not in _OF_THE_DISK:
            raise
        raise StoreError(f"{target} cannot be written: {error.strerror}; nothing of the export is there") from None
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        Path(lock.lock_file).unlink(missing_ok=True)
        lock.release()


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    try:
        shutil.copyfile(source, target)
    except FileNotFoundError:
        raise DamageError(f"{source} is missing; 'vines run' of its pipeline mends it, then export again") from None


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8", newline="\n")


def _sha256(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _tables(collected: Collected) -> list[str]:
    """Return the tables that the export has, and ``logs``."""
    there = {name for _, _, result in collected.results for name in result.tables}
    return [name for name in schema.tables() if name in there or name == "logs"]


def _provenance(collected: Collected, pipeline: str, stage: str, result: Result) -> str:
    told = {name: value for name, value in result.manifest.items() if name not in _LOCAL}
    told["files"] = {
        place: about
        for file, about in result.manifest["files"].items()
        if (place := collected.place(pipeline, stage, file)) is not None
    }
    return json.dumps(told, indent=1) + "\n"


def _load(collected: Collected) -> str:
    lines = [
        "-- Makes the views of this export in DuckDB. Paths are relative to this folder: start duckdb in it, or",
        "-- say first: SET file_search_path = '/path/to/this/folder';",
    ]
    for view in list_views(collected.results, collected.place):
        lines += [f"{each.replace('CREATE VIEW', 'CREATE OR REPLACE VIEW', 1)};" for each in view.statements()]
    return "\n".join(lines) + "\n"


def _dictionary(collected: Collected) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["table", "column", "type", "unit", "description", "source", "allowed"])
    for name in _tables(collected):
        for c in schema.table(name).columns:
            writer.writerow([name, c.name, c.dtype, c.unit, c.description, c.source, c.allowed])
    return stream.getvalue()


_TYPES = {"bool": "boolean", "float64": "number", "int8": "integer", "int64": "integer", "string": "string"}


def _datapackage(collected: Collected) -> str:
    """Return the description as a Data Package (Frictionless)."""
    resources = []
    for pipeline, stage, result in collected.results:
        for name in result.tables:
            about = result.manifest["files"][f"{name}.parquet"]
            resources.append(
                {
                    "name": f"{pipeline}.{stage}.{name}",
                    "path": collected.place(pipeline, stage, f"{name}.parquet"),
                    "title": f"{schema.table(name).description} ({collected.titles.get(pipeline, pipeline)})",
                    "format": "parquet",
                    "mediatype": "application/vnd.apache.parquet",
                    "bytes": about["bytes"],
                    "hash": f"sha256:{about['sha256']}",
                    "schema": {"fields": _fields(name, result.manifest["tables"][name]["columns"])},
                }
            )
    package: dict[str, Any] = {
        "name": "vines-results",
        "title": "; ".join(collected.titles[name] for name in sorted(collected.titles)),
        "licenses": [{"path": "LICENSE"}],
    }
    if collected.deposit is not None:
        package |= package_fields(collected.deposit)
    package["resources"] = resources
    return json.dumps(package, indent=1, ensure_ascii=False) + "\n"


def _fields(name: str, there: Sequence[str]) -> list[dict[str, Any]]:
    fields = []
    for column in schema.table(name).columns:
        if column.name not in there:
            continue
        one: dict[str, Any] = {
            "name": column.name,
            "type": _TYPES.get(column.dtype, "array"),
            "unit": column.unit,
            "description": column.description,
        }
        limits = {"enum": list(column.values) or None, "minimum": column.minimum, "maximum": column.maximum}
        if constraints := {key: value for key, value in limits.items() if value is not None}:
            one["constraints"] = constraints
        fields.append(one)
    return fields
