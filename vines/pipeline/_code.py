"""The code digest of a stage: what its body and everything that the body imports would compute, and nothing else.

It is static. Comments, docstrings and blocks for type checkers don't count; imports are followed through the package of
the body and through vines, also those inside functions. A name that a package re-exports leads to the module that
defines it, so an ``__init__`` that only imports doesn't count, and adding an export makes nothing stale.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import importlib.util
import json
import os
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vines.errors import DeclarationError
from vines.store import key_of, write_text

__all__ = ["CodeDigests"]

# They say what went wrong and where things lie, never what comes out.
_NEUTRAL = frozenset({"vines.errors", "vines.places"})
_LAZY = frozenset({"__dir__", "__getattr__"})
_FORM = 1
"""Raised when the digest is computed differently, so that an old cache is not used."""
_SETTLED_NS = 2_000_000_000
"""A file changed less than this ago may change again within the clock's step: it is read, not taken from the cache."""


@dataclass(frozen=True, slots=True)
class _Module:
    """What one source file says.

    `imports` and the values of `exports` are pairs of a module and a name in it, the name empty for the module itself.
    """

    digest: str
    imports: list[list[str]]
    exports: dict[str, list[str]]
    light: bool


@dataclass
class CodeDigests:
    """Digests of bodies, with a cache of what was read, by the time stamps of the files.

    Parameters
    ----------
    cache : Path, optional
        File of the cache; without one, or where it cannot be written, every source is read.
    """

    cache: Path | None = None
    _cached: dict[str, Any] | None = None
    _changed: bool = False
    _seen: dict[str, _Module | None] = field(default_factory=dict)
    _roots: dict[str, Path | None] = field(default_factory=dict)
    _bodies: dict[str, dict[str, str]] = field(default_factory=dict)

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
                raise DeclarationError(f"the body {body!r} of a stage kind does not exist; install vines again")
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

    def digest(self, body: str) -> str:
        """Return one digest for a body: SHA-256 over its modules."""
        return key_of([body, self.modules(body)])

    def save(self) -> None:
        """Write the cache if something new was read. That it cannot be written does no harm."""
        if self.cache is not None and self._changed:
            try:
                write_text(self.cache, json.dumps({"form": _FORM, "files": self._cached}))
            except OSError:
                return
            self._changed = False

    def _follow(self, module: str, name: str, found: dict[str, str], open_ends: list[list[str]]) -> None:
        read = self._module(module)
        if read is None or module in _NEUTRAL:
            return
        packages = [module.rsplit(".", depth)[0] for depth in range(1, module.count(".") + 1)]
        for package in packages:
            above = self._module(package)
            if above is not None and not above.light:
                self._take(package, above, found, open_ends)
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
    def _take(module: str, read: _Module, found: dict[str, str], open_ends: list[list[str]]) -> None:
        if module not in found:
            found[module] = read.digest
            open_ends.extend(read.imports)

    def _is_package(self, module: str) -> bool:
        file = self._file(module)
        return file is not None and file.name == "__init__.py"

    def _file(self, module: str) -> Path | None:
        top, _, rest = module.partition(".")
        if top not in self._roots:
            spec = importlib.util.find_spec(top)
            places = spec.submodule_search_locations if spec is not None else None
            self._roots[top] = Path(next(iter(places))) if places else None
        folder = self._roots[top]
        if folder is None:
            return None
        place = os.path.join(folder, *rest.split(".")) if rest else str(folder)  # noqa: PTH118 - it is called often
        for name in (f"{place}.py", f"{place}/__init__.py"):
            if os.path.isfile(name):  # noqa: PTH113 - it is called often
                return Path(name)
        return None

    def _module(self, module: str) -> _Module | None:
        if module not in self._seen:
            file = self._file(module)
            self._seen[module] = None if file is None else self._read(module, file)
        return self._seen[module]

    def _read(self, module: str, file: Path) -> _Module:
        stat = file.stat()
        stamp = [stat.st_mtime_ns, stat.st_size, module]
        if self._cached is None:
            self._cached = self._load()
        entry = self._cached.get(str(file))
        if entry is not None and entry["stamp"] == stamp:
            return _Module(entry["digest"], entry["imports"], entry["exports"], entry["light"])
        settled = time.time_ns() - stat.st_mtime_ns > _SETTLED_NS
        read = _read_once(module, file, stat.st_mtime_ns, stat.st_size) if settled else _read_source(module, file)
        if settled:
            self._cached[str(file)] = {
                "stamp": stamp,
                "digest": read.digest,
                "imports": read.imports,
                "exports": read.exports,
                "light": read.light,
            }
            self._changed = True
        return read

    def _load(self) -> dict[str, Any]:
        try:
            cached = json.loads(self.cache.read_text("utf-8")) if self.cache is not None else {}
            return cached["files"] if cached.get("form") == _FORM else {}
        except (OSError, ValueError, KeyError, AttributeError):
            return {}


