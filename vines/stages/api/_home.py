"""Where a study lives: the folder that declares pipelines, and that of results.

Light, because every query begins with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from vines.places import cache_folder, data_folder, find_root, named_root
from vines.store import Store

__all__ = ["Home", "current"]


@dataclass(frozen=True, slots=True)
class Home:
    """Where a study lives.

    Every function that runs pipelines or asks for results takes one as ``study=``.

    Attributes
    ----------
    root : Path
        Its folder ``pipelines/`` declares the pipelines, beside those that ship with vines.
    data : Path
        Where results lie.
    cache : Path
        For what can be made again.
    """

    root: Path
    data: Path
    cache: Path

    @property
    def store(self) -> Store:
        """The store of its results."""
        return Store(self.data)


def current(root: Path | None = None) -> Home:
    """Return where the study lives that the current folder belongs to, or that VINES_ROOT and VINES_DATA name.

    Parameters
    ----------
    root : Path, optional
        The root, if somebody has named it.

    Raises
    ------
    FileMissingError
        If there is no such folder.
    """
    if root is None:
        return Home(find_root(), data_folder(), cache_folder())
    place = named_root(str(root), "--root")
    data = data_folder(place)
    return Home(place, data, Store(data).cache)
