"""Compiling kernels before they are needed: all of them, or those that the stages of a run will ask for."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from typing import TYPE_CHECKING

from vines.pipeline import KINDS
from vines.stages.kinds._register import register_kinds

if TYPE_CHECKING:
    from vines.kernels import Task
    from vines.pipeline import StagePlan

__all__ = ["compile_for", "compile_if_cold", "warm_up"]


def _tasks() -> dict[str, Task]:
    """Return the kinds of tasks by name, those that take longest first and those that wait for others last."""
    from vines.kernels import Task

    listed = (
        Task("one_run", "one run and what it settles to", "vines.attractors._warm_up:one_run"),
        Task("lanes", "many runs beside each other", "vines.dynamics._warm_up:lanes"),
        Task("orbits", "periodic orbits and their families", "vines.orbits._warm_up:orbits"),
        Task("scatter", "runs with scatter", "vines.dynamics._warm_up:scatter"),
        Task("curves", "bifurcations in two parameters", "vines.orbits._warm_up:curves"),
        Task("runs", "energies, samples, tangent maps of a run", "vines.dynamics._warm_up:runs"),
        Task("exits", "regimes under noise", "vines.attractors._warm_up:noise"),
        Task("many_runs", "many runs and what they settle to", "vines.attractors._warm_up:many_runs"),
    )
    return {task.name: task for task in listed}


def warm_up(report: Callable[[str], object] = print) -> None:
    """Compile all kernels that are not there, with one line for each kind of task."""
    from vines.kernels import CACHE, compile_tasks, is_warm

    report(f"kernels, kept in {CACHE}")
    cold = [task for task in _tasks().values() if not is_warm(task)]
    compile_tasks(cold, report)
    if not cold:
        report("  all are there already")


def compile_if_cold(plans: Iterable[StagePlan], report: Callable[[str], object]) -> None:
    """Compile visibly the kernels that these plans will ask for and that are not there; no others."""
    _compile({name for plan in plans if plan.done < plan.wanted for name in plan.kernels}, report)


def compile_for(kind: str, report: Callable[[str], object]) -> None:
    """Compile visibly the kernels that a stage of a kind, which asks for the same always, asks for."""
    register_kinds()
    asked = KINDS.get(kind).kernels
    _compile(set(asked if isinstance(asked, tuple) else ()), report)


def _compile(wanted: Collection[str], report: Callable[[str], object]) -> None:
    if not wanted:
        return
    from vines.kernels import compile_tasks, expected, is_warm

    cold = [task for name, task in _tasks().items() if name in wanted and not is_warm(task)]
    if cold:
        report("compiling kernels, once for these sources, some ten to thirty seconds:")
        compile_tasks(cold, report)
    expected()
