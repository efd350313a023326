"""Which pipelines a user means of those that something is stored of."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from pathlib import Path

from vines.errors import UnknownNameError, VinesError, nearest
from vines.pipeline import file_of, members

__all__ = ["stored_pipelines"]


def stored_pipelines(names: Iterable[str], pinned: Collection[str], root: Path) -> list[str]:
    """Return the names of pipelines with results, of collections those of their members; all if no name is given.

    Raises
    ------
    UnknownNameError
        If nothing is stored of a pipeline, or of any member of a collection.

    Examples
    --------
    >>> stored_pipelines((), {"fig4": {}, "fig2": {}}, Path())
    ['fig2', 'fig4']
    """
    found: dict[str, None] = {}
    for name in names:
        try:
            mine = [name] if name in pinned else [each for each in members(name, root) if each in pinned]
        except VinesError:
            mine = []
        if not mine and file_of(name, root) is not None:
            raise UnknownNameError(f"nothing is stored of the pipeline {name!r} yet; 'vines run {name}' computes it")
        if not mine:
            raise UnknownNameError(f"nothing is stored of a pipeline {name!r}: {nearest(name, pinned)}")
        found.update(dict.fromkeys(mine))
    return list(found) if names else sorted(pinned)
