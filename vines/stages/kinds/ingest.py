"""The kind ``ingest``: what was measured."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import msgspec
from msgspec import Meta

from vines.pipeline import Kind

__all__ = ["KIND", "IngestOptions"]


class IngestOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Run folders at or below `folder`, or those that the needed stage made."""

    folder: Annotated[str, Meta(description="Where run folders lie, from the root of the project")] = ""
    log_rate: Annotated[
        float, Meta(ge=0, description="Samples a second of a channel in the logs at most [Hz]; 0 keeps all")
    ] = 2048.0


def _run_files(options: IngestOptions, root: Path) -> tuple[Path, ...]:
    """Return every file of the run folders, because the result depends on their contents."""
    if not options.folder:
        return ()
    from vines.rig import find_runs
    from vines.rig.ingest import stated_files

    return tuple(dict.fromkeys(file for path in find_runs(root / options.folder) for file in stated_files(path)))


def _readers(options: object) -> tuple[str, ...]:
    """Name the readers of files, those of installed packages too: which one a file needs is seen when it is read."""
    del options
    from vines.rig.formats import readers

    return readers()


KIND = Kind(
    name="ingest",
    summary="run folders of a rig in SI units: raw files kept, MCAP logs, and what was measured",
    shape="whole",
    options=IngestOptions,
    body="vines.stages.rig._ingest:compute",
    tables=("rig_runs", "rig_channels"),
    needs=True,
    logs=True,
    files=_run_files,
    code=_readers,
)
