"""Files of a folder as a manifest or a part describes them, by size and SHA-256."""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from vines.store._object import is_lasting

__all__ = ["damage_of", "describe_file", "describe_files"]


def describe_files(folder: Path) -> dict[str, dict[str, Any]]:
    """Return sha256 and size of every file below a folder, by name, in order."""
    paths = sorted(path for path in folder.rglob("*") if path.is_file() and path.name != "manifest.json")
    return {path.relative_to(folder).as_posix(): describe_file(path) for path in paths}


def describe_file(path: Path) -> dict[str, Any]:
    """Return sha256 and size of a file."""
    with path.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
    return {"sha256": digest, "bytes": path.stat().st_size}


def damage_of(folder: Path, name: str, said: Mapping[str, Any], *, contents: bool = True) -> str:
    """Return in words what is wrong with a file; empty if it is what was written.

    Parameters
    ----------
    folder : Path
        Where it lies.
    name : str
        Its name there.
    said : mapping
        What :func:`describe_file` said when it was written.
    contents : bool
        Whether to read it; else only whether it is there in its size.

    Raises
    ------
    OSError
        If the system does not let it be read, which says nothing of what it holds.
    """
    try:
        there = os.stat(folder / name)  # noqa: PTH116 - it is called often
    except (FileNotFoundError, NotADirectoryError):
        return f"{name} is missing"
    except OSError as error:
        if not is_lasting(error):
            raise
        return f"{name} is damaged: {error.strerror}"
    if not stat.S_ISREG(there.st_mode):
        return f"{name} is damaged: it is no file"
    size = there.st_size
    if size != said["bytes"]:
        return f"{name} is damaged: it has {size} bytes, {said['bytes']} were written"
    if contents and describe_file(folder / name) != said:
        return f"{name} is damaged: its checksum differs from that of what was written"
    return ""
