"""A self-contained copy of results, for a data repository or a colleague without vines."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Iterable
from pathlib import Path

from vines.catalogue import Deposit
from vines.errors import DamageError, DeclarationError, FileMissingError, StaleWarning, StoreError, UnknownNameError
from vines.pipeline import available, read_deposit, with_included
from vines.places import shipped
from vines.stages.api._home import Home, current
from vines.stages.api._parts import load_parts
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
    DeclarationError
        If a `[study]` table is not allowed, or several differ.
    StoreError
        If the folder is not empty, is being exported to, cannot be written, or lies where results are kept; or if a
        file of a result is missing or damaged.

    Warns
    -----
    StaleWarning
        If a result is not what its declaration asks for now; the README of the export says so too.
    """
    from vines.catalogue import Collected, export_results, stage_results

    study = study or current()
    store = study.store
    target = folder.resolve()
    if target.is_relative_to(store.data.resolve()):
        raise StoreError(f"{folder} lies in {store.data}, which is for what vines keeps there; name another folder")
    pinned, damaged = store.readable_pins()
    wanted = stored_pipelines(names, {*pinned, *damaged}, study.root)
    stored, absent = stage_results(store, wanted)
    if absent:
        where, why = next(iter(absent.items()))
        raise DamageError(f"{where} cannot be exported: {why}")
    results = [each for each in stored if each[2].manifest["tables"] or each[2].files]
    if not results:
        raise UnknownNameError("nothing is stored yet that could be exported; run 'vines run quickstart' first")
    deposit = _deposit([*wanted, *names], study.root)
    declarations, titles = _declared(wanted, names, study.root)
    stale = [line for name in wanted if name in available(study.root) for line in _stale(name, study)]
    files = export_results(
        Collected(
            results=results,
            declarations=declarations,
            titles=titles,
            licence=_text(licence, "LICENSE", study.root),
            citation=_text(citation, "CITATION.cff", study.root),
            logs=logs,
            stale=stale,
            deposit=deposit,
        ),
        target,
    )
    for line in stale:
        warnings.warn(f"{line}; the export holds what is stored", StaleWarning, stacklevel=2)
    return files


def _stale(name: str, study: Home) -> list[str]:
    """Return the stages of a pipeline whose stored result is not what is declared now, and why, a line each."""
    from vines.pipeline import plan

    return [
        f"{name}.{each.name} is {each.state}: {each.reason}"
        for part in load_parts(name, study=study)
        for each in plan(part.pipeline, study.store)
        if each.state != "up_to_date"
    ]


def _deposit(names: Iterable[str], root: Path) -> Deposit | None:
    """Return what the declarations tell a data repository: that of a collection before those of its pipelines."""
    files = available(root)
    found: dict[str, Deposit] = {}
    whole: dict[str, Deposit] = {}
    for name in dict.fromkeys(names):
        if name not in files:
            continue
        form = with_included(files[name])
        told = read_deposit(form.get("study"), f"{files[name]}: study")
        if told is not None:
            (whole if "pipelines" in form else found)[name] = told
    chosen = whole or found
    if len(set(map(repr, chosen.values()))) > 1:
        raise DeclarationError(
            f"{', '.join(chosen)} have [study] tables that differ; export them apart, or write one into a collection"
        )
    return next(iter(chosen.values()), None)


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
