"""What a name stands for: one pipeline, or those of a collection, with what is wanted of each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import DeclarationError, UnknownNameError, nearest
from vines.pipeline import Pipeline, file_of, find, load, load_collection
from vines.stages.api._home import Home, current
from vines.stages.kinds._register import register_kinds

if TYPE_CHECKING:
    from vines.pipeline import Collection, Declaration

__all__ = ["Part", "load_parts", "load_pipeline", "members_of"]


@dataclass(frozen=True, slots=True)
class Part:
    """A pipeline and what is wanted of it.

    Attributes
    ----------
    pipeline : Pipeline
        As declared.
    stages : tuple of str or None
        The stages that are wanted; all if None.
    overrides : dict
        The values that replace some of its file.
    collection : str
        The collection that was asked for; empty if it was the pipeline itself.
    """

    pipeline: Pipeline
    stages: tuple[str, ...] | None
    overrides: dict[str, Any]
    collection: str = ""

    @property
    def prefix(self) -> str:
        """What stands before the names of its stages where several pipelines are shown together."""
        return f"{self.pipeline.name}." if self.collection else ""


def members_of(name: str | Declaration, *, study: Home | None = None) -> tuple[str | Declaration, ...]:
    """Return the pipelines that a name stands for: those of a collection, or the name alone.

    Raises
    ------
    UnknownNameError, FileMissingError, DeclarationError
        One line each: no such pipeline or file, or what is wrong in it.
    """
    collection = _collection(name, (study or current()).root)
    return (name,) if collection is None else collection.members


def load_pipeline(
    name: str | Declaration, overrides: Mapping[str, Any] | None = None, *, study: Home | None = None
) -> Pipeline:
    """Read the declaration of a pipeline, by name, by the path of its file, or as it was made in Python.

    Raises
    ------
    UnknownNameError, FileMissingError, DeclarationError, ParameterError, StateError
        One line each: no such pipeline or file, or what is wrong in it.
    """
    register_kinds()
    root = (study or current()).root
    if isinstance(name, str):
        path = find(name, root)
        _check_name(path, root)
        return load(path, overrides, root=root)
    return name.load(overrides, root=root)


def load_parts(
    name: str | Declaration,
    stages: Iterable[str] | None = None,
    overrides: Mapping[str, Any] | None = None,
    *,
    study: Home | None = None,
) -> list[Part]:
    """Read a pipeline, or all pipelines of a collection, with what is wanted of each.

    Parameters
    ----------
    name : str or Declaration
        A pipeline or a collection.
    stages : iterable of str, optional
        Of a pipeline, names of stages; of a collection, names of pipelines, or ``<pipeline>.<stage>``.
    overrides : mapping, optional
        Values by dotted key; in a collection the name of a pipeline stands before each.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Raises
    ------
    UnknownNameError, FileMissingError, DeclarationError, ParameterError, StateError
        As :func:`load_pipeline`, and where a stage or a key names no pipeline of the collection.
    """
    given = dict(overrides or {})
    study = study or current()
    collection = _collection(name, study.root)
    if collection is None:
        return [Part(load_pipeline(name, given, study=study), None if stages is None else tuple(stages), given)]
    wanted = _by_member(collection, None if stages is None else tuple(stages))
    own = _split(collection, given)
    return [
        Part(load_pipeline(member, own[member], study=study), wanted[member], own[member], collection.name)
        for member in collection.members
        if member in wanted
    ]


def _check_name(path: Path, root: Path) -> None:
    """Refuse a file that would take the name, and so the results, of a pipeline that the project has."""
    known = file_of(path.stem, root)
    if known is not None and known != path and known.resolve() != path.resolve():
        raise DeclarationError(f"{path}: the pipeline {path.stem!r} is declared in {known} already; rename this file")


def _collection(name: str | Declaration, root: Path) -> Collection | None:
    if not isinstance(name, str):
        return None
    path = find(name, root)
    _check_name(path, root)
    return load_collection(path, root)


def _by_member(collection: Collection, stages: tuple[str, ...] | None) -> dict[str, tuple[str, ...] | None]:
    """Return the wanted pipelines, each with its wanted stages (all if None)."""
    if stages is None:
        return dict.fromkeys(collection.members)
    wanted: dict[str, tuple[str, ...] | None] = {}
    for text in stages:
        member, dot, stage = text.partition(".")
        if member not in collection.members:
            known = nearest(member, collection.members)
            raise UnknownNameError(f"collection {collection.name!r} has no pipeline {member!r}: {known}")
        before = wanted.get(member, ())
        wanted[member] = (*before, stage) if dot and before is not None else None
    return wanted


def _split(collection: Collection, overrides: dict[str, Any]) -> dict[str, dict[str, Any]]:
    own: dict[str, dict[str, Any]] = {member: {} for member in collection.members}
    for key, value in overrides.items():
        member, _, rest = key.partition(".")
        if member not in own or not rest:
            raise DeclarationError(
                f"{collection.path}: cannot set {key!r}: {collection.name} is a collection, so the name of a pipeline "
                f"stands before the key, such as {collection.members[0]}.params.mu; {nearest(member, own)}"
            )
        own[member][rest] = value
    return own
