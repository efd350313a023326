"""The physics of every stored row, table by table, a row group at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vines import schema
from vines.model import PARAMETER_NAMES
from vines.pipeline import kinds
from vines.stages.audit._bifurcations import bifurcation_defects, branch_defects, curve_defects
from vines.stages.audit._defect import Defect
from vines.stages.audit._exits import exit_defects, exit_point_defects, exit_regime_defects
from vines.stages.audit._family import (
    family_attractor_defects,
    family_basin_defects,
    family_bifurcation_defects,
    family_branch_defects,
    family_curve_defects,
    family_impact_defects,
    family_orbit_defects,
    family_point_defects,
    family_transient_defects,
)
from vines.stages.audit._files import check_table
from vines.stages.audit._impacts import POINT_COLUMNS, impact_defects, motion_defects
from vines.stages.audit._orbits import orbit_defects
from vines.stages.audit._others import (
    atlas_defects,
    basin_defects,
    check_defects,
    dimensionless_defects,
    optimum_defects,
    reduced_defects,
)
from vines.stages.audit._points import attractor_defects, point_defects
from vines.stages.audit._rig import comparison_defects, cycle_defects, reconstruction_defects, rig_impact_defects
from vines.stages.audit._rows import Rows
from vines.stages.audit._systems import base_of

if TYPE_CHECKING:
    import pyarrow as pa

    from vines.stages.audit._ledger import Ledger
    from vines.store import Result

__all__ = ["check_physics", "checks", "defects", "describe_row"]

_CHECKS: dict[str, Callable[[Rows], Iterator[Defect]]] = {
    "atlas": atlas_defects,
    "attractors": attractor_defects,
    "basins": basin_defects,
    "bifurcations": bifurcation_defects,
    "branches": branch_defects,
    "checks": check_defects,
    "comparisons": comparison_defects,
    "curves": curve_defects,
    "dimensionless": dimensionless_defects,
    "impacts": impact_defects,
    "optima": optimum_defects,
    "orbits": orbit_defects,
    "points": point_defects,
    "reconstructions": reconstruction_defects,
    "reduced": reduced_defects,
    "rig_cycles": cycle_defects,
    "rig_impacts": rig_impact_defects,
    "transients": partial(family_transient_defects, "transients"),
}
_OF_SYSTEMS: dict[str, Callable[[str, Rows], Iterator[Defect]]] = {
    "attractors": family_attractor_defects,
    "basins": family_basin_defects,
    "bifurcations": family_bifurcation_defects,
    "branches": family_branch_defects,
    "curves": family_curve_defects,
    "impacts": family_impact_defects,
    "orbits": family_orbit_defects,
    "points": family_point_defects,
    "transients": family_transient_defects,
}
"""Of the tables that each system beside the VI-NES has of its own, as the VI-NES calls them."""
_OF_ANY: dict[str, Callable[[Rows], Iterator[Defect]]] = {
    "exit_points": exit_point_defects,
    "exit_regimes": exit_regime_defects,
    "exits": exit_defects,
}
"""Of tables whose checks know nothing of the system, as the VI-NES calls them."""
_WHOLE = ("basins", "exit_regimes")
"""Tables that are checked as a whole: their rows share a sum."""


def check_physics(ledger: Ledger, where: str, result: Result, name: str) -> None:
    """Check all rows of a table of a result.

    Parameters
    ----------
    ledger : Ledger
        Takes what is found.
    where : str
        ``<pipeline>.<stage>`` of the result.
    result : Result
        Its tables can be read and have the columns of their schemas.
    name : str
        The table.
    """
    path = result.folder / f"{name}.parquet"
    motion = _Motion(result) if name == "impacts" and "points" in result.tables else None
    start = 0
    for piece in _pieces(path, whole=base_of(name) in _WHOLE, by_point=motion is not None):
        table = schema.cast(name, piece)  # columns that came later are empty
        check_table(ledger, where, name, table)
        rows = Rows(table)
        _note(ledger, where, name, _fixed(rows, result), rows, start)
        with np.errstate(all="ignore"):  # rows that were tampered with may hold anything
            for defect in defects(name, rows):
                _note(ledger, where, name, defect, rows, start)
            if motion is not None:
                for defect, places in motion.defects(rows):
                    _note(ledger, where, name, defect, rows, start, places)
        start += len(rows)


def describe_row(table: pa.Table, place: int) -> str:
    """Return the parameters by which a reader finds a row."""
    row: dict[str, Any] = table.slice(place, 1).to_pylist()[0]
    told = [f"{name} = {row[name]:.10g}" for name in PARAMETER_NAMES[:3] if isinstance(row.get(name), float)]
    return ", ".join([*told, f"point_id {row['point_id']}"])


def checks(name: str) -> bool:
    """Say whether there is anything that rows of a table are checked for."""
    base = base_of(name)
    return name in _CHECKS or base in _OF_ANY or (base != name and base in _OF_SYSTEMS)


def defects(name: str, rows: Rows) -> Iterator[Defect]:
    """Return the checks of rows of a table, those of its system where that has it for its own."""
    if name in _CHECKS:
        return _CHECKS[name](rows)
    base = base_of(name)
    if base in _OF_ANY:
        return _OF_ANY[base](rows)
    return _OF_SYSTEMS[base](name, rows) if base != name and base in _OF_SYSTEMS else iter(())


def _note(
    ledger: Ledger,
    where: str,
    name: str,
    defect: Defect,
    rows: Rows,
    start: int,
    places: Any = None,
) -> None:
    line = ledger.line(name, defect.name, defect.says, "rows", defect.allowed)
    first = ledger.values(line, defect.values)
    if first >= 0 and not line.first:
        at = int(places[first]) if places is not None else first
        off = defect.values[first]
        amount = f"off by {off:.2g}, allowed {defect.allowed:g}" if np.isfinite(off) else "it does not hold"
        line.first = f"{where}: {name} row {start + at} ({describe_row(rows.table, at)}): {amount}"


def _fixed(rows: Rows, result: Result) -> Defect:
    """Return the check that parameters which do not vary are those of the declaration."""
    form = result.manifest["ingredients"]
    spec = kinds().get(form["kind"])  # a package that brought it may be gone
    varied = {axis[0] for axis in form["vary"]} | set(spec.scaled if spec is not None else ())
    wrong = np.zeros(len(rows))
    for parameter, value in form["params"].items():
        if parameter not in varied and rows.has(parameter) and parameter in PARAMETER_NAMES:
            wrong[rows[parameter] != value] = np.inf
    return Defect("declared parameters", "those that do not vary are as declared", 0.0, wrong)


def _pieces(path: Path, *, whole: bool, by_point: bool) -> Iterator[pa.Table]:
    """Yield the rows of a file, a row group at a time; with `by_point` the rows of a point stay together."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    with pq.ParquetFile(path) as file:
        if whole or file.num_row_groups <= 1:
            yield file.read()
            return
        kept: Any = None
        for number in range(file.num_row_groups):
            table: Any = file.read_row_group(number)
            if kept is not None:
                table = pa.concat_tables([kept, table])
            if by_point and number < file.num_row_groups - 1:
                ids = table.column("point_id")
                cut = table.num_rows
                while cut and ids[cut - 1] == ids[table.num_rows - 1]:
                    cut -= 1
                table, kept = table.slice(0, cut), table.slice(cut)
            if table.num_rows:
                yield table


