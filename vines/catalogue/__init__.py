"""The catalogue: what is pinned now, as views of an in-memory DuckDB."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vines.catalogue._catalogue import Catalogue, connect, connect_tables
    from vines.catalogue._diff import ColumnDifference, TableDifference, compare_tables
    from vines.catalogue._export import Collected, export_results
    from vines.catalogue._views import stage_results

__all__ = [
    "Catalogue",
    "Collected",
    "ColumnDifference",
    "TableDifference",
    "compare_tables",
    "connect",
    "connect_tables",
    "export_results",
    "stage_results",
]

_HOMES = {
    "Catalogue": "vines.catalogue._catalogue",
    "Collected": "vines.catalogue._export",
    "export_results": "vines.catalogue._export",
    "stage_results": "vines.catalogue._views",
    "ColumnDifference": "vines.catalogue._diff",
    "TableDifference": "vines.catalogue._diff",
    "compare_tables": "vines.catalogue._diff",
    "connect": "vines.catalogue._catalogue",
    "connect_tables": "vines.catalogue._catalogue",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
