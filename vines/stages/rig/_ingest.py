"""Body of the kind ``ingest``: run folders into SI units, logs and tables, their raw files kept byte for byte."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from vines.errors import RigError
from vines.pipeline import Batch, WholeJob
from vines.rig import find_runs, read_run
from vines.rig.ingest import SUMS, Ingested, channels_text
from vines.rig.records import channel_rows, refused_row, run_row, write_log
from vines.stages.rig._refused import reason_of, told_of

if TYPE_CHECKING:
    from vines.stages.kinds.ingest import IngestOptions

__all__ = ["compute"]


def compute(job: WholeJob[IngestOptions]) -> Batch:
    """Read every run and keep it; one that can't be used is a row with the reason, while the others go on."""
    options = job.options
    runs: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    logs: dict[str, str] = {}
    folders = _folders(job)
    for path in folders:
        try:
            run = read_run(path)
            if run.recording.run.run_id in {row["run_id"] for row in runs}:
                raise RigError(f"{path}: another run is called {run.recording.run.run_id!r} too; run_id must be unique")
        except Exception as error:
            # Whatever one run makes a reader or a check stumble over is its own.
            told = told_of(path)
            runs.append(refused_row(_free_name(told.get("run_id"), path.name, runs), reason_of(error), told))
            continue
        info = run.recording.run
        _keep(job.folder / "runs" / info.run_id, path, run)
        logs[info.run_id] = f"{info.run_id}.mcap"
        write_log(job.folder / logs[info.run_id], run.recording, job.provenance, options.log_rate)
        runs.append(run_row(run))
        channels += channel_rows(run)
    refused = [row["reason"] for row in runs if row["status"] == "failed"]
    if len(refused) == len(folders):
        one = len(refused) == 1
        raise RigError(refused[0] if one else f"all {len(refused)} runs are refused, the first: {refused[0]}")
    return Batch(tables={"rig_runs": runs, "rig_channels": channels}, logs=logs)


def _keep(kept: Path, path: Path, run: Ingested) -> None:
    """Copy a run folder; one of a campaign is kept with all that it inherits."""
    folder = run.folder
    home = path if folder is None else folder.home
    inherits = folder is not None and (folder.inherits or folder.form.part is not None)
    for name in (*(() if inherits else ("run.json", "channels.tsv")), *run.sums):
        (kept / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(home / name, kept / name)
    if folder is not None and inherits:
        whole = folder.form
        if whole.part is not None:
            # What is kept has the raw files beside it.
            whole = msgspec.structs.replace(whole, part=msgspec.structs.replace(whole.part, of="."))
        form = msgspec.json.format(msgspec.json.encode(whole), indent=2).decode()
        (kept / "run.json").write_text(form + "\n", encoding="utf-8")
        (kept / "channels.tsv").write_text(channels_text(folder.rows), encoding="utf-8")
    text = "".join(f"{value}  {name}\n" for name, value in run.sums.items())
    (kept / SUMS).write_text(text, encoding="utf-8")


def _free_name(run_id: object, folder: str, runs: list[dict[str, Any]]) -> str:
    """Return the name of a run that can't be read: its own if it has one and no other has it, else its folder's."""
    taken = {row["run_id"] for row in runs}
    names = [run_id] if isinstance(run_id, str) and run_id else []
    return next(
        name for name in (*names, folder, *(f"{folder}_{k}" for k in range(2, len(runs) + 3))) if name not in taken
    )


def _folders(job: WholeJob[IngestOptions]) -> tuple[Path, ...]:
    """Return the run folders, in the order of time."""
    options = job.options
    if bool(options.folder) == bool(job.inputs):
        raise RigError("ingest takes either folder or needs = [a stage of kind synth]")
    if options.folder:
        return find_runs(job.root / options.folder)
    return tuple(path for stage in job.inputs.values() for path in find_runs(stage.folder / "runs"))
