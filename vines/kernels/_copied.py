"""No machine code is made of a kernel that others only hold copies of: what they copy is its code for LLVM.

numba emits and loads machine code for every function that it compiles, also for those that are inlined wherever they
are called: two of three kernels here.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.compiler import Compiler

__all__ = ["CopiedCompiler", "read_copied_libraries"]

_COPIED = "copied"
"""How the cache marks a library without machine code."""


class _WithoutEnvironments:
    """The code generator of a process, for code that is not there to have the address of its environment set."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)

    def set_env(self, env_name: str, env: Any) -> None:
        """Do nothing: callers set it in their copies; numba's interface."""


class _CopiedLibrary(JITCodeLibrary):
    """The code of a kernel that is linked into its callers, and is called by nobody else."""

    @property
    def codegen(self) -> Any:
        """What generates code; numba's interface."""
        return _WithoutEnvironments(self._codegen)

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: there is no machine code; numba's interface."""
        self._ensure_finalized()
        return 0

    def serialize_using_object_code(self) -> Any:
        """Return what the cache keeps; numba's interface."""
        self._ensure_finalized()
        return self.name, _COPIED, self._get_module_for_linking().as_bitcode()


class CopiedCompiler(Compiler):
    """numba's compiler, for kernels that are only copied into others."""

    def define_pipelines(self) -> Any:
        """Return the passes; numba's interface."""
        state: Any = self.state
        if state.library is None:
            state.library = _CopiedLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        return super().define_pipelines()


def read_copied_libraries() -> None:
    """Let numba read from its cache what has no machine code, from now on, in this process."""
    if getattr(JITCPUCodegen.unserialize_library, "reads_copied", False):
        return
    read = JITCPUCodegen.unserialize_library

    def unserialize_library(self: Any, serialized: Any) -> Any:
        name, kind, code = serialized
        if kind != _COPIED:
            return read(self, serialized)
        library = _CopiedLibrary(self, name)
        library._final_module = library._shared_module = llvmlite.binding.parse_bitcode(code)
        library._finalize_final_module()
        return library

    unserialize_library.reads_copied = True  # pyright: ignore[reportFunctionMemberAccess]
    JITCPUCodegen.unserialize_library = unserialize_library
