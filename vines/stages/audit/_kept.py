"""Points behind a result: one row each, and parts of the pool that are what was written, by the code of the key."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vines.store import Result, Store

if TYPE_CHECKING:
    import pyarrow as pa

    from vines.stages.audit._ledger import Ledger

__all__ = ["check_pool", "check_rows"]


def check_rows(ledger: Ledger, where: str, result: Result, primary: pa.Table) -> None:
    """Check that a result of points has one row for each of its points.

    Parameters
    ----------
    primary : pyarrow.Table
        The table that should have it.
    """
    if "pool" not in result.manifest:
        return
    wanted = result.manifest["points"]
    ids = set(primary.column("point_id").to_pylist())
    wrong = primary.num_rows != wanted or len(ids) != wanted
    text = (
        f"{where}: {primary.num_rows} rows of {len(ids)} points where {wanted} points were asked for" if wrong else ""
    )
    ledger.note("files", "rows", "one for each point that was asked for", "results", text)


def check_pool(ledger: Ledger, where: str, result: Result, store: Store) -> None:
    """Check the parts of the pool that a result was put together from."""
    if "pool" not in result.manifest:
        return
    pool = store.pool(result.manifest["pool"])
    damaged = pool.examine()
    says = "checksums as they were written"
    parts = pool.parts()
    if parts:
        ledger.note("files", "pools", says, "parts", "", len(parts))
    for why in damaged.values():
        ledger.note("files", "pools", says, "parts", f"{where}: {why}")
    code = result.manifest["ingredients"]["code"]["digest"]
    for part in parts:
        if part.code:
            other = f"{where}: {part.folder} was computed by other code than its key says" if part.code != code else ""
            ledger.note("files", "code", "of the process that computed, as in the key", "parts", other)
