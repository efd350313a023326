"""LLVM is asked to simplify the functions that a module has, not those that it only names.

numba makes passes for each function before it links modules, also for those declared elsewhere, of which there are five
for each that has a body.
"""

from __future__ import annotations

from typing import Any

from numba.core.codegen import CPUCodeLibrary

__all__ = ["leave_declarations"]


def leave_declarations() -> None:
    """Let numba simplify only functions that have a body, from now on, in this process."""
    if getattr(CPUCodeLibrary._optimize_functions, "with_bodies", False):
        return

    def optimize_functions(self: Any, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout
        for function in ll_module.functions:
            if not function.is_declaration:
                passes, builder = self._codegen._function_pass_manager()
                passes.run(function, builder)

    optimize_functions.with_bodies = True  # pyright: ignore[reportFunctionMemberAccess]
    CPUCodeLibrary._optimize_functions = optimize_functions
