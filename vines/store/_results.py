"""Results: immutable folders under their key, each with a manifest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines import schema
from vines.errors import DamageError, UnknownNameError, nearest
from vines.store._described import damage_of
from vines.store._keys import key_of
from vines.store._object import read_object

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["Result", "describe_table", "read_result", "seal"]


_FORM = {"files": dict, "tables": dict}
"""What each manifest has."""


@dataclass(frozen=True, slots=True)
class Result:
    """A stored result.

    Attributes
    ----------
    key : str
        Its key; also the name of its folder.
    folder : Path
        Where it lies.
    manifest : dict
        ``kind``, ``ingredients``, ``tables`` (rows, columns and units of each, the primary one first), ``files``
        (sha256 and bytes of each), ``logs``, ``points``, ``failed``, ``provenance``, and, only here,
        ``written`` and ``host``.
    """

    key: str
    folder: Path
    manifest: dict[str, Any]

    @property
    def tables(self) -> tuple[str, ...]:
        """Names of its tables, the primary one first."""
        return tuple(self.manifest["tables"])

    @property
    def logs(self) -> dict[str, Path]:
        """Log file of each point that has one, by point id."""
        return {log["point_id"]: self.folder / log["file"] for log in self.manifest["logs"]}

    @property
    def files(self) -> dict[str, Path]:
        """All files except the manifest, by their names inside the folder."""
        return {name: self.folder / name for name in self.manifest["files"]}

    def table(self, name: str | None = None) -> pa.Table:
        """Return one of its tables, the primary one if no name is given.

        Raises
        ------
        UnknownNameError
            If there is no such table.
        SchemaError
            If the file is not what the schema of the table says.
        """
        wanted = name if name is not None else next(iter(self.tables), "")
        if wanted not in self.tables:
            raise UnknownNameError(f"result {self.key[:12]} has no table {wanted!r}: {nearest(wanted, self.tables)}")
        from vines.store._parquet import read_parquet

        return read_parquet(self.folder / f"{wanted}.parquet", wanted)

    def check_forms(self) -> None:
        """See that columns, units and versions of all its tables are those of their schemas; reads no rows.

        Raises
        ------
        SchemaError
            If they are not; one line.
        OSError
            If a table cannot be read.
        """
        from vines.store._parquet import check_form

        for name in self.tables:
            check_form(self.folder / f"{name}.parquet", name)

    def damage(self) -> list[str]:
        """Return what is wrong with the files, one line each; empty if every checksum is right."""
        problems = (damage_of(self.folder, name, said) for name, said in self.manifest["files"].items())
        return [problem for problem in problems if problem]


def seal(manifest: Mapping[str, Any]) -> dict[str, Any]:
    """Return a manifest with its own digest."""
    return {**manifest, "check": key_of(manifest)}


def read_result(folder: Path, *, strict: bool = True) -> Result:
    """Read the manifest of a result.

    Parameters
    ----------
    folder : Path
        Of the result.
    strict : bool
        Whether to refuse a manifest that can be read, but is not what was written.

    Raises
    ------
    DamageError
        If the manifest is missing or damaged.
    """
    path = folder / "manifest.json"
    remedy = "the next run of its pipeline makes it again"
    try:
        manifest = read_object(path)
        check = manifest.pop("check", None)
        if lacking := [name for name, kind in _FORM.items() if not isinstance(manifest.get(name), kind)]:
            raise ValueError(f"{lacking[0]!r} is missing in it, or is something else")
    except OSError as error:
        raise DamageError(f"{path} cannot be read: {error.strerror}; {remedy}") from None
    except ValueError as error:
        raise DamageError(f"{path} cannot be read: {error}; {remedy}") from None
    if strict and check is not None and (check != key_of(manifest) or manifest.get("key") != folder.name):
        raise DamageError(f"{path} is damaged: it is not what was written; {remedy}")
    return Result(folder.name, folder, manifest)


def describe_table(name: str, rows: int) -> dict[str, Any]:
    """Return what a manifest says of a table: rows, columns, and units of those that have one."""
    return {"rows": rows, "columns": list(schema.table(name).names), "units": schema.units(name)}