@functools.cache
def _read_once(module: str, file: Path, mtime_ns: int, size: int) -> _Module:
    """Return what a file says; all plans of a process share it, also where there is no cache on disk yet."""
    del mtime_ns, size
    return _read_source(module, file)


def _read_source(module: str, file: Path) -> _Module:
    is_package = file.name == "__init__.py"
    package = module if is_package else module.rpartition(".")[0]
    try:
        tree = _strip(ast.parse(file.read_bytes(), filename=str(file)))
    except SyntaxError as error:
        raise DeclarationError(
            f"{file}: line {error.lineno}: {error.msg}; the code of a stage has to be Python"
        ) from None
    imports = [pair for node in ast.walk(tree) for pair in _imports(node, package)]
    exports = _exports(tree, package) if is_package else {}
    light = is_package and all(_is_light(node) for node in tree.body)
    digest = hashlib.sha256(_form(tree).encode()).hexdigest()
    return _Module(digest[:32], imports, exports, light)


def _strip(tree: ast.Module) -> ast.Module:
    """Remove docstrings and what only type checkers see."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if not isinstance(body, list):
            continue
        first = body[0] if body else None
        documented = isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
        if documented and isinstance(first, ast.Expr) and isinstance(getattr(first.value, "value", None), str):
            del body[0]
        body[:] = [inner for inner in body if not _for_checkers(inner)]
    return tree


def _for_checkers(node: ast.AST) -> bool:
    if not isinstance(node, ast.If) or node.orelse:
        return False
    test = node.test
    return getattr(test, "id", getattr(test, "attr", "")) == "TYPE_CHECKING"


def _form(node: Any) -> str:
    """Return a text of a syntax tree that is the same in all versions of Python: empty fields are left out."""
    if isinstance(node, ast.AST):
        fields = ((name, value) for name, value in ast.iter_fields(node) if value is not None and value != [])
        inner = ",".join(f"{name}={_form(value)}" for name, value in fields if name not in ("kind", "type_comment"))
        return f"{type(node).__name__}({inner})"
    if isinstance(node, list):
        return "[" + ",".join(_form(each) for each in node) + "]"
    return repr(node)


def _imports(node: ast.AST, package: str) -> list[list[str]]:
    if isinstance(node, ast.Import):
        return [[alias.name, ""] for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        origin = _origin(node, package)
        return [[origin, "" if alias.name == "*" else alias.name] for alias in node.names]
    return []


def _origin(node: ast.ImportFrom, package: str) -> str:
    if not node.level:
        return node.module or ""
    base = package.rsplit(".", node.level - 1)[0]
    return f"{base}.{node.module}" if node.module else base


def _exports(tree: ast.Module, package: str) -> dict[str, list[str]]:
    """Return where the names of a package come from: its imports, or the table of a lazy ``__getattr__``."""
    found: dict[str, list[str]] = {}
    for node in tree.body:
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                found[alias.asname or alias.name] = [_origin(node, package), "" if alias.name == "*" else alias.name]
        value = getattr(node, "value", None)
        if isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(value, ast.Dict):
            for key, home in zip(value.keys, value.values, strict=True):
                pair = (getattr(key, "value", None), getattr(home, "value", None))
                if isinstance(pair[0], str) and isinstance(pair[1], str):
                    found[pair[0]] = [_absolute(pair[1], package), pair[0]]
    return found


def _absolute(home: str, package: str) -> str:
    if home.startswith("."):
        return package + home
    return home if "." in home else f"{package}.{home}"


def _is_light(node: ast.stmt) -> bool:
    """Whether a statement of an ``__init__`` only imports, names, or loads lazily."""
    if isinstance(node, ast.Import | ast.ImportFrom):
        return True
    if isinstance(node, ast.FunctionDef):
        return node.name in _LAZY
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Constant)
    if isinstance(node, ast.Assign):
        names = [getattr(target, "id", "") for target in node.targets]
        return "__all__" in names or _is_literal(node.value)
    return isinstance(node, ast.AnnAssign) and (node.value is None or _is_literal(node.value))


def _is_literal(node: ast.expr) -> bool:
    try:
        ast.literal_eval(node)
    except ValueError:
        return False
    return True
