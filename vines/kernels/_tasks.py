"""Kinds of tasks and the kernels that each needs: compiled beside each other in processes, only those not there yet.

A task is a function that does a little of the work in question, so that numba compiles what the work needs. What it
asked for is written down; the task is warm as long as each of these kernels is there with the digest that it has now.
"""

from __future__ import annotations

import gc
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from vines.cores import cores
from vines.errors import KernelError
from vines.kernels._announcement import expected
from vines.kernels._cache import CACHE, asked_for, is_there

__all__ = ["Task", "compile_tasks", "do_task", "is_warm"]


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
        return all(is_there(module, name) for module, name in needed)
    except (OSError, ValueError, TypeError):
        return False


def do_task(task: Task) -> None:
    """Do a task in this process, which should be a new one, and write down which kernels it asked for."""
    expected()
    # Compiling makes millions of small objects and few cycles: a tenth of its time would go into looking for them.
    gc.set_threshold(200_000, 50, 100)
    module, _, name = task.work.partition(":")
    getattr(import_module(module), name)()
    path = _record(task)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}")
    part.write_text(json.dumps(sorted(asked_for())), "utf-8")
    part.replace(path)


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
    with ThreadPoolExecutor(jobs or cores()) as pool:
        running = {pool.submit(_in_a_process, task): task for task in tasks}
        for done in as_completed(running):
            report(f"  {running[done].text}: {done.result():.1f} s")


def _in_a_process(task: Task) -> float:
    began = time.perf_counter()
    program = f"from vines.kernels import Task, do_task; do_task({task!r})"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    if done.returncode:
        said = done.stderr.strip().splitlines()
        raise KernelError(
            f"the kernels for {task.text!r} could not be compiled: {said[-1] if said else 'no reason given'}"
        )
    return time.perf_counter() - began
