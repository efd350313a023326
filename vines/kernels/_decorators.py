"""The decorators of all kernels in vines."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar

from numba import types
from numba.core.compiler import Compiler, CompilerBase
from numba.core.config import _OptLevel
from numba.core.registry import CPUDispatcher

from vines.kernels._bodies import inherit
from vines.kernels._cache import LazyCache
from vines.kernels._closures import look_for_closures_where_they_are
from vines.kernels._copied import CopiedCompiler, read_copied_libraries
from vines.kernels._declarations import leave_declarations
from vines.kernels._elements import address_elements_at_once
from vines.kernels._flags import read_flags_at_once
from vines.kernels._lifetimes import find_lifetimes_once
from vines.kernels._linked import Linked
from vines.kernels._operators import remember_operators
from vines.kernels._ranges import count_rounds_at_once
from vines.kernels._references import count_only_what_counts
from vines.kernels._registries import import_parts_once
from vines.kernels._settings import numba
from vines.kernels._subroutines import keep_subroutines_apart
from vines.kernels._timers import time_no_locks
from vines.kernels._variables import find_variables_quickly
from vines.kernels._whole import pass_tuples_whole

__all__ = ["cold_njit", "entry_njit", "fused_njit", "linked_njit", "loop_njit", "njit"]

_Function = TypeVar("_Function", bound=Callable[..., Any])

remember_operators()
count_only_what_counts()
time_no_locks()
find_variables_quickly()
leave_declarations()
keep_subroutines_apart()
read_copied_libraries()
find_lifetimes_once()
import_parts_once()
address_elements_at_once()
pass_tuples_whole()
count_rounds_at_once()
look_for_closures_where_they_are()
read_flags_at_once()

_FUSED = {"contract", "nsz"}
_FULL = _OptLevel(3)
_LITTLE = _OptLevel(1)


def njit(function: _Function) -> _Function:
    """Compile a small function: IEEE division, GIL released; a kernel that calls it has a copy of it."""
    return _copied(function)


def fused_njit(function: _Function) -> _Function:
    """Compile the inside of a hot loop: a product with a sum may be rounded once, and it is always inlined."""
    return _copied(function, fastmath=_FUSED, forceinline=True)


def loop_njit(function: _Function) -> _Function:
    """Compile a hot loop itself: as `linked_njit`, and a product with a sum may be rounded once."""
    return Linked(_compiled(function, _FULL, fastmath=_FUSED), _call_njit)  # pyright: ignore[reportReturnType]


def linked_njit(function: _Function) -> _Function:
    """Compile a function once: kernels that call it do so by its symbol and hold no copy of it."""
    return Linked(_compiled(function, _FULL), _call_njit)  # pyright: ignore[reportReturnType]


def cold_njit(function: _Function) -> _Function:
    """Compile what runs once a window or once a run: as `linked_njit`, with little optimisation."""
    return Linked(_compiled(function, _LITTLE), _call_njit)  # pyright: ignore[reportReturnType]


def entry_njit(function: _Function) -> _Function:
    """Compile what only Python calls."""
    return _dispatcher(CPUDispatcher, function, _FULL)


def _call_njit(function: _Function) -> _Function:
    """Compile what takes Python's objects apart for a linked kernel, and does nothing else."""
    return _dispatcher(CPUDispatcher, function, _LITTLE)


class _Dispatcher(CPUDispatcher):
    """A function that kernels call. From Python it is called through another one, made when first needed.

    Machine code that takes Python's objects apart is a seventh of all, and only few kernels are called from Python.
    """

    @functools.cached_property
    def from_python(self) -> Any:
        """The same function, to be called from Python."""
        # Compiled like the others, so that what Python sees is what kernels do.
        return _dispatcher(CPUDispatcher, self.py_func, _FULL, **{**self.targetoptions, "no_cpython_wrapper": False})

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return the signature for a call, the same for an argument and for one whose value is known; numba's name."""
        plain = {name: types.unliteral(each) for name, each in dict(kws).items()}
        found = super().get_call_template(tuple(types.unliteral(each) for each in args), plain)
        # Compiled or loaded by now; the third of them are the types of its arguments, in their order.
        inherit(self.py_func, found[2])
        return found

    def __call__(self, *arguments: Any) -> Any:  # pyright: ignore[reportIncompatibleMethodOverride]
        return self.from_python(*arguments)


def _compiled(function: Any, level: _OptLevel, compiler: type[CompilerBase] = Compiler, **options: Any) -> Any:
    """Return a dispatcher for a function that is called by kernels."""
    return _dispatcher(_Dispatcher, function, level, compiler, no_cpython_wrapper=True, **options)


def _copied(function: Any, **options: Any) -> Any:
    """Return a dispatcher for a function of which kernels hold copies."""
    return _compiled(function, _LITTLE, CopiedCompiler, **options)


def _dispatcher(
    kind: type, function: Any, level: _OptLevel, compiler: type[CompilerBase] = Compiler, **options: Any
) -> Any:
    """Return a dispatcher with a cache of ours and a level of optimisation of its own."""
    settings = {"nopython": True, "boundscheck": None, "error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}
    dispatcher = kind(function, locals={}, targetoptions={**settings, **options}, pipeline_class=compiler)
    cache = LazyCache(function, {**dispatcher.targetoptions, "level": int(level), "compiler": compiler.__name__})
    dispatcher._cache = cache
    compile_it = dispatcher._compiler.compile

    def at_level(arguments: Any, result: Any) -> Any:
        # Whoever is compiled in between, because this one calls it, sets its own level.
        config: Any = numba.config  # pyright: ignore[reportPrivateImportUsage]
        before = config.OPT
        config.OPT = level
        try:
            return cache.compiled(arguments, dispatcher.targetctx, lambda: compile_it(arguments, result))
        finally:
            config.OPT = before

    dispatcher._compiler.compile = at_level
    return dispatcher
