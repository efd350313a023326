"""Whether rows that name others find them: impacts their point, orbits their branch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vines.stages.audit._systems import base_of

if TYPE_CHECKING:
    from vines.stages.audit._ledger import Ledger
    from vines.store import Result

__all__ = ["check_links"]

_LINKS = (
    ("impacts", "point_id", "points", "point_id"),
    ("attractors", "point_id", "points", "point_id"),
    ("attractors", "point_id", "exit_points", "point_id"),
    ("exit_regimes", "point_id", "exit_points", "point_id"),
    ("exits", "point_id", "exit_points", "point_id"),
    ("orbits", "branch_id", "branches", "branch_id"),
    ("bifurcations", "branch_id", "branches", "branch_id"),
    ("branches", "parent", "branches", "branch_id"),
    ("rig_channels", "run_id", "rig_runs", "run_id"),
    ("rig_cycles", "run_id", "comparisons", "run_id"),
    ("rig_impacts", "run_id", "reconstructions", "run_id"),
)


def check_links(ledger: Ledger, where: str, result: Result) -> None:
    """Check the links between the tables of a result, and that the primary table names each row once."""
    import pyarrow.compute
    import pyarrow.parquet as pq

    pc: Any = pyarrow.compute

    def column(table: str, name: str) -> Any:
        return pq.read_table(result.folder / f"{table}.parquet", columns=[name]).column(name)

    own = {base_of(table): table for table in result.tables}
    for base, name, beside, target in _LINKS:
        if base not in own or beside not in own:
            continue
        table, other = own[base], own[beside]
        values = column(table, name)
        lost = pc.and_(
            pc.invert(pc.is_in(values, value_set=column(other, target).combine_chunks())), pc.is_valid(values)
        )
        place = pc.index(lost, True).as_py()
        text = f"{where}: {table} row {place} names {name} {values[place]}, which is not there" if place >= 0 else ""
        ledger.note(table, "links", f"{name} is in {other}", "rows", text, len(values))
    for table in result.tables[:1]:
        ids = column(table, "point_id")
        twice = len(ids) - pc.count_distinct(ids).as_py()
        text = f"{where}: {twice} rows of {table} repeat the id of another" if twice else ""
        ledger.note(table, "point ids", "each once", "rows", text, len(ids))
