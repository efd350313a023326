"""Questions to the catalogue: tables, SQL, checks."""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from vines import schema
from vines.catalogue import connect
from vines.errors import QueryError, UnknownNameError, nearest
from vines.stages.api._home import Home, current
from vines.stages.api._uncomputed import uncomputed

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["checks", "list_tables", "query", "rows_of", "save_query", "table"]


def query(sql: str, *, study: Home | None = None) -> pa.Table:
    """Ask the catalogue in SQL.

    Parameters
    ----------
    sql : str
        One query in DuckDB's dialect over the views of docs/tables.md: one a table over all pinned results, and one a
        stage, named ``"<pipeline>.<stage>"``.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    pyarrow.Table
        With the units of the columns that keep their name; ``.to_pandas()`` makes a data frame.

    Raises
    ------
    QueryError
        If DuckDB cannot answer, or if it is not a single query; one line.

    Examples
    --------
    >>> query("select 1 + 1 as two").to_pylist()
    [{'two': 2}]
    """
    with connect((study or current()).store) as catalogue:
        return catalogue.query(sql)


def table(name: str, *, study: Home | None = None) -> pa.Table:
    """Return all rows of a view of the catalogue.

    Parameters
    ----------
    name : str
        A table such as ``orbits``, or a stage such as ``quickstart.up``.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    pyarrow.Table
        With units as field metadata.

    Warns
    -----
    UserWarning
        If it is empty, such as where nothing was computed yet.

    Raises
    ------
    UnknownNameError
        If there is no such view.
    """
    study = study or current()
    with connect(study.store) as catalogue:
        if name not in catalogue.names and (why := uncomputed(name, study)):
            raise UnknownNameError(why)
        found = catalogue.table(name)
    if not found.num_rows:
        remedy = "'vines run NAME' computes a pipeline, 'vines status' says what there is"
        warnings.warn(f"no result in {study.data} has rows of {name!r} yet; {remedy}", UserWarning, stacklevel=2)
    return found


def list_tables(*, study: Home | None = None) -> list[dict[str, Any]]:
    """Return name, rows and description of the views: the tables, then the single stages."""
    store = (study or current()).store
    known = schema.tables()
    with connect(store) as catalogue:
        counts = {view: catalogue.count(view) for view in (*known, *sorted(set(catalogue.names) - set(known)))}
    return [
        {"view": view, "rows": rows, "description": known[view].description if view in known else "one stage alone"}
        for view, rows in counts.items()
    ]


def rows_of(sql: str, *, study: Home | None = None) -> tuple[list[str], list[tuple[Any, ...]]]:
    """Ask the catalogue and return the names of the columns and the rows; quicker than Arrow for what is only shown.

    Raises
    ------
    QueryError
        If DuckDB cannot answer; one line.
    """
    with connect((study or current()).store) as catalogue:
        return catalogue.fetch(sql)


def save_query(sql: str, out: Path, form: Literal["csv", "parquet"], *, study: Home | None = None) -> None:
    """Ask the catalogue and write the answer to a file, which is replaced as a whole or not at all.

    Raises
    ------
    QueryError
        If DuckDB cannot answer, or the folder of the file does not exist.
    """
    if not out.parent.is_dir():
        raise QueryError(f"{out}: the folder {out.parent} does not exist; make it first")
    with (
        connect((study or current()).store) as catalogue,
        tempfile.TemporaryDirectory(dir=out.parent, prefix=".vines-") as folder,
    ):
        part = Path(folder) / "part"
        catalogue.save(sql, part, form)
        part.replace(out)


def checks(name: str | None = None, *, study: Home | None = None) -> list[dict[str, Any]]:
    """Return what the checks of published values gave.

    Parameters
    ----------
    name : str, optional
        A pipeline or collection; all pipelines that were run if left out.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    list of dict
        The rows of the table ``checks``.

    Raises
    ------
    UnknownNameError
        If there is no such pipeline, or if nothing was checked yet.
    """
    from vines.pipeline import available, members

    study = study or current()
    known = {*available(study.root), *study.store.readable_pins()[0]}
    if name is not None and name not in known:
        raise UnknownNameError(f"unknown pipeline {name!r}: {nearest(name, known)}")
    where = ""
    names: tuple[str, ...] = ()
    if name is not None:
        names = members(name, study.root) if name in available(study.root) else (name,)
        where = f"where pipeline in ({', '.join(repr(each) for each in names)})"
    rows = query(f"select * from checks {where} order by pipeline, stage, point_id", study=study).to_pylist()
    if not rows:
        what = name or "any pipeline"
        if name is not None and not any(_checks(each, study) for each in names):
            raise UnknownNameError(
                f"{name} has no stage of kind 'check', so there is nothing to compare; "
                "declare one with claims = [..] (pipelines/claims.toml), or ask for one that has, as quickstart has"
            )
        raise UnknownNameError(f"nothing has been checked for {what}; run 'vines run {name or 'quickstart'}' first")
    return rows


def _checks(name: str, study: Home) -> bool:
    """Whether a pipeline has a stage that makes checks; one that is only stored may have had one."""
    from vines.pipeline import available
    from vines.stages.api._parts import load_pipeline

    if name not in available(study.root):
        return True
    return any("checks" in stage.kind.tables for stage in load_pipeline(name, study=study).stages.values())
