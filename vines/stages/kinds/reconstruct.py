"""The kind ``reconstruct``: what follows from what was measured."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError
from vines.pipeline import Kind, Pipeline, Stage

__all__ = ["KIND", "ReconstructOptions"]


class ReconstructOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Every run with the ball of the needed stages of kind `ingest`."""

    seed: Annotated[int, Meta(ge=0, description="Seed of the draws for uncertainties")] = 0


def _fits(stage: Stage, pipeline: Pipeline) -> None:
    for need in stage.needs:
        if "rig_runs" not in pipeline.stages[need].kind.tables:
            raise DeclarationError(
                f"it reconstructs what stages of kind ingest keep; {need} is none, remove it from needs",
            )
    if not stage.needs:
        raise DeclarationError("it reconstructs what was ingested; name a stage of kind ingest in needs")


def _readers(options: object) -> tuple[str, ...]:
    """Name the readers of files, those of installed packages too: which one a file needs is seen when it is read."""
    del options
    from vines.rig.formats import readers

    return readers()


KIND = Kind(
    name="reconstruct",
    summary="runs of a rig brought to the quantities of the model, with uncertainties, gates and their impacts",
    shape="whole",
    options=ReconstructOptions,
    body="vines.stages.rig._reconstruct:compute",
    tables=("reconstructions", "rig_impacts", "rig_budgets"),
    needs=True,
    fits=_fits,
    code=_readers,
)
