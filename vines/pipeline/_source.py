"""What one source file says: a digest of its code, what it imports, and where the names of a package come from.

Comments, docstrings and blocks for type checkers don't count. A syntax tree is gone through once.
"""

from __future__ import annotations

import ast
import functools
import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vines.errors import DeclarationError

__all__ = ["Source", "read_source", "read_source_once", "stub_of"]

_LAZY = frozenset({"__dir__", "__getattr__"})
_DOCUMENTED = frozenset({ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef})


@dataclass(frozen=True, slots=True)
class Source:
    """What one source file says.

    Attributes
    ----------
    digest : str
        32 hexadecimal digits over its code; the same in all versions of Python.
    imports : list of [module, name]
        Its imports, also those inside functions; the name is empty for the module itself.
    exports : dict of str to [module, name]
        Of a package, where its names come from.
    light : bool
        Whether it is an ``__init__`` that only imports, names, or loads lazily.
    """

    digest: str
    imports: list[list[str]]
    exports: dict[str, list[str]]
    light: bool


@functools.cache
def read_source_once(module: str, file: Path, stamps: tuple[int, ...]) -> Source:
    """Return what a file with these time stamps and sizes says; whoever asks in one process shares it."""
    del stamps
    return read_source(module, file)


def stub_of(file: str) -> str:
    """Return the stub beside an ``__init__.py``, in which a lazy package (lazy_loader) says where its names come from.

    Examples
    --------
    >>> stub_of("vines/__init__.py")
    'vines/__init__.pyi'
    """
    return f"{file}i"


def read_source(module: str, file: Path) -> Source:
    """Return what a file says.

    Raises
    ------
    DeclarationError
        If it is not Python, or a lazy package has no stub.
    """
    is_package = file.name == "__init__.py"
    package = module if is_package else module.rpartition(".")[0]
    tree = _parsed(file)
    found: list[ast.Import | ast.ImportFrom] = []
    digest = hashlib.sha256(_form(tree, found).encode()).hexdigest()
    imports = [pair for node in found for pair in _imports(node, package)]
    body = _counted(tree)
    exports = _exports(body, package) if is_package else {}
    if is_package and any(_attaches_stub(node) for node in body):
        exports |= _exports(_parsed(Path(stub_of(str(file)))).body, package)
    light = is_package and all(_is_light(node) for node in body)
    return Source(digest[:32], list(map(list, dict.fromkeys(map(tuple, imports)))), exports, light)


def _parsed(file: Path) -> ast.Module:
    try:
        return ast.parse(file.read_bytes(), filename=str(file))
    except SyntaxError as error:
        raise DeclarationError(
            f"{file}: line {error.lineno}: {error.msg}; the code of a stage has to be Python"
        ) from None
    except FileNotFoundError:
        raise DeclarationError(f"{file}: the stub of a lazy package is missing; install its package again") from None


def _attaches_stub(node: ast.stmt) -> bool:
    """Whether a statement is ``__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)``."""
    call = node.value if isinstance(node, ast.Assign) else None
    function = call.func if isinstance(call, ast.Call) else None
    return getattr(function, "attr", getattr(function, "id", "")) == "attach_stub"


@functools.cache
def _fields(kind: type[ast.AST]) -> tuple[str, ...]:
    """Return the fields that count; those left out are not the same in all versions of Python."""
    return tuple(name for name in kind._fields if name not in ("kind", "type_comment"))


def _form(node: ast.AST, imports: list[ast.Import | ast.ImportFrom]) -> str:
    """Return a text of a syntax tree that is the same in all versions of Python: empty fields are left out.

    The imports that are met on the way are added to `imports`.
    """
    kind = type(node)
    # four nodes of five are these
    if isinstance(node, ast.Name):
        return f"Name(id={node.id!r},ctx={type(node.ctx).__name__}())"
    if isinstance(node, ast.Constant):
        return "Constant()" if node.value is None else f"Constant(value={node.value!r})"
    if isinstance(node, ast.Attribute):
        return f"Attribute(value={_form(node.value, imports)},attr={node.attr!r},ctx={type(node.ctx).__name__}())"
    if isinstance(node, ast.Import | ast.ImportFrom):
        imports.append(node)
    parts = []
    for name in _fields(kind):
        value = getattr(node, name, None)
        if isinstance(value, list):
            inner = _counted(node) if name == "body" else value
            if inner:
                parts.append(f"{name}=[{','.join([_item(each, imports) for each in inner])}]")
        elif value is not None:
            parts.append(f"{name}={_item(value, imports)}")
    return f"{kind.__name__}({','.join(parts)})"


def _item(value: Any, imports: list[ast.Import | ast.ImportFrom]) -> str:
    return _form(value, imports) if isinstance(value, ast.AST) else repr(value)


def _counted(node: Any) -> list[ast.stmt]:
    """Return the statements of a body without docstring and without what only type checkers see."""
    body: list[ast.stmt] = node.body
    first = body[0] if body and type(node) in _DOCUMENTED else None
    documented = isinstance(first, ast.Expr) and isinstance(getattr(first.value, "value", None), str)
    return [inner for inner in body[documented:] if not _for_checkers(inner)]


def _for_checkers(node: ast.AST) -> bool:
    if not isinstance(node, ast.If) or node.orelse:
        return False
    test = node.test
    return getattr(test, "id", getattr(test, "attr", "")) == "TYPE_CHECKING"


def _imports(node: ast.Import | ast.ImportFrom, package: str) -> list[list[str]]:
    if isinstance(node, ast.Import):
        return [[alias.name, ""] for alias in node.names]
    origin = _origin(node, package)
    return [[origin, "" if alias.name == "*" else alias.name] for alias in node.names]


def _origin(node: ast.ImportFrom, package: str) -> str:
    if not node.level:
        return node.module or ""
    base = package.rsplit(".", node.level - 1)[0]
    return f"{base}.{node.module}" if node.module else base


def _exports(body: list[ast.stmt], package: str) -> dict[str, list[str]]:
    """Return where the names of a package come from: its imports, or the table of a lazy ``__getattr__``."""
    found: dict[str, list[str]] = {}
    for node in body:
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
        return "__all__" in names or _is_literal(node.value) or _attaches_stub(node)
    return isinstance(node, ast.AnnAssign) and (node.value is None or _is_literal(node.value))


def _is_literal(node: ast.expr) -> bool:
    try:
        ast.literal_eval(node)
    except ValueError:
        return False
    return True
