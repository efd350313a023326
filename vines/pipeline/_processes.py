"""Worker processes on this machine."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from multiprocessing.context import SpawnContext, SpawnProcess
from types import ModuleType
from typing import Any

from vines.pipeline._worker import prepare_worker

__all__ = ["Processes"]

WORTH_SECONDS = 4.0
"""Work that would take one process longer than this is worth starting others, which costs each about 1.5 s."""
_PATIENCE = 0.5
"""How long an interrupted run waits for the pool's own threads, whose processes are dead by then."""


@contextlib.contextmanager
def _no_script() -> Iterator[None]:
    """Let processes that start meanwhile not import the script that is being run.

    What they compute can be imported by its name. A script without ``if __name__ == "__main__"`` would run the same
    pipeline again in each of them, and wait there for the run that waits for them.
    """
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


@contextlib.contextmanager
def _signals_held() -> Iterator[None]:
    """Let SIGINT and SIGTERM wait until the end; a process that is started meanwhile never gets SIGINT at all."""
    late: list[int] = []
    handlers: dict[int, Any] = {}
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGINT, signal.SIGTERM):
            handlers[number] = signal.signal(number, lambda number, _: late.append(number))
    # what a thread blocks is blocked in the processes that it starts
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
        for number, handler in handlers.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)
        for number in late:
            signal.raise_signal(number)


class _OfNobody(SpawnProcess):
    """A process that does not import the script that runs."""

    def start(self) -> None:
        with _no_script():
            super().start()


class _Context(SpawnContext):
    Process = _OfNobody


class _Pool(ProcessPoolExecutor):
    """A pool that Ctrl-C finds whole: with its thread if it has processes, none of which a Ctrl-C reaches."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Submit a call; processes that it needs start meanwhile."""
        with _signals_held():
            return super().submit(fn, *args, **kwargs)


class Processes:
    """Worker processes on this machine.

    Parameters
    ----------
    jobs : int
        How many.
    """

    apart = False

    def __init__(self, jobs: int) -> None:
        self.worth = WORTH_SECONDS
        self._jobs = jobs
        self._executor: Executor | None = None
        self._before: set[object] = set()

    def size(self) -> int:
        """Return how many there may be."""
        return self._jobs

    def executor(self) -> Executor:
        """Return the pool of processes."""
        if self._executor is None:
            self._before = set(multiprocessing.active_children())
            self._executor = _Pool(
                self._jobs,
                mp_context=_Context(),
                initializer=prepare_worker,
                initargs=(os.getpid(),),
            )
        return self._executor

    def is_loss(self, error: BaseException) -> bool:
        """Whether a process died; the others of its pool die with it, and a new pool takes over."""
        from concurrent.futures.process import BrokenProcessPool

        if not isinstance(error, BrokenProcessPool):
            return False
        self.stop(now=True)
        return True

    def look(self) -> None:
        """Nothing to see: the pool itself tells when a process dies."""

    def stop(self, *, now: bool) -> None:
        """End the processes; a part that is not committed is not there, so nothing is half done."""
        executor, self._executor = self._executor, None
        if executor is None:
            return
        if now:
            for child in set(multiprocessing.active_children()) - self._before:
                child.terminate()
            # Left alone, a thread of the pool closes its pipe while Python, on its way out, writes to it.
            end = threading.Thread(target=executor.shutdown, kwargs={"cancel_futures": True}, daemon=True)
            end.start()
            end.join(_PATIENCE)
        else:
            executor.shutdown()
