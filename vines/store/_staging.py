"""Folders for what is being written. Each has a lock beside it that dies with the process that writes there."""

from __future__ import annotations

import contextlib
import shutil
import uuid
from collections.abc import Iterator
from pathlib import Path

__all__ = ["clear_staging", "staging"]


@contextlib.contextmanager
def staging(folder: Path) -> Iterator[Path]:
    """Give an empty folder below `folder`; what is left in it at the end is removed."""
    from filelock import FileLock

    folder.mkdir(parents=True, exist_ok=True)
    place = folder / uuid.uuid4().hex
    # the lock before the folder: a folder whose lock is free has lost its process
    with FileLock(place.with_suffix(".lock")):
        place.mkdir()
        try:
            yield place
        finally:
            shutil.rmtree(place, ignore_errors=True)
            place.with_suffix(".lock").unlink(missing_ok=True)


def clear_staging(folder: Path) -> None:
    """Remove what processes left behind that are gone; what living ones write stays."""
    from filelock import FileLock, Timeout

    for place in [*folder.iterdir()] if folder.is_dir() else ():
        if place.suffix == ".lock":  # goes with its folder; alone, it may belong to a process that makes one just now
            continue
        lock = FileLock(place.with_suffix(".lock"))
        with contextlib.suppress(Timeout), lock.acquire(timeout=0):
            shutil.rmtree(place, ignore_errors=True)
            place.with_suffix(".lock").unlink(missing_ok=True)
