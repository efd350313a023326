"""Collections: a declaration that names other pipelines, to run, check and report them as one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vines.errors import DeclarationError, nearest
from vines.pipeline._deposit import read_deposit
from vines.pipeline._files import available, find
from vines.pipeline._include import parse, with_included
from vines.pipeline._names import NAME, RESERVED
from vines.pipeline._written import written

__all__ = ["Collection", "load_collection", "members"]

KEYS = ("pipelines", "source", "study", "title")


@dataclass(frozen=True, slots=True)
class Collection:
    """Pipelines that belong together.

    Attributes
    ----------
    name, title, source : str
        Its name, what it is, and what it reproduces.
    path : Path
        The file that declares it.
    members : tuple of str
        Names of its pipelines, in the order in which they run.
    """

    name: str
    title: str
    source: str
    path: Path
    members: tuple[str, ...]


def load_collection(path: Path, root: Path) -> Collection | None:
    """Read a declaration of a collection; ``None`` if the file declares a single pipeline.

    Parameters
    ----------
    path : Path
        A TOML file with the key ``pipelines``; its stem is the name.
    root : Path
        Root of the project, where the members are looked for.

    Raises
    ------
    FileMissingError
        If there is no such file.
    DeclarationError
        If a key is unknown, or a member is named twice, does not exist, or is a collection itself; one line.
    """
    form = with_included(path)
    if "pipelines" not in form:
        return None
    for key in form:
        if key not in KEYS:
            known = nearest(key, KEYS)
            raise DeclarationError(f"{path}: unknown key {key!r} of a collection, which has no stages: {known}")
    if not NAME.fullmatch(path.stem) or path.stem in RESERVED:
        rule = "a name is [a-z][a-z0-9_]* and no reserved word of SQL"
        raise DeclarationError(f"{path}: a collection cannot be called {path.stem!r}; {rule}; rename the file")
    read_deposit(form.get("study"), f"{path}: study")  # refuses what a repository would
    return Collection(
        path.stem,
        _text(form, "title", path),
        _text(form, "source", path),
        path,
        _names(form, path, root),
    )


def members(name: str, root: Path) -> tuple[str, ...]:
    """Return the pipelines that a name stands for: those of a collection, or the name alone.

    Raises
    ------
    UnknownNameError, FileMissingError, DeclarationError
        As :func:`vines.pipeline.find` and :func:`load_collection`.
    """
    collection = load_collection(find(name, root), root)
    return (name,) if collection is None else collection.members


def _text(form: Mapping[str, Any], key: str, path: Path) -> str:
    value = form.get(key, "")
    if not isinstance(value, str):
        raise DeclarationError(f"{path}: {key} is {written(value)}; a text is needed here")
    return value


def _names(form: Mapping[str, Any], path: Path, root: Path) -> tuple[str, ...]:
    names = form["pipelines"]
    if not isinstance(names, list) or not names or not all(isinstance(name, str) for name in names):
        raise DeclarationError(
            f'{path}: pipelines is {written(names)}; list names of pipelines, such as ["fig2", "fig3"]'
        )
    known = {each: file for each, file in available(root).items() if each != path.stem}
    for name in names:
        if names.count(name) > 1:
            raise DeclarationError(f"{path}: pipelines names {name!r} twice; once is enough")
        if name not in known:
            raise DeclarationError(f"{path}: pipelines: unknown pipeline {name!r}: {nearest(name, known)}")
        if "pipelines" in parse(known[name]):
            raise DeclarationError(f"{path}: {name!r} is a collection itself; name its pipelines instead")
    return tuple(names)
