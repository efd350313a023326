"""A self-contained copy of results, for a data repository or a colleague without vines."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from pathlib import Path

from vines.errors import FileMissingError, UnknownNameError
from vines.pipeline import available, with_included
from vines.places import shipped
from vines.stages.api._home import Home, current
from vines.stages.api._stored import stored_pipelines

__all__ = ["export"]


def export(
    folder: Path,
    *names: str,
    logs: bool = False,
    licence: Path | None = None,
    citation: Path | None = None,
    study: Home | None = None,
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
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

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

    study = study or current()
    store = study.store
    wanted = stored_pipelines(names, store.pinned(), study.root)
    results = [
        (pipeline, stage, result)
        for pipeline, stage, result in stage_results(store, wanted)
        if result.manifest["tables"] or result.files
    ]
    if not results:
        raise UnknownNameError("nothing is stored yet that could be exported; run 'vines run quickstart' first")
    declarations, titles = _declared(wanted, names, study.root)
    return export_results(
        Collected(
            results=results,
            declarations=declarations,
            titles=titles,
            licence=_text(licence, "LICENSE", study.root),
            citation=_text(citation, "CITATION.cff", study.root),
            logs=logs,
        ),
        folder.absolute(),
    )


def _declared(pipelines: Collection[str], names: Iterable[str], root: Path) -> tuple[dict[str, str], dict[str, str]]:
    """Return the text of the declarations by file name, those of collections too, and the title of each pipeline."""
    files = available(root)
    texts: dict[str, str] = {}
    titles: dict[str, str] = {}
    for name in dict.fromkeys([*pipelines, *names]):
        if name not in files:
            continue
        texts[files[name].name] = files[name].read_text("utf-8")
        if name in pipelines:
            titles[name] = str(with_included(files[name]).get("title", ""))
        claims = files[name].parent / "claims.toml"
        if claims.is_file():
            texts[claims.name] = claims.read_text("utf-8")
    return texts, titles


def _text(given: Path | None, name: str, root: Path) -> str:
    own = root / name
    path = given if given is not None else (own if own.is_file() else shipped(name))
    try:
        return path.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise FileMissingError(f"{path}: {error}; name a text file that becomes {name}") from None
