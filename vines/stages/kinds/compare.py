"""The kind ``compare``: runs of a rig beside the model."""

from __future__ import annotations

from typing import Any

import msgspec

from vines.errors import DeclarationError, ParameterError
from vines.pipeline import Kind, Pipeline, Stage
from vines.stages.kinds._seed import check_seed

__all__ = ["COMPARE", "KIND", "CompareOptions"]

COMPARE = ("orbits", "one_run", "lanes", "many_runs", "scatter")
"""Kinds of tasks whose kernels the comparison of a measured run with the model asks for."""


class CompareOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Every run of the needed stages of kind `reconstruct` beside the branches that coexist at its parameters.

    Needed stages with orbits, such as those of kind `branch`, are the catalogue: they say which words to look for.
    `seed` is that of the ensembles. `record` forcing periods of each run go into a log, beside one of the model.
    """

    seed: int = 0
    record: int = 12


def _check(params: dict[str, float], options: Any) -> None:
    del params
    check_seed(options)
    if options.record < 0:
        raise ParameterError(f"record is {options.record}, allowed is record >= 0")


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
    check=_check,
    kernels=COMPARE,
    fits=_fits,
)
