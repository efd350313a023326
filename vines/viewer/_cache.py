"""Recordings that are kept between calls: made again when a log, the layout or Rerun changes, never the only copy."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from vines.logs import Log, bytes_of_file
from vines.viewer._save import save_rrd

__all__ = ["cached_rrd"]


def cached_rrd(
    logs: Sequence[str | os.PathLike[str] | Log],
    folder: Path,
    *,
    at: float | None = None,
    full: bool = False,
    stages: Sequence[str] = (),
) -> Path:
    """Return a recording of logs from a folder, made if the logs or the layout have changed since.

    A recording is named by the places of its logs, by a digest of their bytes, the modules that draw them and the
    version of Rerun, and by a digest of its own: one that was cut or altered is made again. Those of the same logs that
    are out of date are removed. The folder may be deleted at any time.

    Parameters
    ----------
    logs : sequence of path-like or Log
        One run, or several to be shown side by side.
    folder : Path
        Where recordings are kept; made if it is missing.
    at, full, stages : float or None, bool, sequence of str
        What is drawn of a long run, and where runs come from, as in :func:`vines.viewer.save_rrd`.

    Raises
    ------
    FileMissingError
        If a log does not exist.
    LogError
        If a log is damaged or incomplete.
    ViewerError
        If there is nothing to show.
    """
    paths = [os.path.realpath(log.path if isinstance(log, Log) else log) for log in logs]
    place = hashlib.sha256("\0".join(paths).encode()).hexdigest()[:12]
    content = hashlib.sha256(f"{version('rerun-sdk')} {_drawing()} {at} {full} {' '.join(stages)}".encode())
    for log in logs:
        sha256 = log.sha256 if isinstance(log, Log) else hashlib.sha256(bytes_of_file(Path(log))).hexdigest()
        content.update(bytes.fromhex(sha256))
    name = f"{place}-{content.hexdigest()[:20]}"
    kept = [each for each in folder.glob(f"{name}-*.rrd") if each.stem.endswith(_own_digest(each))]
    if kept:
        return kept[0]
    folder.mkdir(parents=True, exist_ok=True)
    made = save_rrd(logs, folder / f"{name}.rrd", at=at, full=full, stages=stages)
    target = made.rename(folder / f"{name}-{_own_digest(made)}.rrd")
    for other in folder.glob(f"{place}-*.rrd"):
        if other != target:
            other.unlink(missing_ok=True)
    return target


def _own_digest(recording: Path) -> str:
    with recording.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()[:20]


def _drawing() -> str:
    """Return a digest of the modules that decide what a recording looks like."""
    digest = hashlib.sha256()
    for file in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()
