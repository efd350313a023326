"""Folders for what is being written. Each has a lock beside it that dies with the process that writes there."""

from __future__ import annotations

import contextlib
import shutil
import time
import uuid
from collections.abc import Iterator
from pathlib import Path

__all__ = ["clear_staging", "staging"]

_FORGOTTEN = 3600.0
"""Seconds after which a lock without a folder belongs to nobody."""


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
        if place.suffix == ".lock":
            # It goes with its folder. Alone, it may belong to a process that makes one just now, unless it is old.
            with contextlib.suppress(FileNotFoundError):
                if not place.with_suffix("").exists() and time.time() - place.stat().st_mtime > _FORGOTTEN:
                    place.unlink()
            continue
        lock = FileLock(place.with_suffix(".lock"))
        with contextlib.suppress(Timeout), lock.acquire(timeout=0):
            shutil.rmtree(place, ignore_errors=True)
            place.with_suffix(".lock").unlink(missing_ok=True)
