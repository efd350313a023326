"""numba looks for closures, and for arrays made of lists, only in kernels that have any.

It would work out the lives of all variables for that, twice, and look at each call and each loop.
"""

from __future__ import annotations

from types import CodeType
from typing import Any

from numba.core.untyped_passes import InlineClosureLikes

__all__ = ["look_for_closures_where_they_are"]

_INLINED = {"array", "asarray", "reduce", "stencil"}
"""Names of what that pass of numba puts code in place of, beside closures and comprehensions."""


def look_for_closures_where_they_are() -> None:
    """Let numba pass over kernels without code inside their code, from now on, in this process."""
    if getattr(InlineClosureLikes.run_pass, "passes_over", False):
        return
    look = InlineClosureLikes.run_pass

    def run_pass(self: Any, state: Any) -> Any:
        code = state.func_id.code
        nested = any(isinstance(each, CodeType) for each in code.co_consts)
        ours = state.func_id.modname.partition(".")[0] == "vines"
        return look(self, state) if nested or not ours or _INLINED.intersection(code.co_names) else False

    run_pass.passes_over = True  # pyright: ignore[reportFunctionMemberAccess]
    InlineClosureLikes.run_pass = run_pass
