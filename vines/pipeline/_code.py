"""The code digest of a stage: what its body and everything that the body imports would compute, and nothing else.

It is static. Comments, docstrings and blocks for type checkers don't count; imports are followed through the package of
the body and through vines, also those inside functions. A name that a package re-exports leads to the module that
defines it, so an ``__init__`` that only imports, or loads lazily what its stub lists, doesn't count, and adding an
export makes nothing stale.
"""

from __future__ import annotations

import json
import os
import stat
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vines.errors import DeclarationError
from vines.pipeline._source import Source, read_source, read_source_once, stub_of
from vines.store import key_of, read_sealed, write_sealed

__all__ = ["CodeDigests"]

# They say what went wrong and where things lie, never what comes out.
_NEUTRAL = frozenset({"vines.errors", "vines.places"})
_FORM = 1
"""Raised when the digest is computed differently, so that an old cache is not used."""
_SETTLED_NS = 2_000_000_000
"""A file changed less than this ago may change again within the clock's step: it is read, not taken from the cache."""


@dataclass
class CodeDigests:
    """One look at the sources: digests of bodies, each file and each body read once; make another to look again.

    Plans that are made together share one. On disk is a cache of what was read, by the time stamps of the files.

    Parameters
    ----------
    cache : Path, optional
        File of the cache; without one, or where it cannot be written, every source is read.
    """

    cache: Path | None = None
    _cached: dict[str, Any] | None = None
    _changed: bool = False
    _files: dict[str, tuple[str, os.stat_result] | None] = field(default_factory=dict)
    _sources: dict[str, Source | None] = field(default_factory=dict)
    _roots: dict[str, str] = field(default_factory=dict)
    _bodies: dict[str, dict[str, str]] = field(default_factory=dict)
    _several: dict[tuple[str, ...], dict[str, str]] = field(default_factory=dict)
    _digests: dict[tuple[str, ...], str] = field(default_factory=dict)

    def modules(self, body: str) -> dict[str, str]:
        """Return the digest of each module that a body's results depend on, by name.

        Parameters
        ----------
        body : str
            ``"package.module:function"``.

        Raises
        ------
        DeclarationError
            If there is no such module.
        """
        if body not in self._bodies:
            start = body.partition(":")[0]
            followed = {start.partition(".")[0], "vines"}
            if self._file(start) is None:
                raise DeclarationError(f"the body {body!r} of a stage kind does not exist; install its package again")
            found: dict[str, str] = {}
            open_ends = [[start, ""]]
            visited: set[tuple[str, str]] = set()
            while open_ends:
                module, name = open_ends.pop()
                if (module, name) in visited or module.partition(".")[0] not in followed:
                    continue
                visited.add((module, name))
                self._follow(module, name, found, open_ends)
            self._bodies[body] = dict(sorted(found.items()))
        return self._bodies[body]

    def modules_of_all(self, bodies: Iterable[str]) -> dict[str, str]:
        """Return the digests of the modules of several bodies; whoever asks for the same ones shares them."""
        several = tuple(bodies)
        if several not in self._several:
            found = {name: code for body in several for name, code in self.modules(body).items()}
            self._several[several] = dict(sorted(found.items()))
        return self._several[several]

    def digest(self, *bodies: str) -> str:
        """Return one digest for a body, or for one and what it calls beside its imports: SHA-256 over the modules."""
        if bodies not in self._digests:
            self._digests[bodies] = key_of([*bodies, self.modules_of_all(bodies)])
        return self._digests[bodies]

    def read(self, module: str) -> tuple[str, int] | None:
        """Return the digest of a module's source, and when that was changed, ns since the epoch; None without one."""
        file, read = self._file(module), self._source(module)
        return None if file is None or read is None else (read.digest, file[1].st_mtime_ns)

    def save(self) -> None:
        """Write the cache if something new was read. That it cannot be written does no harm."""
        if self.cache is not None and self._changed:
            try:
                write_sealed(self.cache, json.dumps({"form": _FORM, "files": self._cached}))
            except OSError:
                return
            self._changed = False

    def _follow(self, module: str, name: str, found: dict[str, str], open_ends: list[list[str]]) -> None:
        read = self._source(module)
        if read is None or module in _NEUTRAL:
            return
        above = module
        while "." in above:
            above = above.rpartition(".")[0]
            package = self._source(above)
            if package is not None and not package.light:
                self._take(above, package, found, open_ends)
        if not self._is_package(module):
            self._take(module, read, found, open_ends)
        elif name and self._file(f"{module}.{name}") is not None:
            open_ends.append([f"{module}.{name}", ""])
        elif name in read.exports:
            open_ends.append(read.exports[name])
        elif name or not read.light:
            self._take(module, read, found, open_ends)
        else:
            open_ends.extend(read.exports.values())

    @staticmethod
    def _take(module: str, read: Source, found: dict[str, str], open_ends: list[list[str]]) -> None:
        if module not in found:
            found[module] = read.digest
            open_ends.extend(read.imports)

    def _is_package(self, module: str) -> bool:
        file = self._file(module)
        return file is not None and file[0].endswith("__init__.py")

    def _file(self, module: str) -> tuple[str, os.stat_result] | None:
        """Return the file of a module and its status; ``None`` if there is no such module."""
        if module not in self._files:
            self._files[module] = self._find(module)
        return self._files[module]

    def _find(self, module: str) -> tuple[str, os.stat_result] | None:
        top, *rest = module.split(".")
        if top not in self._roots:
            self._roots[top] = _root_of(top)
        if not self._roots[top]:
            return None
        place = "/".join([self._roots[top], *rest])
        for name in (f"{place}.py", f"{place}/__init__.py"):
            try:
                status = os.stat(name)  # noqa: PTH116 - it is called often
            except OSError:
                continue
            if stat.S_ISREG(status.st_mode):
                return name, status
        return None

    def _source(self, module: str) -> Source | None:
        if module not in self._sources:
            file = self._file(module)
            self._sources[module] = None if file is None else self._read(module, *file)
        return self._sources[module]

    def _read(self, module: str, file: str, status: os.stat_result) -> Source:
        times = [status.st_mtime_ns, *_stamp_of_stub(file)]
        stamp = [*times, status.st_size, module]
        if self._cached is None:
            self._cached = self._load()
        entry = self._cached.get(file)
        if entry is not None and entry["stamp"] == stamp:
            return Source(entry["digest"], entry["imports"], entry["exports"], entry["light"])
        if time.time_ns() - max(times) <= _SETTLED_NS:
            return read_source(module, Path(file))
        read = read_source_once(module, Path(file), (*times, status.st_size))
        self._cached[file] = {
            "stamp": stamp,
            "digest": read.digest,
            "imports": read.imports,
            "exports": read.exports,
            "light": read.light,
        }
        self._changed = True
        return read

    def _load(self) -> dict[str, Any]:
        text = read_sealed(self.cache) if self.cache is not None else None
        cached = json.loads(text) if text is not None else {}
        return cached["files"] if cached.get("form") == _FORM else {}


def _stamp_of_stub(file: str) -> list[int]:
    """Return when the stub of a package was changed; nothing for what has none."""
    if not file.endswith("__init__.py"):
        return []
    try:
        return [os.stat(stub_of(file)).st_mtime_ns]  # noqa: PTH116 - it is called often
    except OSError:
        return []


def _root_of(top: str) -> str:
    """Return the folder of a package of the highest level, or the file of a module without its suffix; else nothing."""
    if top in sys.modules:
        spec = sys.modules[top].__spec__
    else:
        from importlib.util import find_spec

        spec = find_spec(top)
    places = spec.submodule_search_locations if spec is not None else None
    if places:
        return str(next(iter(places)))
    return spec.origin.removesuffix(".py") if spec is not None and spec.origin is not None else ""
