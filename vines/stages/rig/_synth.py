"""Body of the kind ``synth``: the run folders of a synthetic campaign."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vines.pipeline import Batch, WholeJob
from vines.rig.synth import make_campaign

if TYPE_CHECKING:
    from vines.stages.kinds.synth import SynthOptions

__all__ = ["compute"]


def compute(job: WholeJob[SynthOptions]) -> Batch:
    """Make the campaign below ``runs/`` and its truth below ``sealed/``."""
    options = job.options
    rows = make_campaign(
        job.folder / "runs",
        amplitudes=options.amplitudes,
        seed=options.seed,
        draw=options.draw,
        warming=options.warming,
        given=options.settings,
    )
    return Batch(tables={"rig_made": rows})
