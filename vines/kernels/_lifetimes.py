"""Where the lives of variables begin and end numba works out after each of its passes; here once, when it is asked.

The last pass before machine code asks; of those before it only the passes for generators and for blocks in object mode
do, which kernels have not.
"""

from __future__ import annotations

from typing import Any

from numba.core import transforms
from numba.core.postproc import PostProcessor, VariableLifetime

__all__ = ["find_lifetimes_once"]


def find_lifetimes_once() -> None:
    """Let numba look for the lives of a kernel's variables when they are needed, from now on, in this process."""
    if getattr(PostProcessor.run, "waits", False):
        return
    look = PostProcessor.run

    def run(self: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
        code = self.func_ir
        if emit_dels or code.is_generator or code.func_id.modname.partition(".")[0] != "vines":
            look(self, emit_dels, extend_lifetimes)
        else:
            code.blocks = transforms.canonicalize_cfg(code.blocks)
            code.variable_lifetime = VariableLifetime(code.blocks)
            code.generator_info = None

    run.waits = True  # pyright: ignore[reportFunctionMemberAccess]
    PostProcessor.run = run
