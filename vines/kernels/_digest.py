"""The digest of a kernel: what its machine code depends on, and nothing else.

It is taken from the functions themselves: bytecode, constants, and the values of the globals that they use, through
every function that is copied into them. A comment, a docstring or a line moved elsewhere changes none of it; a helper
or a constant changed in another file does. What is called by its symbol (`vines.kernels._linked`) is not followed: its
code is not in the caller. Neither are bodies picked by a type, which depend on the call (`vines.kernels._bodies`).
"""

from __future__ import annotations

import hashlib
import types
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

__all__ = ["digest_of"]


def digest_of(function: types.FunctionType, options: Mapping[str, Any] | None = None) -> str:
    """Return 20 hexadecimal digits over a Python function that is to be compiled, and all that is copied into it.

    Parameters
    ----------
    function : function
        As it was written, before it was decorated.
    options : mapping, optional
        Of its compilation.

    Raises
    ------
    TypeError
        If it uses a global whose value no digest can be taken of.

    Examples
    --------
    >>> def half(x):
    ...     return 0.5 * x
    >>> before = digest_of(half)
    >>> def half(x):
    ...     '''Say more.'''
    ...     return 0.5 * x  # and more
    >>> digest_of(half) == before
    True
    """
    digest = hashlib.sha256(_stable(options or {}).encode())
    for line in _lines(function, {}):
        digest.update(line.encode())
        digest.update(b"\n")
    return digest.hexdigest()[:20]


def _lines(function: types.FunctionType, seen: dict[int, int]) -> Iterator[str]:
    """Yield what a function says, each function once."""
    seen[id(function)] = len(seen)
    yield f"function {function.__module__}.{function.__qualname__} {function.__defaults__!r}"
    yield from _code(function.__code__, function.__doc__)
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        yield from _value(name, cell.cell_contents, function.__code__, seen)
    for name in sorted(set(_names(function.__code__))):
        if name in function.__globals__:
            yield from _value(name, function.__globals__[name], function.__code__, seen)


def _names(code: types.CodeType) -> Iterator[str]:
    yield from code.co_names
    for inner in code.co_consts:
        if isinstance(inner, types.CodeType):
            yield from _names(inner)


def _code(code: types.CodeType, doc: str | None) -> Iterator[str]:
    yield f"code {code.co_code.hex()} {code.co_names} {code.co_varnames} {code.co_freevars} {code.co_argcount}"
    for k, constant in enumerate(code.co_consts):
        if isinstance(constant, types.CodeType):
            yield from _code(constant, None)
        elif not (k == 0 and constant == doc):
            yield f"constant {type(constant).__name__} {constant!r}"


def _value(name: str, value: Any, code: types.CodeType, seen: dict[int, int]) -> Iterator[str]:
    """Yield what a global stands for: numba freezes it into the machine code."""
    compiled = getattr(value, "py_func", None)
    if getattr(value, "by_symbol", False):
        yield f"{name} by symbol {value.symbol_base}"
    elif isinstance(getattr(value, "bodies", None), dict):
        # Which body goes in, the types of the call say: `vines.kernels._bodies`.
        yield f"{name} by type {value.__module__}.{value.__name__}"
    elif compiled is not None:
        yield f"{name} with {_stable(value.targetoptions)}"
        yield from _once(compiled, seen)
    elif isinstance(value, types.ModuleType):
        yield f"{name} module {value.__name__}"
        if value.__name__.partition(".")[0] == "vines":
            for inner in sorted(set(_names(code))):
                if inner in vars(value):
                    yield from _value(f"{name}.{inner}", vars(value)[inner], code, seen)
    elif isinstance(value, np.ndarray):
        yield f"{name} array {value.dtype} {value.shape} {value.tobytes().hex()}"
    elif isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields"):
        yield f"{name} fields {value.__name__} {value._fields}"  # pyright: ignore[reportAttributeAccessIssue]
    elif isinstance(value, bool | int | float | complex | str | bytes | tuple | type(None) | np.generic):
        yield f"{name} value {type(value).__name__} {value!r}"
    elif isinstance(value, types.FunctionType) and value.__module__.partition(".")[0] == "vines":
        yield from _once(value, seen)
    elif callable(value):
        # Of Python, numpy or numba, whose versions the cache knows.
        yield f"{name} callable {getattr(value, '__module__', '')}.{getattr(value, '__qualname__', value)!s}"
    else:
        raise TypeError(f"no digest can be taken of the global {name} of a kernel: {type(value).__name__}")


def _once(function: types.FunctionType, seen: dict[int, int]) -> Iterator[str]:
    if id(function) in seen:
        yield f"again {seen[id(function)]}"
    else:
        yield from _lines(function, seen)


def _stable(options: Mapping[str, Any]) -> str:
    """Return options as a text that is the same in every process: sets have no order."""
    return str(sorted((name, sorted(value) if isinstance(value, set) else value) for name, value in options.items()))
