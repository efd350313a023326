"""Kernels that others call by symbol: compiled once, not copied into every caller.

numba links a copy of each callee, with all that it calls, into each caller, and optimises and emits it again. That is
right for the inside of a loop and a waste for what is called once an event or once a run. A linked kernel is a function
of its own: its callers hold its name, which the dynamic linker of LLVM resolves, so its machine code exists once, and a
change in it compiles no caller.
"""

from __future__ import annotations

import functools
import hashlib
import importlib
import inspect
from collections.abc import Callable
from typing import Any

import llvmlite.binding
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import signature
from numba.extending import lower_builtin, type_callable

__all__ = ["Linked", "kernel_of", "load_symbols", "symbols_in"]

_PREFIX = "vines_kernel_"
_KNOWN: dict[str, tuple[str, str, tuple[Any, ...], str]] = {}
"""Module, name, types of arguments and of the result for each symbol of this process."""


class Linked:
    """A kernel that other kernels call by its symbol.

    Parameters
    ----------
    dispatcher : numba dispatcher
        What compiles it; its own cache keeps the machine code.
    for_python : callable
        Makes a dispatcher that Python can call of a function.
    """

    by_symbol = True

    def __init__(self, dispatcher: Any, for_python: Callable[[Any], Any]) -> None:
        self.dispatcher = dispatcher
        self._for_python = for_python
        self.py_func: Callable[..., Any] = dispatcher.py_func
        self.__name__ = self.py_func.__name__
        self.__qualname__ = self.py_func.__qualname__
        self.__module__ = self.py_func.__module__
        self.__doc__ = self.py_func.__doc__
        self.__wrapped__ = self.py_func
        self.symbol_base = f"{self.__module__}.{self.__qualname__}"
        self._loaded: set[str] = set()
        type_callable(self)(self._type)
        lower_builtin(self, types.VarArg(types.Any))(self._lower)

    @functools.cached_property
    def _from_python(self) -> Any:
        """A function that takes Python's objects apart and calls the kernel, compiled when first needed."""
        names = ", ".join(inspect.signature(self.py_func).parameters)
        place: dict[str, Any] = {"kernel": self, "__name__": self.__module__}
        exec(f"def {self.__name__}({names}):\n    return kernel({names})\n", place)
        return self._for_python(place[self.__name__])

    def __call__(self, *arguments: Any) -> Any:
        return self._from_python(*arguments)

    @property
    def signatures(self) -> list[Any]:
        """Types of arguments for which it is compiled."""
        return self.dispatcher.signatures

    def load(self, arguments: tuple[Any, ...]) -> tuple[str, Any]:
        """Compile or load the kernel for types of arguments; return its symbol and the type of its result."""
        self.dispatcher.compile(arguments)
        compiled = self.dispatcher.overloads[arguments]
        result = compiled.signature.return_type
        symbol = self._symbol(arguments, result)
        if symbol not in self._loaded:
            address = compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name)
            llvmlite.binding.add_symbol(symbol, address)
            self._loaded.add(symbol)
            _KNOWN[symbol] = (self.__module__, self.__name__, arguments, str(result))
        return symbol, result

    def _symbol(self, arguments: tuple[Any, ...], result: Any) -> str:
        # What the caller must agree on with the callee: who it is, and the types on both sides.
        types_of = hashlib.sha256(f"{arguments} -> {result}".encode()).hexdigest()[:16]
        return f"{_PREFIX}{self.symbol_base.replace('.', '_')}_{types_of}"

    def _type(self, context: Any) -> Any:
        del context

        def typer(*arguments: Any) -> Any:
            plain = tuple(types.unliteral(each) for each in arguments)
            _, result = self.load(plain)
            return signature(result, *plain)

        typer.pysig = inspect.signature(self.py_func)  # pyright: ignore[reportFunctionMemberAccess]
        return typer

    def _lower(self, context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        symbol, _ = self.load(tuple(sig.args))
        kind = context.call_conv.get_function_type(sig.return_type, sig.args)
        callee = cgutils.get_or_insert_function(builder.module, kind, symbol)
        status, result = context.call_conv.call_function(builder, callee, sig.return_type, sig.args, arguments)
        with cgutils.if_unlikely(builder, status.is_error):
            context.call_conv.return_status_propagate(builder, status)
        return result


def symbols_in(library: Any) -> list[tuple[str, str, str, tuple[Any, ...]]]:
    """Return the linked kernels that a compiled one calls: symbol, module, name, types of arguments."""
    found = sorted(each.name for each in library._final_module.functions if each.name.startswith(_PREFIX))
    return [(symbol, *_KNOWN[symbol][:3]) for symbol in found]


def load_symbols(symbols: list[tuple[str, str, str, tuple[Any, ...]]]) -> bool:
    """Load linked kernels; False if one of them takes or gives other types than when its caller was compiled."""
    if any(_outdated(each) for *_, arguments in symbols for each in arguments):
        return False
    for symbol, module, name, arguments in symbols:
        kernel = kernel_of(module, name)
        if not isinstance(kernel, Linked) or kernel.load(arguments)[0] != symbol:
            return False
    return True


def kernel_of(module: str, name: str) -> Any:
    """Return the kernel that a module has under the name of its function; the first body of a name by type."""
    found = getattr(importlib.import_module(module), name, None)
    return getattr(found, "first", found)


def _outdated(kind: Any) -> bool:
    """Say whether a type holds a named tuple whose class has other fields by now."""
    named = getattr(kind, "instance_class", None)
    if named is not None and tuple(kind.fields) != named._fields:
        return True
    return isinstance(kind, types.BaseTuple) and any(_outdated(each) for each in getattr(kind, "types", ()))
