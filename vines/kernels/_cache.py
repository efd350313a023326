"""Compiled kernels on disk: found by the kernel's own digest, wherever the checkout lies.

numba's own cache looks at the file in which the cached function stands: a changed comment there compiles again, and a
changed helper in another file does not. Here a kernel's file is named by its digest (`vines.kernels._digest`), and is
loaded only after the kernels that it calls by symbol.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import os
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from pickle import UnpicklingError
from types import FunctionType
from typing import Any

import numpy as np
from filelock import FileLock
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator

from vines.kernels._announcement import announce
from vines.kernels._bodies import Body, body_digest, gathered, remember, went_into
from vines.kernels._digest import digest_of
from vines.kernels._linked import kernel_of, load_symbols, symbols_in
from vines.kernels._settings import TARGET
from vines.places import cache_folder

__all__ = ["CACHE", "LazyCache", "asked_for", "is_there"]


def _folder() -> Path:
    """Return the folder of compiled kernels: NUMBA_CACHE_DIR if it is set, else in the cache folder of vines."""
    named = os.environ.get("NUMBA_CACHE_DIR")
    return (Path(named) if named else cache_folder()) / "kernels"


CACHE = _folder()
"""The folder of the compiled kernels."""

DAYS = 30.0
"""A kernel of other sources that was not asked for so long is deleted when a new one is kept."""


_WAY = 3
"""Raised when the same sources come to other machine code: 3, copies of kernels from before their machine code."""

_DIGEST: dict[FunctionType, str] = {}
"""The digest of a kernel whose cache is being made; numba's interface has no room for it."""


class _Locator(_CacheLocator):
    """Says where the machine code of a function lies, by its module, name and digest."""

    def __init__(self, function: FunctionType) -> None:
        self.function = function
        self._path = CACHE / function.__module__
        self._digest = _DIGEST[function]

    def get_cache_path(self) -> str:  # pyright: ignore[reportIncompatibleMethodOverride]
        return str(self._path)

    def ensure_cache_path(self) -> None:
        self._path.mkdir(parents=True, exist_ok=True)

    def get_source_stamp(self) -> str:  # pyright: ignore[reportIncompatibleMethodOverride]
        return f"numpy {np.__version__}"

    def get_disambiguator(self) -> str:  # pyright: ignore[reportIncompatibleMethodOverride]
        return self._digest

    @classmethod
    def from_function(cls, py_func: FunctionType, py_file: str) -> _Locator:
        del py_file
        return cls(py_func)


class _Impl(CompileResultCacheImpl):
    """Keeps with the machine code of a kernel the symbols that it calls, and the bodies by type that went into it."""

    _locator_classes = [_Locator]  # noqa: RUF012 - the attribute is numba's

    def reduce(self, cres: Any) -> Any:
        bodies = went_into(self._function(), cres.signature.args)
        # The types of all variables as text nobody reads.
        rest = super().reduce(cres._replace(type_annotation=""))
        return symbols_in(cres.library), [(*body, body_digest(body)) for body in sorted(bodies)], rest

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        symbols, bodies, rest = payload
        known = {Body(*each[:-1]): each[-1] for each in bodies}
        if any(body_digest(body) != digest for body, digest in known.items()) or not load_symbols(symbols):
            return None
        found = super().rebuild(target_context, rest)
        if found is not None:
            remember(self._function(), found.signature.args, known)
        return found

    def _function(self) -> FunctionType:
        locator: Any = self.locator
        return locator.function


class _KernelCache(FunctionCache):
    _impl_class = _Impl


_UNREADABLE = (OSError, EOFError, UnpicklingError, ImportError, AttributeError, ValueError)
"""What reading ends in where a file is damaged or forbidden, or holds types that the sources no longer have; the kernel
is then compiled again."""

_ASKED: set[tuple[str, str]] = set()
"""Module and name of the kernels that this process asked for, from the cache or compiled."""


def asked_for() -> set[tuple[str, str]]:
    """Return module and name of the kernels that this process has asked for so far."""
    return set(_ASKED)


def is_there(module: str, name: str) -> bool:
    """Say whether a kernel is kept for the sources as they are; one whose module was moved or removed is not."""
    try:
        kernel = kernel_of(module, name)
    except ModuleNotFoundError:
        return False
    cache = getattr(getattr(kernel, "dispatcher", kernel), "_cache", None)
    if not isinstance(cache, LazyCache):
        return False
    return any((CACHE / module).glob(f"*.{name}-{cache.digest}.*.nbi"))


