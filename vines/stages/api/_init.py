"""A study of one's own in a new folder."""

from __future__ import annotations

import shutil
from pathlib import Path

from vines.errors import StoreError
from vines.places import shipped

__all__ = ["init_study"]


def init_study(folder: Path) -> None:
    """Make a folder with the pipelines that ship with vines, and a ``data/`` that git ignores.

    Raises
    ------
    StoreError
        If the folder has pipelines already; nothing is overwritten.
    """
    if (folder / "pipelines").exists():
        raise StoreError(f"{folder}/pipelines exists already; choose another folder or remove it")
    if folder.exists() and not folder.is_dir():
        raise StoreError(f"{folder} is a file; choose another name for the folder")
    (folder / "data").mkdir(parents=True, exist_ok=True)
    (folder / "data" / ".gitignore").write_text("*\n!.gitignore\n", encoding="utf-8")
    shutil.copytree(shipped("pipelines"), folder / "pipelines")
