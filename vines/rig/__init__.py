"""The rig: measured runs in, an honest verdict out. Tables and arrays in memory; no other sibling room is imported.

Lazy (PEP 562): the names of the room load neither scipy nor a library of a format.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vines.rig._inspect import channel_facts, draw_file, spark
    from vines.rig._read_run import Ingested, read_run
    from vines.rig._recording import ROLES, Recording, RunInfo, Sampled, Uncertain
    from vines.rig._run_folder import find_runs, read_folder
    from vines.rig._template import write_template

__all__ = [
    "ROLES",
    "Ingested",
    "Recording",
    "RunInfo",
    "Sampled",
    "Uncertain",
    "channel_facts",
    "draw_file",
    "find_runs",
    "read_folder",
    "read_run",
    "spark",
    "write_template",
]

_HOME = {
    "ROLES": "_recording",
    "Ingested": "_read_run",
    "Recording": "_recording",
    "RunInfo": "_recording",
    "Sampled": "_recording",
    "Uncertain": "_recording",
    "channel_facts": "_inspect",
    "draw_file": "_inspect",
    "find_runs": "_run_folder",
    "read_folder": "_run_folder",
    "read_run": "_read_run",
    "spark": "_inspect",
    "write_template": "_template",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'vines.rig' has no attribute {name!r}")
    return getattr(import_module(f"vines.rig.{_HOME[name]}"), name)
