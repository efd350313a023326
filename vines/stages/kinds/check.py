"""The kind ``check``: published values against tables."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError, FileMissingError, nearest
from vines.pipeline import Kind, Pipeline, Stage
from vines.places import shipped

__all__ = ["KIND", "CheckOptions"]


class CheckOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Published values against the tables of the needed stages."""

    claims: Annotated[tuple[str, ...], Meta(description="Names of published values in pipelines/claims.toml")]


def _claims_file(options: Any, root: Path) -> tuple[Path, ...]:
    del options
    for file in (root / "pipelines" / "claims.toml", shipped("pipelines") / "claims.toml"):
        if file.is_file():
            return (file,)
    raise FileMissingError("pipelines/claims.toml, the published values, is missing; take it from the vines sources")


def _fits(stage: Stage, pipeline: Pipeline) -> None:
    from vines.stages.bodies._claims import read_claims

    if not stage.needs:
        raise DeclarationError("a check compares with other stages; name them, needs = [...]")
    options: Any = stage.options
    files = stage.kind.files(stage.options, pipeline.root) if stage.kind.files is not None else ()
    known = {name for file in files for name in read_claims(file)}
    for name in options.claims:
        if name not in known:
            raise DeclarationError(f"unknown claim {name!r}: {nearest(name, known)}")


KIND = Kind(
    name="check",
    summary="published values against the tables of other stages",
    shape="whole",
    options=CheckOptions,
    body="vines.stages.bodies._check:compute",
    tables=("checks",),
    needs=True,
    files=_claims_file,
    fits=_fits,
)
