"""Body of the kind ``reconstruct``: ingested runs brought to the quantities of the model, several at a time."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

from vines import schema
from vines.errors import RigError
from vines.pipeline import Batch, WholeJob
from vines.rig import load_reconstruction
from vines.rig.records import failed_row, impact_columns, reconstruction_row
from vines.stages.rig._runs import free_decay, kept_runs, make, ring_downs_of, wanted

if TYPE_CHECKING:
    from vines.stages.kinds.reconstruct import ReconstructOptions

__all__ = ["compute"]


def compute(job: WholeJob[ReconstructOptions]) -> Batch:
    """Reconstruct every run with the ball.

    A run that cannot be reconstructed is a row with status ``failed``. Each reconstruction is kept as soon as it is
    made, so an interrupted campaign goes on, and a longer one reconstructs the new runs only.
    """
    options = job.options
    runs = kept_runs(job.inputs)
    belongs = ring_downs_of(runs)
    if not belongs:
        raise RigError("none of the ingested runs has the ball in it, so there is nothing to reconstruct")
    needed = sorted({name for names in belongs.values() for name in names})
    decays = dict(zip(needed, job.spread(free_decay, [runs[name][0] for name in needed]), strict=True))
    code, cache = str(job.provenance["code"]), job.cache
    works = [
        wanted(runs[run][0], [decays[name] for name in names], options.seed, code, cache)
        for run, names in belongs.items()
    ]
    reasons = job.spread(make, works)
    rows, found = [], []
    (job.folder / "reconstructions").mkdir()
    for (run, names), work, reason in zip(belongs.items(), works, reasons, strict=True):
        if reason:
            rows.append(failed_row(runs[run][1], names, reason))
            continue
        shutil.copyfile(work.kept, job.folder / "reconstructions" / f"{run}.npz")
        found.append(load_reconstruction(work.kept))
        rows.append(reconstruction_row(found[-1], names))
    impacts = schema.cast("rig_impacts", impact_columns(found))
    return Batch(tables={"reconstructions": rows, "rig_impacts": impacts})
