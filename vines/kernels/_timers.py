"""numba times each compilation, also those inside another one, and hears of each call of LLVM once for each of them.

Kernels call kernels forty deep: a million notices for the kernels of a system, a twentieth of the time of compiling.
"""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from typing import Any

from numba.core import event

__all__ = ["time_outermost"]

_LOCKS = ("numba:compiler_lock", "numba:llvm_lock")


def time_outermost() -> None:
    """Let numba time only the outermost of compilations that are inside each other, from now on, in this process."""
    if getattr(event.install_timer, "outermost", False):
        return
    install = event.install_timer

    def install_timer(kind: str, callback: Any) -> AbstractContextManager[Any]:
        return nullcontext() if kind in _LOCKS and event._registered[kind] else install(kind, callback)

    install_timer.outermost = True  # pyright: ignore[reportFunctionMemberAccess]
    event.install_timer = install_timer
