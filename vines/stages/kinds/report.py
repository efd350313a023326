"""The kind ``report``: one page about other stages."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError
from vines.pipeline import Kind, Pipeline, Stage

__all__ = ["KIND", "ReportOptions"]


class ReportOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The page that ``vines report`` writes, about the needed stages and without times, as ``report.html``."""

    pipeline: Annotated[str, Meta(description="Name of the pipeline, which the commands on the page say")]
    title: Annotated[str, Meta(description="Head of the page; the name of the pipeline if empty")] = ""
    source: Annotated[str, Meta(description="Written below it")] = ""


def _fits(stage: Stage, pipeline: Pipeline) -> None:
    told = msgspec.structs.asdict(stage.options)["pipeline"]
    if not stage.needs:
        raise DeclarationError("a report tells of other stages; name them, needs = [...]")
    if told != pipeline.name:
        raise DeclarationError(f"pipeline is {told!r}, allowed is the name of this one, {pipeline.name!r}")


KIND = Kind(
    name="report",
    summary="one self-contained HTML page about other stages: figures, checks, tables, provenance",
    shape="whole",
    options=ReportOptions,
    body="vines.stages.reports._stage:compute",
    needs=True,
    fits=_fits,
)
