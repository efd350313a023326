"""Body of the kind ``compare``: reconstructed runs beside the branches of the model that coexist with them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vines.errors import RigError
from vines.model import PARAMETER_NAMES
from vines.pipeline import Batch, Input, WholeJob
from vines.rig import Reconstruction, compare_all, load_reconstruction
from vines.rig.records import comparison_rows, cycle_rows, row_id
from vines.stages.rig._overlay import overlay_logs

if TYPE_CHECKING:
    from vines.stages.kinds.compare import CompareOptions

__all__ = ["compute"]

_KNOWN = ("word", "branch_id", *PARAMETER_NAMES, "t")
"""Columns of orbits from which a branch is followed to the parameters of a run."""


def compute(job: WholeJob[CompareOptions]) -> Batch:
    """Compare all runs at measured parameters, and every other one at parameters calibrated on the rest."""
    options = job.options
    runs: list[Reconstruction] = []
    lost: list[dict[str, Any]] = []
    catalogue: list[dict[str, Any]] = []
    for stage in job.inputs.values():
        if "reconstructions" in stage.tables:
            runs += _reconstructions(stage)
            lost += _lost(stage)
        else:
            catalogue += stage.table("orbits").select(list(_KNOWN)).to_pylist()
    names = [found.run.run_id for found in runs]
    for name in names:
        if names.count(name) > 1:
            raise RigError(f"two of the needed stages have a run {name!r}; run_id must be unique")
    runs.sort(key=lambda found: (found.run.start_utc, found.run.run_id))
    measured, calibrated, calibration = compare_all(runs, catalogue, seed=options.seed, spread=job.spread)
    rows = [row for found in measured for row in comparison_rows(found)]
    rows += [row for found in calibrated for row in comparison_rows(found, calibration)]
    cycles = [row for found in (*measured, *calibrated) for row in cycle_rows(found)]
    logs: dict[str, str] = {}
    for found in measured:
        logs |= overlay_logs(job.folder, found, options.record, job.provenance)
    return Batch(tables={"comparisons": rows + lost, "rig_cycles": cycles}, logs=logs)


def _reconstructions(stage: Input) -> list[Reconstruction]:
    return [load_reconstruction(path) for path in sorted((stage.folder / "reconstructions").glob("*.npz"))]


def _lost(stage: Input) -> list[dict[str, Any]]:
    """Return a row for each run that could not be reconstructed."""
    return [
        {
            "point_id": row_id(row["run_id"], "measured", 0),
            "run_id": row["run_id"],
            "protocol": row["protocol"],
            "basis": "measured",
            "rank": 0,
            "accepted": False,
            "verdict": "undecidable",
            "reason": f"not reconstructed: {row['reason']}",
        }
        for row in stage.table().to_pylist()
        if row["status"] == "failed" and row["protocol"] != "ringdown"
    ]
