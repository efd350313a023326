"""numba times what it holds its locks for, and hears of each call of LLVM twice for that; nobody asks for the times.

Kernels call kernels forty deep: a million notices for the kernels of a system. Of its passes it tells, too, and here
only where somebody listens. What it does to variables it tells a logger, statement by statement.
"""

from __future__ import annotations

import logging
from contextlib import AbstractContextManager, nullcontext
from typing import Any

from llvmlite.binding import ffi
from numba.core import event, ssa

__all__ = ["time_no_locks"]

_LOCKS = ("numba:compiler_lock", "numba:llvm_lock")


def time_no_locks() -> None:
    """Let numba not time its locks, from now on, in this process."""
    if getattr(event.install_timer, "leaves_locks", False):
        return
    install = event.install_timer

    def install_timer(kind: str, callback: Any) -> AbstractContextManager[Any]:
        return nullcontext() if kind in _LOCKS else install(kind, callback)

    install_timer.leaves_locks = True  # pyright: ignore[reportFunctionMemberAccess]
    event.install_timer = install_timer
    trigger = event.trigger_event

    def trigger_event(kind: str, data: Any = None) -> AbstractContextManager[Any]:
        return trigger(kind, data) if event._registered[kind] else nullcontext()

    event.trigger_event = trigger_event
    if not ssa._logger.isEnabledFor(logging.DEBUG):
        ssa._logger = _Silent()


class _Silent:
    """A logger that is told and says nothing."""

    def debug(self, *_: Any) -> None:
        """Say nothing."""

    for enter, leave in list(ffi.lib._lock._cblist):
        if enter.__module__.partition(".")[0] == "numba":
            ffi.unregister_lock_callback(enter, leave)
