"""Computing chunks in this process or in several, through the protocol of ``concurrent.futures.Executor``."""

from __future__ import annotations

import math
import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import TYPE_CHECKING

from vines.errors import StoreError
from vines.pipeline._work import Chunk, Pace, Work
from vines.pipeline._worker import Done, Task, compute_task, prepare_worker

if TYPE_CHECKING:
    from concurrent.futures import ProcessPoolExecutor

__all__ = ["compute_all", "cores"]

WORTH_SECONDS = 4.0
"""Work that would take one process longer than this is worth starting others, which costs each about 1.5 s."""
_DEATHS = 3


def cores() -> int:
    """Return how many processor cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def compute_all(
    work: Work,
    make: Callable[[Chunk], Task],
    stored: Callable[[Done, int], None],
    jobs: int,
    worth: float = WORTH_SECONDS,
) -> None:
    """Compute everything that is left.

    Parameters
    ----------
    work : Work
        What is left; empty at the end.
    make : callable
        Makes the task of a chunk.
    stored : callable
        Told of each chunk that is stored, and how many processes are at work.
    jobs : int
        How many processes there may be.
    worth : float
        Seconds of work from which on more than one process is started.

    Raises
    ------
    StoreError
        If worker processes die again and again.
    """
    pace = Pace()
    while (chunk := work.take(pace.size)) is not None:
        done = compute_task(make(chunk))
        work.finish(chunk, done.last)
        pace.add(done.points, done.seconds)
        stored(done, 1)
        processes = min(jobs, work.width)
        if processes > 1 and pace.seconds_for(work.left) >= max(worth, 1e-9):
            _compute_parallel(work, make, stored, processes, pace)


def _compute_parallel(
    work: Work, make: Callable[[Chunk], Task], stored: Callable[[Done, int], None], processes: int, pace: Pace
) -> None:
    from concurrent.futures.process import BrokenProcessPool

    deaths = 0
    while work.left:
        before = set(multiprocessing.active_children())
        executor = _start(processes)
        flying: dict[Future[Done], Chunk] = {}
        try:
            _drain(executor, flying, work, make, stored, processes, pace)
            executor.shutdown()
        except BrokenProcessPool:
            deaths += 1
            for chunk in reversed(list(flying.values())):
                work.give_back(chunk)
            if deaths >= _DEATHS:
                text = f"worker processes died {deaths} times, perhaps for want of memory"
                raise StoreError(f"{text}; what was computed is kept; run again with fewer --jobs") from None
        finally:
            # after an interruption a chunk may have seconds to go; its part is not there yet, so nothing is lost
            for child in set(multiprocessing.active_children()) - before:
                child.terminate()
            executor.shutdown(wait=False, cancel_futures=True)


def _start(processes: int) -> ProcessPoolExecutor:
    from concurrent.futures import ProcessPoolExecutor

    return ProcessPoolExecutor(
        processes,
        mp_context=multiprocessing.get_context("spawn"),
        initializer=prepare_worker,
        initargs=(os.getpid(),),
    )


def _drain(
    executor: Executor,
    flying: dict[Future[Done], Chunk],
    work: Work,
    make: Callable[[Chunk], Task],
    stored: Callable[[Done, int], None],
    processes: int,
    pace: Pace,
) -> None:
    """Keep every process busy until nothing is left; `flying` holds the chunks that are under way."""
    while True:
        while len(flying) < processes + 1:
            # near the end smaller chunks, so that the processes finish together
            share = math.ceil(work.left / (2 * processes)) if work.free else work.left
            chunk = work.take(max(1, min(pace.size, share)))
            if chunk is None:
                break
            flying[executor.submit(compute_task, make(chunk))] = chunk
        if not flying:
            return
        ready, _ = wait(flying, return_when=FIRST_COMPLETED)
        for future in ready:
            done = future.result()
            chunk = flying.pop(future)
            work.finish(chunk, done.last)
            pace.add(done.points, done.seconds)
            stored(done, processes)
