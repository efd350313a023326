"""The one decorator of every kernel in vines, and the folder in which compiled kernels are kept.

numba's cache on disk looks only at the file of the function that was cached: after a change of a helper in another file
it goes on returning the old machine code. The folder is therefore named by a digest over the sources of every room that
holds kernels, so that any change opens an empty cache. Import this module before numba.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from vines.dynamics._old_kernels import delete_old, is_digest, note_use
from vines.places import cache_folder

__all__ = ["CACHE", "fused_njit", "kernel_digest", "loop_njit", "njit"]

ROOMS = ("model", "dynamics", "orbits", "attractors")
"""Rooms whose sources can change what a kernel computes."""

_Function = TypeVar("_Function", bound=Callable[..., Any])


def kernel_digest() -> str:
    """Return 16 hexadecimal digits over the sources of all rooms that hold kernels.

    Examples
    --------
    >>> len(kernel_digest())
    16
    """
    package = Path(__file__).resolve().parent.parent
    digest = hashlib.sha256()
    for room in ROOMS:
        for path in sorted((package / room).glob("*.py")):
            content = path.read_bytes()
            digest.update(f"{room}/{path.name}:{len(content)}\n".encode())
            digest.update(content)
    return digest.hexdigest()[:16]


def _base_folder() -> Path:
    """Return what NUMBA_CACHE_DIR was before vines named a folder in it, else the cache folder of vines.

    A child process inherits the name that its parent has set; without this it would nest folder in folder.
    """
    named = os.environ.get("NUMBA_CACHE_DIR")
    if not named:
        return cache_folder()
    path = Path(named)
    ours = path.parent.name == "numba" and is_digest(path.name)
    return path.parent.parent if ours else path


CACHE = _base_folder() / "numba" / kernel_digest()
"""The folder of the compiled kernels of these sources."""

if CACHE.is_dir():
    note_use(CACHE)
else:
    # New sources, so kernels of older ones are not asked for again.
    delete_old(CACHE.parent)

os.environ["NUMBA_CACHE_DIR"] = str(CACHE)

import llvmlite.binding  # noqa: E402 - what numba compiles with

WIDE = "+avx512f" in llvmlite.binding.get_host_cpu_features().flatten()
"""Whether the processor has vectors of eight doubles; LLVM would use only half of each unless told to."""

if WIDE and "NUMBA_CPU_FEATURES" not in os.environ and "NUMBA_CPU_NAME" not in os.environ:
    os.environ["NUMBA_CPU_NAME"] = llvmlite.binding.get_host_cpu_name()
    os.environ["NUMBA_CPU_FEATURES"] = llvmlite.binding.get_host_cpu_features().flatten() + ",-prefer-256-bit"

import numba  # noqa: E402 - only now, because numba reads the name of its cache when it is imported

# numba may have been loaded already, in which case it has read another name.
numba.config.CACHE_DIR = str(CACHE)  # pyright: ignore[reportPrivateImportUsage, reportAttributeAccessIssue]


def njit(function: _Function) -> _Function:
    """Compile a function with the settings of every kernel in vines: cached on disk, IEEE division, GIL released."""
    return numba.njit(cache=True, error_model="numpy", nogil=True)(function)  # pyright: ignore[reportReturnType]


def fused_njit(function: _Function) -> _Function:
    """Compile the inside of a hot loop: a product with a sum may be rounded once, and it is always inlined."""
    return numba.njit(cache=True, error_model="numpy", nogil=True, fastmath=_FUSED, forceinline=True)(function)  # pyright: ignore[reportReturnType]


def loop_njit(function: _Function) -> _Function:
    """Compile a hot loop itself: as `njit`, and a product with a sum may be rounded once (fused multiply-add)."""
    return numba.njit(cache=True, error_model="numpy", nogil=True, fastmath=_FUSED)(function)  # pyright: ignore[reportReturnType]


_FUSED = {"contract", "nsz"}