@contextlib.contextmanager
def _few_collections() -> Iterator[None]:
    """Let Python look for cycles rarely: compiling makes millions of small objects and few cycles."""
    before = gc.get_threshold()
    if 0 < before[0] < 200_000:
        gc.set_threshold(200_000, 50, 100)
    try:
        yield
    finally:
        gc.set_threshold(*before)


class LazyCache:
    """The cache of one kernel, which numba asks for machine code: made when it is first asked.

    Parameters
    ----------
    function : function
        The kernel as written.
    options : mapping
        How it is compiled.
    """

    def __init__(self, function: FunctionType, options: Mapping[str, Any]) -> None:
        self._function = function
        self._options = options
        self._made: _KernelCache | None = None

    @functools.cached_property
    def digest(self) -> str:
        """Digest of the kernel as it is loaded in this process, for the processor that it runs on."""
        return digest_of(self._function, {**self._options, "target": TARGET, "way": _WAY})

    def _cache(self) -> _KernelCache:
        if self._made is None:
            _DIGEST[self._function] = self.digest
            self._made = _KernelCache(self._function)
            if "<" not in self._function.__code__.co_filename:
                _ASKED.add((self._function.__module__, self._function.__qualname__))
        return self._made

    @property
    def cache_path(self) -> str:
        """Folder in which the kernel is kept."""
        return self._cache().cache_path

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled kernel for a signature, or None where none is kept that can be read."""
        cache = self._cache()
        with contextlib.suppress(*_UNREADABLE):
            # numba would first work out the key under which to look.
            if Path(cache._cache_file._index_path).exists():
                return cache.load_overload(sig, target_context)
        return None

    def compiled(self, sig: Any, target_context: Any, compile_it: Callable[[], Any]) -> Any:
        """Return what `compile_it` returns, or what another process has kept meanwhile; say that it takes its time."""
        with self._alone():
            found = self.load_overload(sig, target_context)
            if found is not None:
                # numba does this itself for what it loads, and while it compiles; here it believes that it compiled.
                target_context.insert_user_function(found.entry_point, found.fndesc, [found.library])
            else:
                announce(CACHE)
                with gathered(self._function, sig), _few_collections():
                    found = compile_it()
                # Of the kernels it holds copies of, too, as numba does for what it loads.
                for environment in found._find_referenced_environments():
                    found.library.codegen.set_env(environment.env_name, environment)
                # That it can't be written does no harm.
                with contextlib.suppress(OSError):
                    self._keep(sig, found)
                    self._delete_old()
            return found

    def _keep(self, sig: Any, found: Any) -> None:
        cache = self._cache()
        try:
            cache.save_overload(sig, found)
        except (EOFError, UnpicklingError, ImportError, AttributeError):
            # The list of what is kept of this kernel is damaged, or of types that are no more.
            cache.flush()
            cache.save_overload(sig, found)

    @contextlib.contextmanager
    def _alone(self) -> Iterator[None]:
        """Let no other process compile this kernel meanwhile; where nothing can be written, nobody waits."""
        cache = self._cache()
        try:
            cache._impl.locator.ensure_cache_path()
            lock = FileLock(Path(cache.cache_path) / f"{cache._impl.filename_base}.lock")
            lock.acquire()
        except OSError:
            yield
            return
        try:
            yield
        finally:
            lock.release()

    def save_overload(self, sig: Any, data: Any) -> None:
        """Do nothing: `compiled` has kept it; numba's interface."""

    def _delete_old(self) -> None:
        """Delete what was kept of this kernel for other sources and not used for long."""
        cache = self._cache()
        kernel, _, _ = cache._impl.filename_base.rpartition(f"-{cache._impl.locator.get_disambiguator()}")
        for path in Path(cache.cache_path).glob(f"{kernel}-*"):
            with contextlib.suppress(OSError):
                if time.time() - max(path.stat().st_mtime, path.stat().st_atime) > DAYS * 86_400:
                    path.unlink()

    def enable(self) -> None:
        """Use the cache; numba's interface."""
        self._cache().enable()

    def disable(self) -> None:
        """Do without the cache; numba's interface."""
        self._cache().disable()

    def flush(self) -> None:
        """Forget what is kept; numba's interface."""
        self._cache().flush()
