"""The rig: measured runs in, an honest verdict out. Tables and arrays in memory; no other sibling room is imported.

Its rooms, from below: `formats` reads files of recorders, `ingest` run folders; `fit` has the oscillator's motion at
given impacts, `impacts` finds these; `ball` and `quantities` say what follows, `verdict` lays that beside the model.
`records` is what is kept of a run, `synth` a rig to test all that with.

Lazy (PEP 562): the names of the room load neither scipy nor a library of a format.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vines.rig.ingest import (
        Ingested,
        channel_facts,
        draw_file,
        find_runs,
        read_folder,
        read_run,
        spark,
        write_template,
    )
    from vines.rig.quantities import (
        QUANTITIES,
        Finding,
        Reconstruction,
        RingDown,
        match_ring_downs,
        reconstruct,
        ring_down,
    )
    from vines.rig.recording import ROLES, Recording, RunInfo, Sampled, Uncertain
    from vines.rig.records import load_reconstruction, save_reconstruction
    from vines.rig.verdict import (
        VERDICTS,
        Calibration,
        Candidate,
        Comparison,
        Likeness,
        Predicted,
        calibrate,
        compare,
        compare_all,
    )

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
    "QUANTITIES": "quantities",
    "ROLES": "recording",
    "VERDICTS": "verdict",
    "Calibration": "verdict",
    "Candidate": "verdict",
    "Comparison": "verdict",
    "Finding": "quantities",
    "Ingested": "ingest",
    "Likeness": "verdict",
    "Predicted": "verdict",
    "Reconstruction": "quantities",
    "Recording": "recording",
    "RingDown": "quantities",
    "RunInfo": "recording",
    "Sampled": "recording",
    "Uncertain": "recording",
    "calibrate": "verdict",
    "channel_facts": "ingest",
    "compare": "verdict",
    "compare_all": "verdict",
    "draw_file": "ingest",
    "find_runs": "ingest",
    "load_reconstruction": "records",
    "match_ring_downs": "quantities",
    "read_folder": "ingest",
    "read_run": "ingest",
    "reconstruct": "quantities",
    "ring_down": "quantities",
    "save_reconstruction": "records",
    "spark": "ingest",
    "write_template": "ingest",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'vines.rig' has no attribute {name!r}")
    return getattr(import_module(f"vines.rig.{_HOME[name]}"), name)
