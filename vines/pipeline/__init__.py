"""Pipelines: declarations, kinds of stages, keys, points, plans, and the engine. Knows no physics."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vines.pipeline._axes import Axis
    from vines.pipeline._builder import Declaration, span
    from vines.pipeline._code import CodeDigests
    from vines.pipeline._collection import Collection, load_collection, members
    from vines.pipeline._declaration import Carry, Pipeline, Refine, Stage
    from vines.pipeline._events import Event, RunSummary, StageOutcome, silent
    from vines.pipeline._files import available, file_of, find
    from vines.pipeline._form import json_schema
    from vines.pipeline._graph import mermaid, mermaid_of_all
    from vines.pipeline._include import with_included
    from vines.pipeline._ingredients import what_changed
    from vines.pipeline._jobs import Batch, Input, Job, Point, Points, Range, WholeJob
    from vines.pipeline._journal import Journal
    from vines.pipeline._kinds import KINDS, Kind, kind, kinds, register
    from vines.pipeline._plan import StagePlan, code_digests, plan, pool_keys
    from vines.pipeline._reading import load
    from vines.pipeline._run import run_pipeline
    from vines.pipeline._shard import Shard

__all__ = [
    "KINDS",
    "Axis",
    "Batch",
    "Carry",
    "CodeDigests",
    "Collection",
    "Declaration",
    "Event",
    "Input",
    "Job",
    "Journal",
    "Kind",
    "Pipeline",
    "Point",
    "Points",
    "Range",
    "Refine",
    "RunSummary",
    "Shard",
    "Stage",
    "StageOutcome",
    "StagePlan",
    "WholeJob",
    "available",
    "code_digests",
    "file_of",
    "find",
    "json_schema",
    "kind",
    "kinds",
    "load",
    "load_collection",
    "members",
    "mermaid",
    "mermaid_of_all",
    "plan",
    "pool_keys",
    "register",
    "run_pipeline",
    "silent",
    "span",
    "what_changed",
    "with_included",
]

_HOME = {
    "Axis": "vines.pipeline._axes",
    "Batch": "vines.pipeline._jobs",
    "CodeDigests": "vines.pipeline._code",
    "Carry": "vines.pipeline._declaration",
    "Collection": "vines.pipeline._collection",
    "Declaration": "vines.pipeline._builder",
    "Event": "vines.pipeline._events",
    "Input": "vines.pipeline._jobs",
    "Job": "vines.pipeline._jobs",
    "Journal": "vines.pipeline._journal",
    "KINDS": "vines.pipeline._kinds",
    "Kind": "vines.pipeline._kinds",
    "Pipeline": "vines.pipeline._declaration",
    "Point": "vines.pipeline._jobs",
    "Points": "vines.pipeline._jobs",
    "Range": "vines.pipeline._jobs",
    "Refine": "vines.pipeline._declaration",
    "RunSummary": "vines.pipeline._events",
    "Shard": "vines.pipeline._shard",
    "Stage": "vines.pipeline._declaration",
    "StageOutcome": "vines.pipeline._events",
    "StagePlan": "vines.pipeline._plan",
    "WholeJob": "vines.pipeline._jobs",
    "available": "vines.pipeline._files",
    "code_digests": "vines.pipeline._plan",
    "file_of": "vines.pipeline._files",
    "find": "vines.pipeline._files",
    "json_schema": "vines.pipeline._form",
    "kind": "vines.pipeline._kinds",
    "kinds": "vines.pipeline._kinds",
    "load": "vines.pipeline._reading",
    "load_collection": "vines.pipeline._collection",
    "members": "vines.pipeline._collection",
    "mermaid": "vines.pipeline._graph",
    "mermaid_of_all": "vines.pipeline._graph",
    "plan": "vines.pipeline._plan",
    "pool_keys": "vines.pipeline._plan",
    "register": "vines.pipeline._kinds",
    "run_pipeline": "vines.pipeline._run",
    "silent": "vines.pipeline._events",
    "span": "vines.pipeline._builder",
    "what_changed": "vines.pipeline._ingredients",
    "with_included": "vines.pipeline._include",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'vines.pipeline' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
