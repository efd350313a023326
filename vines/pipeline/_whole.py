"""Stages of the whole shape: one call of the body makes the result."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import SchemaError
from vines.pipeline._jobs import Batch, Input, Range, Spread, WholeJob
from vines.pipeline._worker import body_of
from vines.store import Result, Store, describe_table, write_parquet

if TYPE_CHECKING:
    from vines.pipeline._plan import Planner, Prepared

__all__ = ["compute_whole"]

_PICTURES = ("picture.png", "picture.svg")


def compute_whole(prepared: Prepared, store: Store, planner: Planner, spread: Spread, *, replace: bool) -> str:
    """Compute a stage and store its result; return in one line why that failed, empty if it did not.

    Parameters
    ----------
    prepared : Prepared
        The stage; the stages that it needs have results.
    store : Store
        Where the result goes.
    planner : Planner
        Knows the keys of the inputs.
    spread : Spread
        Shares the work of the body among processes, if the body asks for it.
    replace : bool
        Whether to replace a result of the same key.
    """
    stage = prepared.stage
    key = prepared.request
    provenance = prepared.ingredients.provenance(key)
    with store.staging() as place:
        folder = place / "result"
        folder.mkdir()
        job = WholeJob(
            options=stage.options,
            params=dict(stage.params),
            ranges={axis.name: Range(float(axis.ends[0]), float(axis.ends[1])) for axis in stage.axes},
            inputs={need: _input(need, store.result(planner.keys[need])) for need in stage.needs},
            files=prepared.ingredients.files,
            folder=folder,
            provenance=provenance,
            spread=spread,
        )
        try:
            for need in stage.needs:
                store.result(planner.keys[need]).check_forms()
            batch = body_of(stage.kind.body)(job)
            about = _write(prepared, batch, folder, provenance)
        except Exception as error:  # whatever it is, the other stages go on
            text = (str(error).splitlines() or [""])[0]
            return f"{type(error).__name__}: {text}"
        manifest = {
            "kind": stage.kind.name,
            "ingredients": prepared.ingredients.form,
            "provenance": provenance,
            "points": 1,
            "failed": 0,
            "tables": about,
            "logs": [
                {"point_id": point, "file": name, "params": {}, "name": None} for point, name in batch.logs.items()
            ],
        }
        store.commit(key, folder, manifest, replace=replace)
    return ""


def _input(name: str, result: Result) -> Input:
    form = result.manifest["ingredients"]
    carry = form["carry"] or {}
    return Input(
        name=name,
        kind=result.manifest["kind"],
        key=result.key,
        params=dict(form["params"]),
        axes=tuple(axis[0] for axis in form["vary"]),
        tables=result.tables,
        logs=result.logs,
        folder=result.folder,
        carried=carry.get("axis", ""),
        direction=carry.get("direction", ""),
    )


def _write(prepared: Prepared, batch: Batch, folder: Path, provenance: dict[str, Any]) -> dict[str, Any]:
    spec = prepared.stage.kind
    unknown = set(batch.tables) - set(spec.tables)
    if unknown:
        raise SchemaError(f"{spec.body}: returned table {min(unknown)!r}, which its kind does not name")
    if spec.pictures:
        missing = [name for name in _PICTURES if not (folder / name).is_file()]
        if missing:
            raise SchemaError(f"{spec.body}: left no {missing[0]} in its folder")
    about = {}
    for name in spec.tables:
        rows = _numbered(batch.tables.get(name, ()))
        count = write_parquet(folder / f"{name}.parquet", name, rows, provenance=provenance)
        about[name] = describe_table(name, count)
    return about


def _numbered(rows: Any) -> Any:
    """Give rows without ids their numbers."""
    import pyarrow as pa

    if isinstance(rows, pa.Table):
        table: Any = rows
        if "point_id" in table.column_names:
            return table
        ids = pa.array([f"{i:06d}" for i in range(table.num_rows)], type=pa.string())
        return table.add_column(0, "point_id", ids)
    return [row if "point_id" in row else {"point_id": f"{i:06d}", **row} for i, row in enumerate(rows)]
