"""Whether the files of a result are there and whole: sizes each time, contents where somebody may have changed them.

A file that was found right is remembered with its time stamp, and read again only when that is another.
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING

from vines.store._described import damage_of
from vines.store._sealed import read_sealed, write_sealed

if TYPE_CHECKING:
    from vines.store._results import Result

__all__ = ["look", "remember"]


def look(result: Result, seen: Path, names: Collection[str] | None = None, *, thorough: bool = False) -> str:
    """Return in words what is wrong with the files of a result; empty if nothing is.

    Parameters
    ----------
    result : Result
        The result.
    seen : Path
        Where it is remembered which files were found right, and when they had been changed last.
    names : collection of str, optional
        Only these files.
    thorough : bool
        Whether to read files that nobody has read yet; else only those that were changed since.
    """
    known = _known(seen)
    unsure: list[str] = []
    for name, about in result.manifest["files"].items():
        if names is not None and name not in names:
            continue
        if problem := damage_of(result.folder, name, about, contents=False):
            return problem
        changed = os.stat(result.folder / name).st_mtime_ns  # noqa: PTH116 - it is called often
        if known.get(name) != changed and (thorough or name in known):
            unsure.append(name)
    for name in unsure:
        if problem := damage_of(result.folder, name, result.manifest["files"][name]):
            return problem
    if unsure:
        remember(result, seen, unsure)
    return ""


def remember(result: Result, seen: Path, names: Collection[str]) -> None:
    """Note that some files of a result are right as they are now; that it cannot be noted does no harm."""
    with contextlib.suppress(OSError):
        stamps = {name: (result.folder / name).stat().st_mtime_ns for name in names}
        write_sealed(seen, json.dumps({**_known(seen), **stamps}))


def _known(seen: Path) -> dict[str, int]:
    text = read_sealed(seen)
    return {} if text is None else json.loads(text)
