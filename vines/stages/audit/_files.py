"""Files of a result: checksums, schemas, and whether the provenance is that of the key."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

from vines import schema
from vines.errors import SchemaError
from vines.stages.audit._identities import identities
from vines.store import Ids, Result, Store, canonical, key_of

if TYPE_CHECKING:
    import pyarrow as pa

    from vines.stages.audit._ledger import Ledger

__all__ = ["check_files", "check_provenance", "check_schema", "check_table"]

_CHOICE = ("refine", "vary", "zip")
_ORIGIN = ("key", "versions", "revision", "exact", "order")


def check_files(ledger: Ledger, where: str, result: Result) -> None:
    """Compare every file with its checksum in the manifest, and the folder with the list of files."""
    damage = result.damage()
    says = "SHA-256 and presence as in the manifests"
    ledger.note("files", "checksums", says, "files", "", len(result.files) - len(damage))
    for line in damage:
        ledger.note("files", "checksums", says, "files", f"{where}: {line}")
    listed = {*result.manifest["files"], "manifest.json"}
    there = {path.relative_to(result.folder).as_posix() for path in result.folder.rglob("*") if path.is_file()}
    for name in sorted(there - listed):
        ledger.note("files", "checksums", says, "files", f"{where}: {name} is not in the manifest")


def check_schema(ledger: Ledger, where: str, result: Result, name: str) -> bool:
    """Check the form of a table and say whether its rows can be read."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    says = "columns, types, units and version of schemas/"
    about = result.manifest["tables"][name]
    try:
        file = pq.ParquetFile(result.folder / f"{name}.parquet")
    except (OSError, pa.ArrowException) as error:
        ledger.note("files", "schemas", says, "tables", f"{where}: {name} cannot be read: {str(error).splitlines()[0]}")
        return False
    with file:
        form, rows = file.schema_arrow, file.metadata.num_rows
    wrong = schema.disagreements(name, form)
    if form.names != about["columns"]:
        wrong.append("its columns are not those of the manifest")
    if rows != about["rows"]:
        wrong.append(f"it has {rows} rows, the manifest says {about['rows']}")
    ledger.note("files", "schemas", says, "tables", f"{where}: {name}: {wrong[0]}" if wrong else "")
    text = (form.metadata or {}).get(b"vines", b"{}")
    same = _provenance_of(text) == result.manifest["provenance"]
    ledger.note(
        "files",
        "provenance inside",
        "that of the manifest, in each table",
        "tables",
        "" if same else f"{where}: {name} tells another origin than the manifest",
    )
    wanted = schema.arrow_schema(name)
    return all(column in wanted.names and form.field(column).type == wanted.field(column).type for column in form.names)


def check_table(ledger: Ledger, where: str, name: str, table: pa.Table) -> None:
    """Check that the values of some rows are among those that the schema allows."""
    wrong = ""
    try:
        schema.check_values(name, table)
    except SchemaError as error:
        wrong = f"{where}: {error}"
    ledger.note("files", "values", "those that schemas/ allows", "rows", wrong, table.num_rows)


def check_provenance(ledger: Ledger, where: str, result: Result, store: Store, primary: pa.Table | None) -> None:
    """Check that key, pool and points follow from what the manifest says of the origin.

    Parameters
    ----------
    primary : pyarrow.Table or None
        The table that has one row for each point; None if there is none, or it cannot be read.
    """
    wrong = _key(result, primary) or _inputs(result, store)
    says = "keys follow from kind, options, parameters, code and points"
    ledger.note("files", "provenance", says, "results", f"{where}: {wrong}" if wrong else "")
    if primary is None or "pool" not in result.manifest:
        return
    made = identities(result.manifest["ingredients"], primary)
    if made is not None:
        told = primary.column("point_id").to_pylist()
        lost = [row for row, (a, b) in enumerate(zip(made, told, strict=True)) if a != b]
        text = f"{where}: row {lost[0]} has other parameters than its id was made of" if lost else ""
        says = "follow from the varied values of the rows"
        ledger.note("files", "point ids", says, "points", text, len(made))


def _provenance_of(text: bytes) -> Any:
    try:
        return json.loads(text).get("provenance")
    except ValueError:
        return None


def _key(result: Result, primary: pa.Table | None) -> str:
    told = dict(result.manifest["provenance"])
    if told.get("key") != result.key:
        return f"the key of the provenance is {str(told.get('key'))[:12]}, that of the result {result.key[:12]}"
    plain = {name: value for name, value in told.items() if name not in _ORIGIN}
    form = result.manifest["ingredients"]
    if {**form, "code": form["code"]["digest"]} != plain:
        return "the provenance is not made of the ingredients in the manifest"
    if "pool" not in result.manifest:
        return "" if key_of(plain) == result.key else "the provenance belongs to another key"
    pool = {name: value for name, value in plain.items() if name not in _CHOICE}
    if key_of({**pool, "vary": [axis[0] for axis in form["vary"]]}) != result.manifest["pool"]:
        return "the provenance belongs to another pool of points"
    if primary is None:
        return ""
    ids = primary.column("point_id").to_pylist()
    failed = primary.filter(_failed(primary)).column("point_id").to_pylist()
    head = canonical({"pool": result.manifest["pool"], "failed": sorted(failed)})
    digest = hashlib.sha256(head.encode())
    try:
        digest.update(Ids.of(ids).raw.tobytes())
    except ValueError:
        return "a point id is not twenty hexadecimal digits"
    return "" if digest.hexdigest() == result.key else "the points are not those that the key was made of"


def _failed(table: pa.Table) -> Any:
    import pyarrow as pa
    import pyarrow.compute

    pc: Any = pyarrow.compute
    return pc.fill_null(pc.equal(table.column("status"), pa.scalar("failed")), False)


def _inputs(result: Result, store: Store) -> str:
    for name, key in result.manifest["ingredients"]["inputs"]:
        if not store.has(key):
            return f"its input {name!r} ({key[:12]}) is not stored any more"
    return ""
