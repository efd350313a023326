"""Where pipelines are declared: files of the project, and those that ship with vines."""

from __future__ import annotations

import re
from pathlib import Path

from vines.errors import FileMissingError, UnknownNameError, nearest
from vines.places import shipped

__all__ = ["available", "file_of", "find"]

_STAGES = re.compile(r"^\s*(\[\s*stages\b|include\s*=|pipelines\s*=)", re.MULTILINE)


def available(root: Path) -> dict[str, Path]:
    """Return the files of all pipelines and collections by name: of the project, and those that ship with vines.

    Files of ``pipelines/`` that declare neither stages nor pipelines, such as published claims, are none.
    """
    found: dict[str, Path] = {}
    for folder in (shipped("pipelines"), root / "pipelines"):
        for path in sorted(folder.glob("*.toml")):
            if _declares(path):
                found[path.stem] = path
    return dict(sorted(found.items()))


def _is_there(path: Path) -> bool:
    """Whether there is something of that name, be it a folder or a link to nowhere: reading it says so."""
    return path.exists() or path.is_symlink()


def _declares(path: Path) -> bool:
    try:
        return _STAGES.search(path.read_text("utf-8", errors="replace")) is not None
    except OSError:  # who reads it as a declaration says why it cannot be read; the others stay usable
        return True


def file_of(name: str, root: Path) -> Path | None:
    """Return the file of a pipeline or collection, as `available` has it; ``None`` if there is none of that name."""
    for folder in (root / "pipelines", shipped("pipelines")):
        path = folder / f"{name}.toml"
        if _is_there(path) and _declares(path):
            return path
    return None


def find(name: str, root: Path) -> Path:
    """Return the file of a pipeline.

    Parameters
    ----------
    name : str
        A name, looked for in ``pipelines/`` of the project and then among those that ship with vines; or a path.
    root : Path
        Root of the project.

    Raises
    ------
    UnknownNameError
        If no pipeline has that name.
    FileMissingError
        If it is a path and there is no such file.
    """
    if name.endswith(".toml") or "/" in name:
        path = Path(name)
        if not path.is_file():
            raise FileMissingError(f"{name}: there is no such file; 'vines list' shows the pipelines there are")
        return path
    for folder in (root / "pipelines", shipped("pipelines")):
        path = folder / f"{name}.toml"
        if _is_there(path):
            return path
    raise UnknownNameError(f"unknown pipeline {name!r}: {nearest(name, available(root))}")
