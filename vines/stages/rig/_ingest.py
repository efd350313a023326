"""Body of the kind ``ingest``: run folders into SI units, logs and tables, their raw files kept byte for byte."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import RigError
from vines.pipeline import Batch, WholeJob
from vines.rig import find_runs, read_run
from vines.rig.ingest import SUMS
from vines.rig.records import channel_rows, run_row, write_log

if TYPE_CHECKING:
    from vines.stages.kinds.ingest import IngestOptions

__all__ = ["compute"]


def compute(job: WholeJob[IngestOptions]) -> Batch:
    """Read every run, refuse what can't be used, and keep the rest."""
    options = job.options
    runs: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    logs: dict[str, str] = {}
    for path in _folders(job):
        run = read_run(path)
        info = run.recording.run
        if info.run_id in logs:
            raise RigError(f"{path}: another run is called {info.run_id!r} too; run_id must be unique")
        kept = job.folder / "runs" / info.run_id
        for name in ("run.json", "channels.tsv", *run.sums):
            (kept / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path / name, kept / name)
        text = "".join(f"{value}  {name}\n" for name, value in run.sums.items())
        (kept / SUMS).write_text(text, encoding="utf-8")
        logs[info.run_id] = f"{info.run_id}.mcap"
        write_log(job.folder / logs[info.run_id], run.recording, job.provenance, options.log_rate)
        runs.append(run_row(run))
        channels += channel_rows(run)
    return Batch(tables={"rig_runs": runs, "rig_channels": channels}, logs=logs)


def _folders(job: WholeJob[IngestOptions]) -> tuple[Path, ...]:
    """Return the run folders, in the order of time."""
    options = job.options
    if bool(options.folder) == bool(job.inputs):
        raise RigError("ingest takes either folder or needs = [a stage of kind synth]")
    if options.folder:
        return find_runs(job.root / options.folder)
    return tuple(path for stage in job.inputs.values() for path in find_runs(stage.folder / "runs"))
