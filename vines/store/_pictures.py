"""Pictures where people find them: copies under the names of their stages, beside the results under their keys."""

from __future__ import annotations

import shutil
import uuid
from pathlib import Path

__all__ = ["PICTURES", "show_pictures"]

PICTURES = ("picture.png", "picture.svg", "picture.pdf")
"""Files of a stage that draws."""


def show_pictures(data: Path, result: Path, name: str) -> list[Path]:
    """Copy the pictures of a result to ``figures/`` where they are not there yet, and return the copies.

    They are copies and no links: who retouches one changes no result.

    Parameters
    ----------
    data : Path
        Folder of results.
    result : Path
        Folder of one result.
    name : str
        ``<pipeline>.<stage>``, which the copies are named by.

    Raises
    ------
    OSError
        If a copy cannot be written.
    """
    shown = []
    for picture in PICTURES:
        source = result / picture
        copy = data / "figures" / f"{name}{source.suffix}"
        if not source.is_file():
            continue
        shown.append(copy)
        if _stamp(copy) == _stamp(source):
            continue
        copy.parent.mkdir(exist_ok=True)
        beside = copy.with_name(f".{copy.name}.{uuid.uuid4().hex[:12]}")
        try:
            shutil.copy2(source, beside)
            beside.replace(copy)
        finally:
            beside.unlink(missing_ok=True)
    return shown


def _stamp(path: Path) -> tuple[int, int] | None:
    """Return size and time of a file, by which a copy is told from another."""
    try:
        about = path.stat()
    except OSError:
        return None
    return about.st_size, about.st_mtime_ns
