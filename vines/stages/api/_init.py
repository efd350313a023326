"""A study of one's own in a new folder."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Literal

from vines.errors import StoreError
from vines.places import shipped
from vines.stages.api._declarable import declaration_schema

__all__ = ["init_study"]

_COPIED = {"starter": "*.toml", "quickstart": "quickstart.toml", "paper": "*.toml"}
"""Files that are copied of the pipelines of a starting point."""


def init_study(folder: Path, start: Literal["starter", "quickstart", "paper"] = "starter") -> None:
    """Make a folder with pipelines, the schema by which editors check them, and a ``data/`` that git ignores.

    Parameters
    ----------
    folder : Path
        The folder; it may exist.
    start : {"starter", "quickstart", "paper"}
        A small study that runs in seconds; the quickstart; or all pipelines that ship with vines. Each has a README.

    Raises
    ------
    StoreError
        If the folder has pipelines already; nothing is overwritten.
    """
    if (folder / "pipelines").exists():
        raise StoreError(f"{folder}/pipelines exists already; choose another folder or remove it")
    if folder.exists() and not folder.is_dir():
        raise StoreError(f"{folder} is a file; choose another name for the folder")
    for name in ("data", "pipelines", "schemas"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    (folder / "data" / ".gitignore").write_text("*\n!.gitignore\n", encoding="utf-8")
    (folder / "schemas" / "pipeline.schema.json").write_text(declaration_schema() + "\n", encoding="utf-8")
    source = shipped("starter") / "pipelines" if start == "starter" else shipped("pipelines")
    for path in source.glob(_COPIED[start]):
        shutil.copyfile(path, folder / "pipelines" / path.name)
    readme = folder / "README.md"
    if not readme.exists():
        text = "README.md" if start == "starter" else "README.quickstart.md"
        shutil.copyfile(shipped("starter") / text, readme)
