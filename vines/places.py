"""Where things lie: the root of a project, its data, its cache, and the files that ship with vines.

Every room may import this module; it imports nothing but the standard library and :mod:`vines.errors`.
"""

from __future__ import annotations

import functools
import os
from pathlib import Path

from vines.errors import FileMissingError

__all__ = ["cache_folder", "data_folder", "find_root", "named_root", "shipped"]


def find_root(start: Path | None = None) -> Path:
    """Return the root of the project: ``VINES_ROOT``, or the nearest parent with declarations in ``pipelines/``.

    Where there is none, the folder itself is the root: an installed vines works in any folder with the pipelines that
    ship with it.

    Parameters
    ----------
    start : Path, optional
        Where to look first; the current folder if left out.

    Raises
    ------
    FileMissingError
        If ``VINES_ROOT`` names a folder that does not exist.
    """
    named = os.environ.get("VINES_ROOT")
    if named:
        return named_root(named, "VINES_ROOT")
    here = (start or Path.cwd()).resolve()
    for folder in (here, *here.parents):
        if _declares(folder):
            return folder
    return here


def named_root(named: str, by: str) -> Path:
    """Return the root that somebody has named.

    Parameters
    ----------
    named : str
        A folder.
    by : str
        What names it, for the message.

    Raises
    ------
    FileMissingError
        If there is no such folder.
    """
    root = Path(named).expanduser()
    if not root.is_dir():
        raise FileMissingError(f"{by} is {named!r}, which is not a folder; name an existing one or leave it out")
    return root.resolve()


def _declares(folder: Path) -> bool:
    """Return whether a folder is a project: other repositories have folders of that name too, but no TOML in them."""
    return any((folder / "pipelines").glob("*.toml"))


def data_folder(root: Path | None = None) -> Path:
    """Return the folder of results: ``VINES_DATA``, or ``data/`` under the root of the project; it need not exist.

    Raises
    ------
    FileMissingError
        If something else is there.
    """
    named = os.environ.get("VINES_DATA")
    folder = Path(named).expanduser().resolve() if named else (root or find_root()) / "data"
    if not folder.is_dir() and os.path.lexists(folder):
        by = "VINES_DATA names it" if named else "move it away, or name another folder with VINES_DATA"
        raise FileMissingError(f"{folder} should be the folder of results and is none; {by}")
    return folder


def cache_folder() -> Path:
    """Return the folder for what can be made again: ``data/cache`` of a project, else the user's cache folder.

    A project is recognised by ``VINES_DATA``, ``VINES_ROOT`` or a folder ``pipelines/`` above the current one.
    Elsewhere (a notebook in any folder) nothing is written beside the user's files.
    """
    if os.environ.get("VINES_DATA") or os.environ.get("VINES_ROOT") or _declares(find_root()):
        return data_folder() / "cache"
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "vines"


@functools.cache
def shipped(name: str) -> Path:
    """Return what ships with vines.

    That is the folders ``schemas``, ``pipelines`` and ``starter`` and the files ``LICENSE`` and ``CITATION.cff``.
    In a wheel they are package data; in a checkout they lie beside the package.

    Raises
    ------
    FileMissingError
        If the installation is incomplete.
    """
    package = Path(__file__).resolve().parent
    for folder in (package / "_shipped" / name, package.parent / name):
        if folder.exists():
            return folder
    raise FileMissingError(f"{name!r} that ships with vines is missing; install vines again")
