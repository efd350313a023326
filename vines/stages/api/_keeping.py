"""What lies in the store: its graph, its garbage, and how two results differ."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import DamageError, StoreError, UnknownNameError, VinesError, nearest
from vines.pipeline import available, code_digests, mermaid, mermaid_of_all, plan, pool_keys, what_changed
from vines.stages.api._home import Home, current
from vines.stages.api._parts import load_parts

if TYPE_CHECKING:
    from vines.catalogue import TableDifference
    from vines.pipeline import Declaration
    from vines.store import Garbage, Result, Store

__all__ = ["Difference", "clean", "diff", "graph"]


@dataclass(frozen=True, slots=True)
class Difference:
    """How two results differ.

    Attributes
    ----------
    a, b : str
        Their keys.
    parameters : str
        What was asked for differently, before → after; empty if nothing.
    tables : tuple of TableDifference
        How their tables differ.
    """

    a: str
    b: str
    parameters: str
    tables: tuple[TableDifference, ...]

    @property
    def same(self) -> bool:
        """Whether the tables agree within the tolerance."""
        return all(table.same for table in self.tables)


def graph(name: str | Declaration, *, study: Home | None = None) -> str:
    """Return a pipeline, or those of a collection, as a Mermaid flowchart: stages, needs, and where they stand."""
    study = study or current()
    store = study.store
    parts = load_parts(name, study=study)
    code = code_digests(store)
    drawn = [(part.pipeline, {each.name: each for each in plan(part.pipeline, store, code=code)}) for part in parts]
    return mermaid_of_all(drawn) if parts[0].collection else mermaid(*drawn[0])


def clean(*, remove: bool = False, study: Home | None = None) -> list[Garbage]:
    """Find results and pools of points that nothing refers to, and remove them if asked.

    Parameters
    ----------
    remove : bool
        Whether to remove them; waits for a run that is writing.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    list of Garbage
        What was found.

    Raises
    ------
    StoreError
        If a manifest is damaged, so that nobody can say what it refers to, or a folder cannot be removed.
    """
    from vines.store import find_garbage, remove_garbage

    study = study or current()
    store = study.store
    if not store.data.is_dir():
        return []
    if not remove:
        return find_garbage(store, _wanted(study))
    with store.writing():
        garbage = find_garbage(store, _wanted(study))
        remove_garbage(store, garbage)
    return garbage


def diff(a: str, b: str, *, rtol: float = 1e-9, atol: float = 0.0, study: Home | None = None) -> Difference:
    """Compare two results of a stage: what was asked for, and the values.

    Parameters
    ----------
    a, b : str
        ``<pipeline>.<stage>`` for its result now, the first letters of a key, or the folder of a result.
    rtol, atol : float
        Numbers are the same if ``|a - b| <= atol + rtol max(|a|, |b|)``.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Raises
    ------
    UnknownNameError
        If there is no such result.
    StoreError
        If the two are of different kinds.
    """
    from vines.catalogue import compare_tables

    store = (study or current()).store
    one, other = _result(store, a), _result(store, b)
    forms = [result.manifest["ingredients"] for result in (one, other)]
    if forms[0]["kind"] != forms[1]["kind"]:
        kinds = f"{a} is a {forms[0]['kind']}, {b} a {forms[1]['kind']}"
        raise StoreError(f"{kinds}: results of one kind of stage can be compared")
    axes = [axis[0] for axis in forms[0]["vary"] if axis[1] != "range"]
    tables = compare_tables(one, other, axes, rtol=rtol, atol=atol)
    return Difference(one.key, other.key, what_changed(*forms), tables)


def _wanted(study: Home) -> set[str]:
    """Return the keys of the pools that pipelines ask for as they are declared now."""
    wanted: set[str] = set()
    store = study.store
    code = code_digests(store)
    for name in available(study.root):
        try:
            wanted |= {key for part in load_parts(name, study=study) for key in pool_keys(part.pipeline, store, code)}
        except VinesError:  # a declaration that cannot be read asks for nothing
            continue
    return wanted


def _result(store: Store, name: str) -> Result:
    from vines.store import read_result

    if (Path(name) / "manifest.json").is_file():
        return read_result(Path(name))
    every, damaged = store.readable_pins()
    pinned = {f"{each}.{stage}": pin["result"] for each, pins in every.items() for stage, pin in pins.items()}
    if name in pinned:
        return store.result(pinned[name])
    if (pipeline := name.partition(".")[0]) in damaged:
        raise DamageError(f"result {name!r}: {damaged[pipeline]}")
    keys: list[Any] = [path.name for path in store.results.glob("*")] if store.results.is_dir() else []
    found = [key for key in keys if len(name) >= 4 and key.startswith(name)]
    if len(found) == 1:
        return store.result(found[0])
    if found:
        raise UnknownNameError(f"{len(found)} results begin with {name!r}; give more letters of the key")
    raise UnknownNameError(f"no result {name!r}: {nearest(name, pinned)}; or the first letters of a key, or a folder")
