"""What lies in the store and nothing refers to."""

from __future__ import annotations

import os
import shutil
import uuid
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from vines.errors import StoreError

if TYPE_CHECKING:
    from vines.store._store import Store

__all__ = ["Garbage", "find_garbage", "remove_garbage"]


@dataclass(frozen=True, slots=True)
class Garbage:
    """Something that no pin refers to.

    Attributes
    ----------
    what : {"result", "points"}
        A result, or a pool of points.
    key : str
        Its key.
    folder : Path
        Where it lies.
    bytes : int
        How much room it takes; a file that a kept folder shares counts as nothing.
    """

    what: Literal["result", "points"]
    key: str
    folder: Path
    bytes: int


def find_garbage(store: Store, wanted: Collection[str] = ()) -> list[Garbage]:
    """Return the results and pools of a store that nothing refers to.

    Kept are the results that are pinned, the pools that they were put together from, and the pools in `wanted`.

    Parameters
    ----------
    store : Store
        The store.
    wanted : collection of str
        Keys of pools that declared stages ask for, such as one of an interrupted run.

    Raises
    ------
    StoreError
        If a file of pins is damaged; then nobody can say what it refers to.
    """
    pinned = [pin for pins in store.pinned().values() for pin in pins.values()]
    results = {pin["result"] for pin in pinned}
    pools = {*wanted, *(pin["pool"] for pin in pinned if "pool" in pin)}
    for pin in pinned:  # a pin of an earlier version did not name its pool
        if "pool" not in pin and (store.results / pin["result"]).is_dir():
            pools.add(store.result(pin["result"]).manifest.get("pool", ""))
    found: list[Garbage] = []
    places: tuple[tuple[Literal["result", "points"], Path, set[str]], ...] = (
        ("result", store.results, results),
        ("points", store.pools, pools),
    )
    for what, folder, kept in places:
        for path in sorted(folder.iterdir()) if folder.is_dir() else ():
            if path.is_dir() and path.name not in kept:
                found.append(Garbage(what, path.name, path, _size(path)))
    return found


def remove_garbage(store: Store, garbage: Collection[Garbage]) -> None:
    """Remove what was found; each folder leaves its place at once and is emptied afterwards.

    Raises
    ------
    StoreError
        If a folder cannot be moved.
    """
    with store.staging() as trash:
        for each in garbage:
            try:
                each.folder.rename(trash / uuid.uuid4().hex)
            except OSError as error:
                remedy = "; check who owns it" if isinstance(error, PermissionError) else ""
                raise StoreError(f"{each.folder} cannot be removed: {error.strerror}{remedy}") from None
        shutil.rmtree(trash, ignore_errors=True)


def _size(folder: Path) -> int:
    total = 0
    for base, _, names in os.walk(folder):
        for name in names:
            status = (Path(base) / name).stat()
            total += status.st_size if status.st_nlink == 1 else 0
    return total
