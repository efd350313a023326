"""What several plots refuse."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from typing import TYPE_CHECKING, Any

from vines.errors import DeclarationError, nearest
from vines.schema import table

if TYPE_CHECKING:
    from vines.pipeline import Pipeline, Stage

__all__ = [
    "called",
    "cells",
    "check_panels",
    "check_window",
    "has_diagram",
    "has_runs",
    "needs_table",
    "one_axis",
    "one_stage",
    "one_system",
]


def called(tables: Iterable[str], like: str) -> str:
    """Return what a table of the VI-NES is called among the tables of a stage of any system; empty if it has none such.

    Examples
    --------
    >>> called(("impact_pair_points", "impact_pair_impacts"), "impacts")
    'impact_pair_impacts'
    """
    return next((name for name in tables if table(name).like == like), "")


def check_window(options: Any) -> None:
    """Refuse a window whose ends are the wrong way round."""
    window = options.window
    if window is not None and not window[0] < window[1]:
        raise DeclarationError(f"window is {window[0]:g} to {window[1]:g}; give the lower end first")


def check_panels(options: Any, known: Collection[str]) -> None:
    """Refuse panels that the plot does not have."""
    for panel in options.panels:
        if panel not in known:
            raise DeclarationError(f"unknown panel {panel!r}: {nearest(panel, known)}")


def needs_table(stage: Stage, pipeline: Pipeline, table: str, kind: str) -> None:
    """Refuse a figure without a stage that makes a table, as that of the kind does."""
    if all(table not in pipeline.stages[name].kind.tables for name in stage.needs):
        plot = stage.options.__struct_config__.tag
        raise DeclarationError(f"plot {plot} needs a stage of kind {kind}; name one in needs")


def has_runs(stage: Stage) -> bool:
    """Say whether a stage logs runs of the simulator, which carry their impacts."""
    return stage.kind.logs and bool(called(stage.kind.tables, "impacts"))


def has_diagram(stage: Stage) -> bool:
    """Say whether a stage has what diagrams draw: impacts of points, or orbits on branches."""
    orbits = called(stage.kind.tables, "orbits") and called(stage.kind.tables, "branches")
    return bool(called(stage.kind.tables, "impacts") or orbits)


def one_system(stages: Iterable[Stage], what: str) -> str:
    """Return the system of all stages, and refuse those of several.

    Raises
    ------
    DeclarationError
        With the systems, after `what` in words.
    """
    systems = sorted({one.kind.system for one in stages})
    if len(systems) > 1:
        raise DeclarationError(f"{what} shows one system, the stages are of {', '.join(systems)}")
    return systems[0]


def one_axis(stage: Stage, pipeline: Pipeline) -> None:
    """Refuse stages that do not vary one and the same parameter."""
    axes = {name: tuple(axis.name for axis in pipeline.stages[name].axes) for name in stage.needs}
    if len(set(axes.values())) != 1 or len(next(iter(axes.values()))) != 1:
        told = ", ".join(f"{name} varies {' and '.join(varied) or 'nothing'}" for name, varied in axes.items())
        raise DeclarationError(f"a bifurcation diagram needs stages that vary one and the same parameter; {told}")


def one_stage(stage: Stage, pipeline: Pipeline, fits: Callable[[Stage], bool], what: str) -> None:
    """Refuse anything but one stage that fits, `what` in words."""
    shown = [pipeline.stages[name] for name in stage.needs]
    if len(shown) != 1 or not fits(shown[0]):
        told = ", ".join(f"{one.name} ({one.kind.name} over {len(one.axes)})" for one in shown)
        plot = stage.options.__struct_config__.tag
        raise DeclarationError(f"plot {plot} needs {what}; it is given {told}")


def cells(stage: Stage, pipeline: Pipeline, show: Collection[str]) -> Iterator[tuple[str, Any, list[Stage]]]:
    """Yield for each cell of a figure what a message calls it, the cell, and the stages that it shows."""
    options: Any = stage.options
    if not options.cells:
        raise DeclarationError(f"a {options.__struct_config__.tag} has [[cells]]; declare at least one")
    for number, cell in enumerate(options.cells, 1):
        where = f"cell {number} ({cell.show})"
        if cell.show not in show:
            *others, last = show
            plot = options.__struct_config__.tag
            raise DeclarationError(f"{where}: a {plot} shows {', '.join(others)} or {last}")
        if not cell.of:
            raise DeclarationError(f"{where} shows nothing; name stages, of = [...]")
        for name in cell.of:
            if name not in stage.needs:
                raise DeclarationError(f"{where}: {name!r} is not needed: {nearest(name, stage.needs)}")
        yield where, cell, [pipeline.stages[name] for name in cell.of]
