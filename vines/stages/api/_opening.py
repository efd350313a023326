"""The store of the project that the current folder belongs to; light, because every query begins with it."""

from __future__ import annotations

from vines.places import data_folder
from vines.store import Store

__all__ = ["open_store"]


def open_store() -> Store:
    """Return the store of the project that the current folder belongs to (see :func:`vines.places.data_folder`)."""
    return Store(data_folder())
