"""The decorator of the synthetic rig's kernels, with a cache of its own.

numba's cache looks only at the file of the function that was cached, so the folder is named by a digest over the
sources of this room: any change opens an empty one. The setting of numba is put back at once, because the exact
dynamics keep their kernels elsewhere.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

from vines.places import cache_folder

__all__ = ["njit"]

_Function = TypeVar("_Function", bound=Callable[..., Any])


def _folder() -> Path:
    """Return the folder of compiled kernels of these sources: beside those of the rest of vines."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).resolve().parent.glob("*.py")):
        digest.update(path.name.encode() + path.read_bytes())
    named = os.environ.get("NUMBA_CACHE_DIR")
    base = Path(named) if named else cache_folder()
    if base.parent.name == "numba":
        base = base.parent.parent
    return base / "numba" / f"rig-{digest.hexdigest()[:16]}"


_FOLDER = _folder()


def njit(function: _Function) -> _Function:
    """Compile a function: cached on disk, IEEE division, GIL released."""
    settings: Any = numba.config  # pyright: ignore[reportPrivateImportUsage]
    before = settings.CACHE_DIR
    settings.CACHE_DIR = str(_FOLDER)
    try:
        return numba.njit(cache=True, error_model="numpy", nogil=True)(function)  # pyright: ignore[reportReturnType]
    finally:
        settings.CACHE_DIR = before
