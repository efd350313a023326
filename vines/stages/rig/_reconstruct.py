"""Body of the kind ``reconstruct``: ingested runs brought to the quantities of the model, several at a time."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

from vines import schema
from vines.errors import RigError
from vines.pipeline import Batch, WholeJob
from vines.rig import load_reconstruction
from vines.rig.records import budget_rows, failed_row, impact_columns, reconstruction_row
from vines.stages.rig._runs import free_decay, kept_runs, make, refused_runs, ring_downs_of, wanted

if TYPE_CHECKING:
    from vines.stages.kinds.reconstruct import ReconstructOptions

__all__ = ["compute"]


def compute(job: WholeJob[ReconstructOptions]) -> Batch:
    """Reconstruct every run with the ball.

    A run that cannot be read or reconstructed is a row with status ``failed``. A ring-down that gives no omega0 is as
    if it had not been made, but for runs that name it. Each reconstruction is kept as soon as it is made, so an
    interrupted campaign goes on, and a longer one reconstructs the new runs only.
    """
    options = job.options
    runs, refused = kept_runs(job.inputs), refused_runs(job.inputs)
    free = [name for name, (_, info) in runs.items() if info.protocol == "ringdown"]
    if not refused and len(free) == len(runs):
        raise RigError("none of the ingested runs has the ball in it, so there is nothing to reconstruct")
    tried = dict(zip(free, job.spread(free_decay, [runs[name][0] for name in free]), strict=True))
    decays = {name: one for name, one in tried.items() if not isinstance(one, str)}
    belongs, lost = ring_downs_of(runs, decays)
    code, cache = str(job.provenance["code"]), job.cache
    works = [
        wanted(runs[run][0], [decays[name] for name in names], options.seed, code, cache)
        for run, names in belongs.items()
    ]
    reasons = job.spread(make, works)
    rows = [failed_row(row["run_id"], row["start_utc"], f"not ingested: {row['reason']}") for row in refused]
    for name, why in tried.items():
        if isinstance(why, str):
            rows.append(failed_row(name, runs[name][1].start_utc, f"no omega0: {why}", runs[name][1]))
    useless = "; ".join(f"ring-down {name}: {why}" for name, why in tried.items() if isinstance(why, str))
    for run, why in lost.items():
        info = runs[run][1]
        rows.append(failed_row(run, info.start_utc, f"{why}; {useless}" if useless else why, info))
    found = []
    (job.folder / "reconstructions").mkdir()
    for (run, names), work, reason in zip(belongs.items(), works, reasons, strict=True):
        if reason:
            info = runs[run][1]
            rows.append(failed_row(run, info.start_utc, reason, info, names))
            continue
        shutil.copyfile(work.kept, job.folder / "reconstructions" / f"{run}.npz")
        found.append(load_reconstruction(work.kept))
        rows.append(reconstruction_row(found[-1], names))
    impacts = schema.cast("rig_impacts", impact_columns(found))
    budgets = [row for one in found for row in budget_rows(one)]
    return Batch(tables={"reconstructions": rows, "rig_impacts": impacts, "rig_budgets": budgets})
