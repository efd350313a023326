"""The rig: measured runs in, an honest verdict out. Tables and arrays in memory; no other sibling room is imported.

Lazy (PEP 562): the names of the room load neither scipy nor a library of a format.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vines.rig._compare import Calibration, calibrate, compare, compare_all
    from vines.rig._inspect import channel_facts, draw_file, spark
    from vines.rig._keep import load_reconstruction, save_reconstruction
    from vines.rig._match import Candidate
    from vines.rig._match_ring_downs import match_ring_downs
    from vines.rig._model import Predicted
    from vines.rig._read_run import Ingested, read_run
    from vines.rig._reconstruct import reconstruct
    from vines.rig._reconstruction import QUANTITIES, Finding, Reconstruction
    from vines.rig._recording import ROLES, Recording, RunInfo, Sampled, Uncertain
    from vines.rig._ring_down import RingDown, ring_down
    from vines.rig._run_folder import find_runs, read_folder
    from vines.rig._template import write_template
    from vines.rig._verdict import VERDICTS, Comparison, Likeness

__all__ = [
    "QUANTITIES",
    "ROLES",
    "VERDICTS",
    "Calibration",
    "Candidate",
    "Comparison",
    "Finding",
    "Ingested",
    "Likeness",
    "Predicted",
    "Reconstruction",
    "Recording",
    "RingDown",
    "RunInfo",
    "Sampled",
    "Uncertain",
    "calibrate",
    "channel_facts",
    "compare",
    "compare_all",
    "draw_file",
    "find_runs",
    "load_reconstruction",
    "match_ring_downs",
    "read_folder",
    "read_run",
    "reconstruct",
    "ring_down",
    "save_reconstruction",
    "spark",
    "write_template",
]

_HOME = {
    "QUANTITIES": "_reconstruction",
    "ROLES": "_recording",
    "VERDICTS": "_verdict",
    "Calibration": "_compare",
    "Candidate": "_match",
    "Comparison": "_verdict",
    "Finding": "_reconstruction",
    "Ingested": "_read_run",
    "Likeness": "_verdict",
    "Predicted": "_model",
    "Reconstruction": "_reconstruction",
    "Recording": "_recording",
    "RingDown": "_ring_down",
    "RunInfo": "_recording",
    "Sampled": "_recording",
    "Uncertain": "_recording",
    "calibrate": "_compare",
    "channel_facts": "_inspect",
    "compare": "_compare",
    "compare_all": "_compare",
    "draw_file": "_inspect",
    "find_runs": "_run_folder",
    "load_reconstruction": "_keep",
    "match_ring_downs": "_match_ring_downs",
    "read_folder": "_run_folder",
    "read_run": "_read_run",
    "reconstruct": "_reconstruct",
    "ring_down": "_ring_down",
    "save_reconstruction": "_keep",
    "spark": "_inspect",
    "write_template": "_template",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'vines.rig' has no attribute {name!r}")
    return getattr(import_module(f"vines.rig.{_HOME[name]}"), name)
