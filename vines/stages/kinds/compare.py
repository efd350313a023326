"""The kind ``compare``: runs of a rig beside the model."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError
from vines.pipeline import Kind, Pipeline, Stage

__all__ = ["COMPARE", "KIND", "CompareOptions"]

COMPARE = ("orbits", "one_run", "lanes", "many_runs", "scatter")
"""Kinds of tasks whose kernels the comparison of a measured run with the model asks for."""


class CompareOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Every run of the needed stages of kind `reconstruct` beside the branches that coexist at its parameters.

    Needed stages with orbits, such as those of kind `branch`, are the catalogue: they say which words to look for.
    """

    seed: Annotated[int, Meta(ge=0, description="Seed of the ensembles")] = 0
    record: Annotated[
        int, Meta(ge=0, description="Forcing periods of each run that go into a log, beside one of the model")
    ] = 12


def _fits(stage: Stage, pipeline: Pipeline) -> None:
    kinds = [pipeline.stages[need].kind for need in stage.needs]
    for need, kind in zip(stage.needs, kinds, strict=True):
        if kind.name != "reconstruct" and "orbits" not in kind.tables:
            raise DeclarationError(
                f"it compares reconstructed runs with orbits; {need} has neither, remove it from needs"
            )
    if all(kind.name != "reconstruct" for kind in kinds):
        raise DeclarationError("it compares what was reconstructed; name a stage of kind reconstruct in needs")


KIND = Kind(
    name="compare",
    summary="runs of a rig beside the branches that coexist at their parameters, with verdicts",
    shape="whole",
    options=CompareOptions,
    body="vines.stages.rig._compare:compute",
    tables=("comparisons", "rig_cycles"),
    needs=True,
    logs=True,
    kernels=COMPARE,
    fits=_fits,
)
