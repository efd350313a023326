"""Numbers and tuples of them have no references to count, and numba is told so before it looks for any.

At each assignment of a named tuple, and where its life ends, numba takes out every number in it to see whether there is
something to count; that nothing comes of it LLVM finds out later. Of constants with fifty numbers that is much. Before
a variable is assigned again, and where its life ends, it is read and set to zero, for the same purpose.
"""

from __future__ import annotations

from typing import Any

from numba.core.lowering import Lower
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
    _leave_variables()


def _leave_variables() -> None:
    """Let numba not touch variables without references where their lives end."""
    store, delete = Lower.storevar, Lower.delvar

    def is_plain(self: Any, name: str) -> bool:
        kind = self.typeof(name)
        return not (self._disable_sroa_like_opt or self.context.data_model_manager[kind].contains_nrt_meminfo())

    def storevar(self: Any, value: Any, name: str, argidx: Any = None) -> None:
        if argidx is not None or name in self._singly_assigned_vars or not is_plain(self, name):
            store(self, value, name, argidx)
        else:
            self._alloca_var(name, self.typeof(name))
            self.builder.store(value, self.getvar(name))

    def delvar(self: Any, name: str) -> None:
        if not is_plain(self, name):
            delete(self, name)
        elif name not in self._blk_local_varmap:
            self._singly_assigned_vars.discard(name)

    Lower.storevar, Lower.delvar = storevar, delvar
