"""Writes that are there as a whole or not at all, also after a power cut."""

from __future__ import annotations

import os
import uuid
from pathlib import Path

__all__ = ["commit_folder", "sync_file", "write_text"]


def sync_file(path: Path) -> None:
    """Make the contents of a file or folder durable."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_text(path: Path, text: str) -> None:
    """Replace a file atomically; its folder is made if need be."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.parent / f".{path.name}.{uuid.uuid4().hex[:12]}"
    try:
        with temporary.open("w", encoding="utf-8", newline="\n") as stream:
            stream.write(text)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    sync_file(path.parent)


def commit_folder(source: Path, target: Path) -> bool:
    """Move a finished folder to its place and make it durable; return whether it was not there yet.

    What stands there already has the same key and so the same contents: it is kept.
    """
    for path in source.rglob("*"):
        sync_file(path)
    sync_file(source)
    target.parent.mkdir(parents=True, exist_ok=True)
    try:
        source.rename(target)
    except OSError:
        if target.is_dir():
            return False
        raise
    sync_file(target.parent)
    return True
