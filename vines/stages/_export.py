"""A self-contained copy of results, for a data repository or a colleague without vines."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from vines.errors import FileMissingError, UnknownNameError, VinesError, nearest
from vines.pipeline import available, with_included
from vines.places import find_root, shipped
from vines.stages._running import members_of, open_store

__all__ = ["export"]


def export(
    folder: Path, *names: str, logs: bool = False, licence: Path | None = None, citation: Path | None = None
) -> list[str]:
    """Copy results into a folder that opens without vines (docs/tables.md, "An export").

    Parameters
    ----------
    folder : Path
        One that does not exist yet, or an empty one.
    names : str
        Pipelines or collections of them; all that were run if left out.
    logs : bool
        Whether the MCAP logs go along.
    licence, citation : Path, optional
        Files that become LICENSE and CITATION.cff; by default those at the root of the project, else those of vines.

    Returns
    -------
    list of str
        The files that were written. The same results give the same bytes.

    Raises
    ------
    UnknownNameError
        If nothing is stored of a pipeline.
    FileMissingError
        If the licence or the citation cannot be read.
    StoreError
        If the folder is not empty, or a file of a result is missing.
    """
    from vines.catalogue import Collected, export_results, stage_results

    store = open_store()
    pinned = store.pinned()
    wanted = list(dict.fromkeys(member for name in names for member in _members(name, pinned))) or sorted(pinned)
    results = [
        (pipeline, stage, result)
        for pipeline, stage, result in stage_results(store, wanted)
        if result.manifest["tables"] or result.files
    ]
    if not results:
        raise UnknownNameError("nothing is stored yet that could be exported; run 'vines run quickstart' first")
    declarations, titles = _declared(wanted)
    return export_results(
        Collected(
            results=results,
            declarations=declarations,
            titles=titles,
            licence=_text(licence, "LICENSE"),
            citation=_text(citation, "CITATION.cff"),
            logs=logs,
        ),
        folder.absolute(),
    )


def _members(name: str, pinned: dict[str, Any]) -> Iterable[str]:
    """Return the pipelines that a name stands for, of which something is stored."""
    if name in pinned:
        return (name,)
    try:
        members = [member for member in members_of(name) if member in pinned]
    except VinesError:
        members = []
    if not members:
        raise UnknownNameError(f"nothing is stored of a pipeline {name!r}: {nearest(name, pinned)}")
    return members


def _declared(names: Iterable[str]) -> tuple[dict[str, str], dict[str, str]]:
    """Return the text of the declarations by file name, and the title of each pipeline."""
    files = available(find_root())
    texts: dict[str, str] = {}
    titles: dict[str, str] = {}
    for name in names:
        if name not in files:
            continue
        texts[files[name].name] = files[name].read_text("utf-8")
        titles[name] = str(with_included(files[name]).get("title", ""))
        claims = files[name].parent / "claims.toml"
        if claims.is_file():
            texts[claims.name] = claims.read_text("utf-8")
    return texts, titles


def _text(given: Path | None, name: str) -> str:
    own = find_root() / name
    path = given if given is not None else (own if own.is_file() else shipped(name))
    try:
        return path.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise FileMissingError(f"{path}: {error}; name a text file that becomes {name}") from None
