"""Points computed again by the body of their stage, and starts of basins by settling from them."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vines import schema
from vines.model import with_all_balls
from vines.stages.audit._compare import (
    TOLERANCE,
    Comparison,
    compare_rows,
    compare_within_errors,
    stored_row,
)
from vines.stages.audit._exits import compare_exits
from vines.stages.audit._systems import base_of, kind_of, parameters_of_row, start_names

if TYPE_CHECKING:
    from vines.attractors import Attractor
    from vines.store import Result

__all__ = ["PointsAgain", "start_again"]

_REGULAR = ("periodic", "no_impact")
_PROMPT = 600
"""Forcing periods within which a start comes to its attractor without a chaotic transient."""


class PointsAgain:
    """Computes points again; each only once, though several of its rows may be drawn."""

    def __init__(self) -> None:
        self._chosen: dict[str, str] = {}
        self._known: dict[tuple[str, str], tuple[dict[str, list[dict[str, Any]]], dict[str, list[dict[str, Any]]]]] = {}

    @staticmethod
    def can(result: Result) -> bool:
        """Say whether points of this result can be computed again from their rows."""
        spec = kind_of(result)
        return spec.again in ("points", "long_points") and set(result.tables) <= set(spec.tables)

    def passes_over(self, result: Result, table: str, place: int) -> bool:
        """Say whether a row is of a point that takes long, and is not the one of its result that was drawn first."""
        if kind_of(result).again != "long_points":
            return False
        point = stored_row(result, table, place)["point_id"]
        return self._chosen.setdefault(result.key, point) != point

    def compare(self, result: Result, table: str, place: int) -> Comparison:
        """Compute the point of a row again and compare the rows that it has in the table.

        Of a point that failed, or that is not periodic, there is nothing to compare but the row of ``points``.
        """
        point = stored_row(result, table, place)["point_id"]
        key = (result.key, point)
        comparison = Comparison()
        primary = _rows_of(result, point, result.tables[0])[0]
        regular = primary.get("regime") is None or (primary["settled"] and primary["regime"] in _REGULAR)
        if primary.get("status") == "failed" or not (regular or table == result.tables[0]):
            return comparison
        if key not in self._known:
            stored = {name: _rows_of(result, point, name) for name in result.tables}
            self._known[key] = (stored, _compute(result, primary))
        stored, again = self._known[key]
        if base_of(result.tables[0]) == "exit_points":
            compare_exits(comparison, table, stored, again)
            return comparison
        if not regular:
            compare_within_errors(comparison, primary, again[table][0], names=_given(result, primary))
            return comparison
        # the impacts of other attractors at the point may be chaotic
        ours, theirs = (
            [row for row in rows[table] if base_of(table) != "impacts" or not row.get("attractor")]
            for rows in (stored, again)
        )
        comparison.same("number of rows", len(ours), len(theirs))
        for one, other in zip(ours, theirs, strict=False):
            compare_rows(comparison, table, one, other, leave=() if _settled(one) else _rough(table))
        return comparison


def _rough(table: str) -> list[str]:
    """Return the columns of a table of attractors that say different things of each run on chaos."""
    spec = schema.table(table)
    given = {each.name for each in with_all_balls(spec.system).parameters}
    return [c.name for c in spec.columns if c.dtype == "float64" and c.name not in given]


def _settled(row: dict[str, Any]) -> bool:
    """Whether a row of ``attractors`` is periodic; rows of other tables count as such here."""
    return "fraction" not in row or row["regime"] in _REGULAR


def _given(result: Result, row: dict[str, Any]) -> list[str]:
    """Return the columns of a row of points that are not computed: its parameters and its start."""
    parameters = [name for name in kind_of(result).parameters if row.get(name) is not None]
    return [*parameters, *start_names(row)]


def _rows_of(result: Result, point: str, table: str) -> list[dict[str, Any]]:
    """Return all rows of a point in a table."""
    import pyarrow.parquet as pq

    path = result.folder / f"{table}.parquet"
    return pq.read_table(path, filters=[("point_id", "=", point)], use_threads=False).to_pylist()


def _compute(result: Result, row: dict[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Call the body of the stage for one point, which starts where its row says."""
    import msgspec

    from vines.pipeline import Job, Points, body_of
    from vines.store import Ids

    form: Any = result.manifest["ingredients"]
    spec = kind_of(result)
    names = [*(axis[0] for axis in form["vary"]), *form.get("link", ())]
    varied = {name: np.array([row[name]]) for name in names}
    fixed = {name: form["params"].get(name, 0.0) for name in spec.parameters}
    carry = None if form["carry"] is None else form["carry"]["axis"]
    with tempfile.TemporaryDirectory() as folder:
        job = Job(
            options=msgspec.convert(form["options"], spec.options),
            points=Points(fixed, varied, Ids.of([row["point_id"]])),
            carry=carry,
            start={f"end_{name}": row[name] for name in start_names(row)} if carry is not None else None,
            folder=Path(folder),
            provenance=result.manifest["provenance"],
        )
        batch = body_of(spec.body)(job)
    return {name: schema.cast(name, batch.tables.get(name, ())).to_pylist() for name in result.tables}


def start_again(result: Result, table: str, place: int) -> Comparison:
    """Settle from the start of a cell of ``basins``, or the end state of an attractor, and compare what it comes to.

    Starts that came to a periodic motion late, or never, are not compared: where chaos is a long transient, rounding
    decides when it ends.
    """
    from vines.attractors import SAME, Motion, apart

    row, system = stored_row(result, table, place), schema.table(table).system
    listed = result.table(schema.system_table(system, "attractors")).to_pylist()
    wanted = {each["attractor"]: each for each in listed}[row["attractor"]]
    cell = base_of(table) == "basins"
    comparison = Comparison()
    regular = wanted["regime"] in _REGULAR
    if row["attractor"] < 0 or (cell and not (regular and row["periods"] <= _PROMPT)):
        return comparison
    p = parameters_of_row(system, row)
    found = _from_cell(result, p, row) if cell else _from_end(p, row)
    if found is None:
        comparison.same("attractor", row["attractor"], -1)
        return comparison
    comparison.same("periodic motion", regular, found.regime in _REGULAR)
    if not regular or comparison.wrong:
        return comparison
    if math.isinf(apart(Motion.of_row(wanted), Motion.of(found))):
        comparison.same("name", wanted["name"], found.name)
    allowed = SAME if cell else TOLERANCE
    for name in ("max_abs_x1", "kinetic_ratio"):
        if name not in wanted:
            continue  # what is shaken has no displacement of its own
        value = getattr(found.measures, name)
        comparison.number(name, wanted[name], value, allowed * (1 + abs(wanted[name] or 0.0)))
    return comparison


def _from_end(p: Any, row: dict[str, Any]) -> Attractor:
    from vines.attractors import settle_from

    return settle_from(p, {each.name: row[f"end_{each.name}"] for each in p.system.start}, settle=0)


def _from_cell(result: Result, p: Any, row: dict[str, Any]) -> Attractor | None:
    from vines.attractors import basins

    options: Any = result.manifest["ingredients"]["options"]
    coordinates = ((row["x_name"], [row["x"]]), (row["y_name"], [row["y"]]))
    waiting = {name: options[name] for name in ("settle", "patience", "watch")}
    at_zero = {each.name: 0.0 for each in p.system.start}
    given = p.system.started(at_zero | options["start"])
    others = {name: value for name, value in given.items() if name not in (row["x_name"], row["y_name"])}
    found = basins(p, *coordinates, others=others, **waiting)
    return found.attractors[found.label[0]] if found.label[0] >= 0 else None
