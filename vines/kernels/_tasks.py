"""Kinds of tasks and the kernels that each needs: compiled beside each other in processes, only those not there yet.

A task is a function that does a little of the work in question, so that numba compiles what the work needs. What it
asked for is written down; the task is warm as long as each of these kernels is there with the digest that it has now.
"""

from __future__ import annotations

import gc
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from importlib import import_module
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

from vines.cores import cores
from vines.errors import KernelError
from vines.kernels._announcement import expected
from vines.kernels._bodies import Body, all_bodies, body_digest
from vines.kernels._cache import CACHE, asked_for, is_there
from vines.kernels._settings import numba

__all__ = ["Task", "compile_here", "compile_tasks", "is_warm"]


@dataclass(frozen=True, slots=True)
class Task:
    """A kind of task.

    Attributes
    ----------
    name : str
        Name, also of the file that says which kernels it needs.
    text : str
        What it is, for people.
    work : str
        ``"module:function"`` that does a little of it.
    """

    name: str
    text: str
    work: str


def _record(task: Task) -> Path:
    return CACHE / "tasks" / f"{task.name}.json"


def is_warm(task: Task) -> bool:
    """Say whether every kernel that a task needs is compiled for the sources as they are."""
    try:
        needed = json.loads(_record(task).read_text("utf-8"))
        bodies = [(Body(*each[:-1]), each[-1]) for each in needed["bodies"]]
        return all(is_there(module, name) for module, name in needed["kernels"]) and all(
            body_digest(body) == digest for body, digest in bodies
        )
    except (OSError, ValueError, TypeError, KeyError):
        return False


def compile_tasks(tasks: Iterable[Task], report: Callable[[str], object], jobs: int | None = None) -> None:
    """Do tasks in processes of their own, several at a time, and report one line for each that ends.

    Kernels that two of them need are compiled once: who comes second waits for the first.

    Parameters
    ----------
    tasks : iterable of Task
        Those that take longest first.
    report : callable
        Takes each line.
    jobs : int, optional
        Processes at a time; as many as there are cores if left out.

    Raises
    ------
    KernelError
        If a task fails.
    """
    listed = list(tasks)
    program = f"from vines.kernels import Task, compile_here; compile_here({listed!r}, {jobs or cores()})"
    with tempfile.TemporaryFile("w+", encoding="utf-8") as said:
        # This process may have threads, which a fork does not survive; that one has none.
        with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=said, text=True) as other:
            assert other.stdout is not None
            failed = ""
            try:
                for line in other.stdout:
                    k, seconds = json.loads(line)
                    if seconds is None:
                        failed = f" for {listed[k].text!r}"
                    else:
                        report(f"  {listed[k].text}: {seconds:.1f} s")
            except BaseException:
                other.terminate()
                raise
        if other.returncode:
            said.seek(0)
            lines = said.read().strip().splitlines()
            raise KernelError(f"the kernels{failed} could not be compiled: {lines[-1] if lines else 'no reason given'}")


def compile_here(tasks: Sequence[Task], jobs: int) -> None:
    """Do tasks in processes that are forks of this one, and print number and seconds of each that ends.

    What numba loads before it compiles anything, it loads once for all of them.

    Raises
    ------
    SystemExit
        If one fails, whose seconds are then printed as null; it has said why on stderr.
    """
    # An exit ends the processes that were started here, a death by SIGTERM would not.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    numba.njit(_nothing)()
    gc.freeze()
    context: Any = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
    waiting = list(enumerate(tasks))
    running: dict[Any, tuple[int, Any, float]] = {}
    while waiting or running:
        while waiting and len(running) < jobs:
            k, task = waiting.pop(0)
            process = context.Process(target=_do, args=(task,), daemon=True)
            process.start()
            running[process.sentinel] = (k, process, time.perf_counter())
        for ended in wait(list(running)):
            k, process, began = running.pop(ended)
            process.join()
            print(json.dumps((k, None if process.exitcode else time.perf_counter() - began)), flush=True)
            if process.exitcode:
                sys.exit(1)


def _nothing() -> None:
    """Do nothing."""


def _do(task: Task) -> None:
    """Do a task and write down which kernels it asked for."""
    expected()
    # Compiling makes millions of small objects and few cycles: a tenth of its time would go into looking for them.
    gc.set_threshold(200_000, 50, 100)
    module, _, name = task.work.partition(":")
    getattr(import_module(module), name)()
    path = _record(task)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}")
    bodies = [(*body, body_digest(body)) for body in sorted(all_bodies())]
    part.write_text(json.dumps({"kernels": sorted(asked_for()), "bodies": bodies}), "utf-8")
    part.replace(path)