class _Motion:
    """The points and attractors that impacts belong to."""

    def __init__(self, result: Result) -> None:
        import pyarrow.parquet as pq

        self.points = Rows(pq.read_table(result.folder / "points.parquet", columns=list(POINT_COLUMNS)))
        self.others: Rows | None = None
        if "attractors" in result.tables:
            columns = ["point_id", "attractor", "sticks_per_period"]
            self.others = Rows(pq.read_table(result.folder / "attractors.parquet", columns=columns))

    def defects(self, rows: Rows) -> Iterator[tuple[Defect, Any]]:
        """Yield the checks of the motion between impacts."""
        which = _find(rows.table.column("point_id"), self.points.table.column("point_id"))
        flying = which >= 0
        quiet = (self.points["sticks_per_period"] == 0) & (self.points.text("status") == "ok")
        flying[flying] = quiet[which[flying]]
        if self.others is not None:
            at = _find(_names(rows), _names(self.others))
            random = rows["attractor"] > 0
            flying = np.where(random, (at >= 0) & (self.others["sticks_per_period"][at] == 0), flying)
        yield from motion_defects(rows, self.points, which, flying)


def _find(wanted: Any, known: Any) -> Any:
    """Return the place of each wanted text among the known ones, -1 if it is not there."""
    import pyarrow.compute

    pc: Any = pyarrow.compute
    found = pc.index_in(wanted.combine_chunks(), known.combine_chunks())
    return np.array(pc.fill_null(found, -1), dtype=np.int64)


def _names(rows: Rows) -> Any:
    """Return a text that names the attractor of each row."""
    import pyarrow.compute

    pc: Any = pyarrow.compute
    table: Any = rows.table
    return pc.binary_join_element_wise(table.column("point_id"), table.column("attractor").cast("string"), "/")
