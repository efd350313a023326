"""Files of a folder as a manifest or a part describes them, by size and SHA-256."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

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
    """
    try:
        size = os.stat(folder / name).st_size  # noqa: PTH116 - it is called often
    except (FileNotFoundError, NotADirectoryError):
        return f"{name} is missing"
    if size != said["bytes"]:
        return f"{name} is damaged: it has {size} bytes, {said['bytes']} were written"
    if contents and describe_file(folder / name) != said:
        return f"{name} is damaged: its checksum differs from that of what was written"
    return ""
