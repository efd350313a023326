"""Stages of the whole shape: one call of the body makes the result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import CodeError, SchemaError, StoreError
from vines.pipeline._demand import Checked, Demand, demand
from vines.pipeline._jobs import Batch, Input, Range, Spread, WholeJob, one_by_one
from vines.pipeline._plan import Planner
from vines.pipeline._worker import body_of
from vines.store import PICTURES, Result, Store, describe_table, write_parquet

if TYPE_CHECKING:
    from vines.pipeline._declaration import Pipeline
    from vines.pipeline._plan import Prepared

__all__ = ["WholeTask", "compute_whole", "stored_inputs", "whole_task"]


@dataclass(frozen=True, slots=True)
class WholeTask:
    """A stage of the whole shape, ready to be computed here or in a worker process.

    Attributes
    ----------
    kind, body : str
        Its kind, and where the body of that is.
    tables : tuple of str
        The tables that it makes.
    pictures : bool
        Whether it makes pictures.
    job : WholeJob
        What the body is given; the folder is chosen where it is computed.
    key, form : str, dict
        The key of the result, and what it was made from.
    data : Path
        The folder of the store.
    replace : bool
        Whether to replace a result of the same key.
    demand : Demand
        What a process has to prove before the result is stored.
    """

    kind: str
    body: str
    tables: tuple[str, ...]
    pictures: bool
    job: WholeJob
    key: str
    form: dict[str, Any]
    data: Path
    replace: bool
    demand: Demand


def whole_task(
    prepared: Prepared, store: Store, planner: Planner, *, replace: bool, token: tuple[Path, str] | None = None
) -> WholeTask:
    """Gather what a stage is computed from.

    Parameters
    ----------
    prepared : Prepared
        The stage; the stages that it needs have results.
    store : Store
        Where the result goes.
    planner : Planner
        Knows the keys of the inputs.
    replace : bool
        Whether to replace a result of the same key.
    token : tuple of (Path, str), optional
        What proves that a process sees the store, where others have started it.
    """
    stage = prepared.stage
    key = prepared.request
    job = WholeJob(
        options=stage.options,
        params=dict(stage.params),
        ranges={axis.name: Range(float(axis.ends[0]), float(axis.ends[1])) for axis in stage.axes},
        inputs={need: _input(need, store.result(planner.keys[need])) for need in stage.needs},
        files=prepared.ingredients.files,
        folder=Path(),
        root=planner.pipeline.root,
        cache=store.cache,
        provenance=prepared.ingredients.provenance(key),
    )
    spec = stage.kind
    return WholeTask(
        kind=spec.name,
        body=spec.body,
        tables=spec.tables,
        pictures=spec.pictures,
        job=job,
        key=key,
        form=prepared.ingredients.form,
        data=store.data,
        replace=replace,
        demand=demand(prepared.ingredients, store, token),
    )


def compute_whole(task: WholeTask, spread: Spread = one_by_one) -> str:
    """Compute a stage and store its result; return in one line why that failed, empty if it did not.

    Parameters
    ----------
    task : WholeTask
        The stage.
    spread : Spread
        Shares the work of the body among processes, if the body asks for it.

    Raises
    ------
    CodeError
        If a process has imported other code than that of the key.
    """

    def share(function: Callable[[Any], Any], items: Sequence[Any]) -> list[Any]:
        return spread(Checked(function, task.demand), items)

    store = Store(task.data)
    with store.staging() as place:
        folder = place / "result"
        folder.mkdir()
        job = replace(task.job, folder=folder, spread=share)
        try:
            for need in job.inputs.values():
                store.result(need.key).check_forms()
            body = body_of(task.body)
            task.demand.check_code()
            batch = body(job)
            task.demand.check_code()  # the body may have imported more
            about = _write(task, batch, folder, job.provenance)
        except CodeError:
            raise
        except Exception as error:  # whatever it is, the other stages go on
            text = (str(error).splitlines() or [""])[0]
            return f"{type(error).__name__}: {text}"
        manifest = {
            "kind": task.kind,
            "ingredients": task.form,
            "provenance": job.provenance,
            "points": 1,
            "failed": 0,
            "tables": about,
            "logs": [
                {"point_id": point, "file": name, "params": {}, "name": None} for point, name in batch.logs.items()
            ],
        }
        store.commit(task.key, folder, manifest, replace=task.replace)
    return ""


def stored_inputs(pipeline: Pipeline, name: str, store: Store) -> dict[str, Input]:
    """Return what the results that a stage needs hold now, without computing anything.

    Parameters
    ----------
    pipeline : Pipeline
        As declared.
    name : str
        One of its stages.
    store : Store
        Where results are kept.

    Raises
    ------
    StoreError
        If a needed stage is not computed as it is declared now.
    """
    planner = Planner(pipeline, store)
    needs = pipeline.stages[name].needs
    for each in pipeline.order:
        if each == name:
            break
        plan = planner.plan(each)
        if each in needs and plan.state != "up_to_date":
            raise StoreError(
                f"{pipeline.name}.{each} is not computed as it is declared ({plan.reason}); 'vines run {pipeline.name} "
                f"{each}' does it"
            )
    return {need: _input(need, store.result(planner.keys[need])) for need in needs}


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


def _write(task: WholeTask, batch: Batch, folder: Path, provenance: dict[str, Any]) -> dict[str, Any]:
    unknown = set(batch.tables) - set(task.tables)
    if unknown:
        raise SchemaError(f"{task.body}: returned table {min(unknown)!r}, which its kind does not name")
    if task.pictures and not any((folder / name).is_file() for name in PICTURES):
        raise SchemaError(f"{task.body}: left none of {', '.join(PICTURES)} in its folder")
    about = {}
    for name in task.tables:
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
