"""Stages: the only room that sees physics and stored things. One module a kind, and the functions that users call.

Lazy (PEP 562): a list or a status loads no numba, pyarrow, rerun or matplotlib.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vines.stages._asking import checks, list_tables, query, rows_of, save_query, table
    from vines.stages._export import export
    from vines.stages._finding import all_logs, find_logs, recordings_folder
    from vines.stages._found import found
    from vines.stages._keeping import Difference, clean, declaration_schema, diff, graph
    from vines.stages._kinds import register_kinds
    from vines.stages._opening import open_store
    from vines.stages._orbit_log import orbit_log
    from vines.stages._parts import load_pipeline, members_of
    from vines.stages._report import report
    from vines.stages._rig_by_hand import Compared, Derived, compare_run, reconstruct_run
    from vines.stages._rig_running import ingest_folder
    from vines.stages._running import list_pipelines, run, status, status_of_each
    from vines.stages._study import init_study
    from vines.stages._warm_up import compile_cold, compile_if_cold, warm_up
    from vines.stages.audit import Verification, verify

__all__ = [
    "Compared",
    "Derived",
    "Difference",
    "Verification",
    "all_logs",
    "checks",
    "clean",
    "compare_run",
    "compile_cold",
    "compile_if_cold",
    "declaration_schema",
    "diff",
    "export",
    "find_logs",
    "found",
    "graph",
    "ingest_folder",
    "init_study",
    "list_pipelines",
    "list_tables",
    "load_pipeline",
    "members_of",
    "open_store",
    "orbit_log",
    "query",
    "reconstruct_run",
    "recordings_folder",
    "register_kinds",
    "report",
    "rows_of",
    "run",
    "save_query",
    "status",
    "status_of_each",
    "table",
    "verify",
    "warm_up",
]

_HOME = {
    "Verification": "audit",
    "verify": "audit",
    "all_logs": "_finding",
    "orbit_log": "_orbit_log",
    "recordings_folder": "_finding",
    "Compared": "_rig_by_hand",
    "Derived": "_rig_by_hand",
    "compare_run": "_rig_by_hand",
    "Difference": "_keeping",
    "checks": "_asking",
    "compile_cold": "_warm_up",
    "compile_if_cold": "_warm_up",
    "clean": "_keeping",
    "declaration_schema": "_keeping",
    "diff": "_keeping",
    "export": "_export",
    "find_logs": "_finding",
    "found": "_found",
    "graph": "_keeping",
    "ingest_folder": "_rig_running",
    "init_study": "_study",
    "list_pipelines": "_running",
    "list_tables": "_asking",
    "load_pipeline": "_parts",
    "members_of": "_parts",
    "open_store": "_opening",
    "query": "_asking",
    "reconstruct_run": "_rig_by_hand",
    "register_kinds": "_kinds",
    "report": "_report",
    "rows_of": "_asking",
    "run": "_running",
    "save_query": "_asking",
    "status": "_running",
    "status_of_each": "_running",
    "table": "_asking",
    "warm_up": "_warm_up",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'vines.stages' has no attribute {name!r}")
    return getattr(import_module(f"vines.stages.{_HOME[name]}"), name)
