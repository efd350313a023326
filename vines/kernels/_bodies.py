"""Which bodies by type went into the kernels that are being compiled.

The digest of a kernel cannot say: which body of a name a call takes is known only with the types of its arguments. So
it is written down while the kernel is compiled, and kept beside its machine code.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from importlib import import_module
from types import FunctionType
from typing import Any, NamedTuple

from vines.kernels._digest import digest_of

__all__ = ["Body", "all_bodies", "body_digest", "gathered", "inherit", "note_body", "remember", "went_into"]


class Body(NamedTuple):
    """A body of a name by type: module and name of the name, module of the body, and the class of its tuples."""

    module: str
    name: str
    home: str
    kind: str


_OPEN: list[set[Body]] = []
"""What has gone so far into the kernels under compilation, the innermost last."""

_WENT_INTO: dict[tuple[FunctionType, Any], frozenset[Body]] = {}
"""What went into the kernels of this process, by function and types of its arguments."""


@contextlib.contextmanager
def gathered(function: FunctionType, arguments: Any) -> Iterator[None]:
    """Write down what goes into a kernel while it is compiled."""
    _OPEN.append(set())
    try:
        yield
    finally:
        remember(function, arguments, _OPEN.pop())


def remember(function: FunctionType, arguments: Any, bodies: Any) -> None:
    """Note what went into a kernel that was compiled or loaded."""
    _WENT_INTO[function, tuple(arguments)] = frozenset(bodies)


def went_into(function: FunctionType, arguments: Any) -> frozenset[Body]:
    """Return what went into a kernel of this process."""
    return _WENT_INTO.get((function, tuple(arguments)), frozenset())


def note_body(body: Body) -> None:
    """Note that the kernel under compilation calls a body."""
    if _OPEN:
        _OPEN[-1].add(body)


def inherit(function: FunctionType, arguments: Any) -> None:
    """Note that the kernel under compilation holds a copy of another one, with what went into that."""
    if _OPEN:
        _OPEN[-1] |= went_into(function, arguments)


def all_bodies() -> frozenset[Body]:
    """Return what went into any kernel of this process."""
    return frozenset().union(*_WENT_INTO.values())


def body_digest(body: Body) -> str:
    """Return the digest of a body as it is loaded; empty if there is none any more."""
    try:
        import_module(body.home)
        bodies: dict[type, Any] = getattr(import_module(body.module), body.name).bodies
    except (ImportError, AttributeError):
        return ""
    for kind, kernel in bodies.items():
        if f"{kind.__module__}.{kind.__qualname__}" == body.kind:
            if getattr(kernel, "by_symbol", False):
                return f"by symbol {kernel.symbol_base}"
            if kernel not in _DIGESTS:
                _DIGESTS[kernel] = digest_of(kernel.py_func, kernel.targetoptions)
            return _DIGESTS[kernel]
    return ""


_DIGESTS: dict[Any, str] = {}
"""Digests of the bodies of this process, which are asked for again by each kernel that they went into."""
