"""Stages: the only room that sees physics and stored things. One module a kind, and the functions that users call.

Lazy (PEP 562): a list or a status loads no numba, pyarrow, rerun or matplotlib.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vines.stages.api._asking import checks, list_tables, query, rows_of, save_query, table
    from vines.stages.api._declarable import (
        declaration_schema,
        default_shown,
        describe_kind,
        describe_plot,
        list_kinds,
        list_plots,
    )
    from vines.stages.api._export import export
    from vines.stages.api._finding import all_logs, find_logs, recordings_folder
    from vines.stages.api._found import found
    from vines.stages.api._home import Home, current
    from vines.stages.api._init import init_study
    from vines.stages.api._keeping import Difference, clean, diff, graph
    from vines.stages.api._orbit_log import orbit_log
    from vines.stages.api._parts import load_pipeline, members_of
    from vines.stages.api._reference import reference_kinds, reference_plots
    from vines.stages.api._running import list_pipelines, run, status, status_of_each
    from vines.stages.api._study import Study, study
    from vines.stages.api._warm_up import compile_cold, compile_if_cold, warm_up
    from vines.stages.audit import Verification, verify
    from vines.stages.kinds._register import register_kinds
    from vines.stages.reports._report import report
    from vines.stages.rig._by_hand import Compared, Derived, compare_run, reconstruct_run
    from vines.stages.rig._running import ingest_folder

__all__ = [
    "Compared",
    "Derived",
    "Difference",
    "Home",
    "Study",
    "Verification",
    "all_logs",
    "checks",
    "clean",
    "compare_run",
    "compile_cold",
    "compile_if_cold",
    "current",
    "declaration_schema",
    "default_shown",
    "describe_kind",
    "describe_plot",
    "diff",
    "export",
    "find_logs",
    "found",
    "graph",
    "ingest_folder",
    "init_study",
    "list_kinds",
    "list_pipelines",
    "list_plots",
    "list_tables",
    "load_pipeline",
    "members_of",
    "orbit_log",
    "query",
    "reconstruct_run",
    "recordings_folder",
    "reference_kinds",
    "reference_plots",
    "register_kinds",
    "report",
    "rows_of",
    "run",
    "save_query",
    "status",
    "status_of_each",
    "study",
    "table",
    "verify",
    "warm_up",
]

_HOME = {
    "Study": "api._study",
    "Home": "api._home",
    "current": "api._home",
    "study": "api._study",
    "Verification": "audit",
    "verify": "audit",
    "all_logs": "api._finding",
    "orbit_log": "api._orbit_log",
    "recordings_folder": "api._finding",
    "Compared": "rig._by_hand",
    "Derived": "rig._by_hand",
    "compare_run": "rig._by_hand",
    "Difference": "api._keeping",
    "checks": "api._asking",
    "compile_cold": "api._warm_up",
    "compile_if_cold": "api._warm_up",
    "clean": "api._keeping",
    "declaration_schema": "api._declarable",
    "default_shown": "api._declarable",
    "describe_kind": "api._declarable",
    "describe_plot": "api._declarable",
    "list_kinds": "api._declarable",
    "list_plots": "api._declarable",
    "diff": "api._keeping",
    "export": "api._export",
    "find_logs": "api._finding",
    "found": "api._found",
    "graph": "api._keeping",
    "ingest_folder": "rig._running",
    "init_study": "api._init",
    "list_pipelines": "api._running",
    "list_tables": "api._asking",
    "load_pipeline": "api._parts",
    "members_of": "api._parts",
    "query": "api._asking",
    "reconstruct_run": "rig._by_hand",
    "reference_kinds": "api._reference",
    "reference_plots": "api._reference",
    "register_kinds": "kinds._register",
    "report": "reports._report",
    "rows_of": "api._asking",
    "run": "api._running",
    "save_query": "api._asking",
    "status": "api._running",
    "status_of_each": "api._running",
    "table": "api._asking",
    "warm_up": "api._warm_up",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'vines.stages' has no attribute {name!r}")
    return getattr(import_module(f"vines.stages.{_HOME[name]}"), name)
