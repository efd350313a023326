"""Compiled kernels of sources that have changed since: they are deleted, since nothing can use them again."""

from __future__ import annotations

import contextlib
import os
import shutil
import time
from pathlib import Path

__all__ = ["delete_old", "is_digest", "note_use"]

KEPT = 3
"""Folders kept besides a new one: those used last, so that going back to another branch does not compile again."""

DAYS = 2.0
"""A folder used in the last days is kept in any case: a process that still runs may load from it."""


def is_digest(name: str) -> bool:
    """Say whether a folder's name is that of a cache: 16 hexadecimal digits."""
    return len(name) == 16 and set(name) <= set("0123456789abcdef")


def note_use(folder: Path) -> None:
    """Set the time of a cache folder's last use to now, if it exists and is ours to write."""
    with contextlib.suppress(OSError):
        os.utime(folder)


def delete_old(folder: Path, *, kept: int = KEPT, days: float = DAYS) -> list[str]:
    """Delete caches in a folder but those used last or lately, and return the names of those deleted.

    Parameters
    ----------
    folder : Path
        Where the caches lie, each in a folder named by the digest of its sources; nothing else in it is touched.
    kept : int
        How many to keep.
    days : float
        Those used within so many days are kept beyond that.
    """
    used: list[tuple[float, Path]] = []
    with contextlib.suppress(OSError):
        for cache in folder.iterdir():
            if is_digest(cache.name) and cache.is_dir() and not cache.is_symlink():
                used.append((cache.stat().st_mtime, cache))
    used.sort(key=lambda one: (-one[0], one[1].name))
    old = [cache for when, cache in used[kept:] if time.time() - when > days * 86_400]
    for cache in old:
        # Another process may be deleting it too.
        shutil.rmtree(cache, ignore_errors=True)
    return [cache.name for cache in old]
