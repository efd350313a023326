"""Tuples of plain numbers have no references to count, and numba is told so before it takes them apart to look.

At each assignment of a named tuple, and where its life ends, numba takes out every number in it to see whether there is
something to count; that nothing comes of it LLVM finds out later. Of constants with fifty numbers that is much.
"""

from __future__ import annotations

from typing import Any

from numba.core.runtime.context import NRTContext

__all__ = ["count_only_what_counts"]


def count_only_what_counts() -> None:
    """Let numba leave whole what holds no counted references, from now on, in this process."""
    if getattr(NRTContext.get_meminfos, "looks_first", False):
        return
    take_apart = NRTContext.get_meminfos
    counts: dict[Any, bool] = {}

    def get_meminfos(self: Any, builder: Any, ty: Any, val: Any) -> Any:
        model = self._context.data_model_manager[ty]
        if model not in counts:
            counts[model] = model.contains_nrt_meminfo()
        return take_apart(self, builder, ty, val) if counts[model] else []

    get_meminfos.looks_first = True  # pyright: ignore[reportFunctionMemberAccess]
    NRTContext.get_meminfos = get_meminfos
