"""Functions of numba inside kernels (a product of complex numbers, a power) are compiled for each rule of rounding.

numba compiles one when a kernel first asks for it, and hands it to all later ones, whether or not these allow a product
with a sum to be rounded once. The last bit of a kernel would depend on what else had been compiled before it.
"""

from __future__ import annotations

from typing import Any

from numba.core.base import BaseContext

__all__ = ["keep_subroutines_apart"]


def keep_subroutines_apart() -> None:
    """Let numba keep its functions apart by the rule of rounding of the kernel that asks, in this process."""
    if getattr(BaseContext.subtarget, "keeps_apart", False):
        return
    make = BaseContext.subtarget

    def subtarget(self: Any, **options: Any) -> Any:
        made: Any = make(self, **options)
        if made.fastmath != self.fastmath:
            rule = "fastmath", frozenset(made.fastmath.flags)
            made.cached_internal_func = self.cached_internal_func.setdefault(rule, {})
        return made

    subtarget.keeps_apart = True  # pyright: ignore[reportFunctionMemberAccess]
    BaseContext.subtarget = subtarget
