"""What a declaration must fulfil beyond its form, seen before anything is computed.

The form (keys, types, names, ranges of parameters) is checked where declarations are read; here is what concerns a
stage together with those it needs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from vines.errors import DeclarationError, nearest
from vines.pipeline import Pipeline, Stage, file_of

__all__ = ["check_name", "check_stages"]


def check_name(path: Path, root: Path) -> None:
    """Refuse a file that would take the name, and so the results, of a pipeline that the project has.

    Raises
    ------
    DeclarationError
        If the file is not that pipeline's own.
    """
    known = file_of(path.stem, root)
    if known is not None and known.resolve() != path.resolve():
        raise DeclarationError(f"{path}: the pipeline {path.stem!r} is declared in {known} already; rename this file")


def check_stages(pipeline: Pipeline) -> None:
    """Check each stage together with those that it needs.

    Raises
    ------
    DeclarationError
        One line with the file, the stage, what is wrong and the remedy.
    """
    for stage in pipeline.stages.values():
        check = _SENSE.get(stage.kind.name)
        if check is not None:
            check(stage, pipeline)


def _refuse(stage: Stage, pipeline: Pipeline, text: str) -> DeclarationError:
    return DeclarationError(f"{pipeline.path}: stages.{stage.name}: {text}")


def _branch(stage: Stage, pipeline: Pipeline) -> None:
    if len(stage.axes) != 1:
        names = ", ".join(axis.name for axis in stage.axes) or "nothing"
        raise _refuse(
            stage, pipeline, f"a branch is followed in one parameter, this one varies {names}; give one vary.X"
        )


def _curve(stage: Stage, pipeline: Pipeline) -> None:
    if len(stage.axes) != 2:
        names = ", ".join(axis.name for axis in stage.axes) or "nothing"
        raise _refuse(
            stage, pipeline, f"a curve is followed in two parameters, this one varies {names}; give vary.X and vary.Y"
        )


def _figure(stage: Stage, pipeline: Pipeline) -> None:
    if not stage.needs:
        raise _refuse(stage, pipeline, "a figure draws other stages; name them, needs = [...]")
    options: Any = stage.options
    if options.width <= 0:
        raise _refuse(stage, pipeline, f"width is {options.width:g} inch, allowed is width > 0")
    window = options.window
    if window is not None and not window[0] < window[1]:
        raise _refuse(stage, pipeline, f"window is {window[0]:g} to {window[1]:g}; give the lower end first")
    if options.panels and options.plot in ("bifurcation", "reduced"):
        from vines.figures import ERRORS, PANELS

        known = PANELS if options.plot == "bifurcation" else ERRORS
        for panel in options.panels:
            if panel not in known:
                raise _refuse(stage, pipeline, f"unknown panel {panel!r}: {nearest(panel, known)}")
    if options.plot.startswith("rig_"):
        _rig_figure(stage, pipeline)
    if options.plot == "chart":
        _chart(stage, pipeline)
    if options.plot == "regimes":
        shown = [pipeline.stages[name] for name in stage.needs]
        if len(shown) != 1 or shown[0].kind.name != "sweep" or len(shown[0].axes) != 2:
            listed = ", ".join(f"{one.name} ({one.kind.name} over {len(one.axes)})" for one in shown)
            raise _refuse(stage, pipeline, f"plot regimes needs one sweep over two parameters; it is given {listed}")
    if options.plot == "sheet":
        _sheet(stage, pipeline)
    elif options.plot == "response":
        _response(stage, pipeline)
    elif options.cells:
        raise _refuse(stage, pipeline, f"cells belong to plot = 'sheet' or 'response', this one is {options.plot!r}")
    if options.plot not in ("bifurcation", "multipliers"):
        return
    axes = {name: tuple(axis.name for axis in pipeline.stages[name].axes) for name in stage.needs}
    if len(set(axes.values())) != 1 or len(next(iter(axes.values()))) != 1:
        listed = ", ".join(f"{name} varies {' and '.join(varied) or 'nothing'}" for name, varied in axes.items())
        raise _refuse(
            stage, pipeline, f"a bifurcation diagram needs stages that vary one and the same parameter; {listed}"
        )
    if options.plot == "multipliers" and not any(pipeline.stages[name].kind.name == "branch" for name in stage.needs):
        raise _refuse(stage, pipeline, "multipliers are those of branches; name a stage of kind 'branch' in needs")


def _rig_figure(stage: Stage, pipeline: Pipeline) -> None:
    from vines.figures import RIG_PANELS

    options: Any = stage.options
    kind = "compare" if options.plot in ("rig_cycles", "rig_waits") else "reconstruct"
    if all(pipeline.stages[name].kind.name != kind for name in stage.needs):
        raise _refuse(stage, pipeline, f"plot {options.plot} needs a stage of kind {kind}; name one in needs")
    for panel in options.panels:
        if options.plot != "rig_branches" or panel not in RIG_PANELS:
            raise _refuse(stage, pipeline, f"unknown panel {panel!r}: {nearest(panel, RIG_PANELS)}")
    if options.plot == "rig_branches":
        for name in stage.needs:
            axes = [axis.name for axis in pipeline.stages[name].axes]
            if axes not in ([], ["A"]):
                raise _refuse(stage, pipeline, f"rig points lie over A; {name} varies {' and '.join(axes)}")


def _cells(stage: Stage, pipeline: Pipeline) -> Iterator[tuple[str, Any, list[Stage]]]:
    """Yield for each cell of a figure what a message calls it, the cell, and the stages that it shows."""
    options: Any = stage.options
    if not options.cells or options.columns < 1 or options.height <= 0:
        raise _refuse(stage, pipeline, f"a {options.plot} has [[cells]], columns >= 1 and height > 0 inch")
    for number, cell in enumerate(options.cells, 1):
        where = f"cell {number} ({cell.show})"
        if not cell.of:
            raise _refuse(stage, pipeline, f"{where} shows nothing; name stages, of = [...]")
        for name in cell.of:
            if name not in stage.needs:
                raise _refuse(stage, pipeline, f"{where}: {name!r} is not needed: {nearest(name, stage.needs)}")
        yield where, cell, [pipeline.stages[name] for name in cell.of]


def _response(stage: Stage, pipeline: Pipeline) -> None:
    for where, cell, shown in _cells(stage, pipeline):
        if cell.show not in ("energy", "max_abs_x1", "w_dot"):
            raise _refuse(stage, pipeline, f"{where}: a response shows energy, max_abs_x1 or w_dot")
        carried = {one.carry.axis if one.carry is not None else "" for one in shown}
        if {one.kind.name for one in shown} != {"sweep"} or len(carried) != 1 or carried == {""}:
            raise _refuse(stage, pipeline, f"{where} shows stages of kind 'sweep' that are carried along one axis")
        for name, value in cell.where.items():
            for one in shown:
                there = {axis.name: axis.values() for axis in one.axes}.get(name) or (one.params.get(name, math.nan),)
                if value not in there:
                    near = min(there, key=lambda each: abs(each - value))
                    known = f"the nearest of its {len(there)} values is {near:.10g}"
                    raise _refuse(stage, pipeline, f"{where}: {one.name} has no {name} = {value:g}; {known}")


def _sheet(stage: Stage, pipeline: Pipeline) -> None:
    from vines.figures import RUN_PANELS

    for where, cell, shown in _cells(stage, pipeline):
        if cell.show in ("energy", "max_abs_x1"):
            raise _refuse(stage, pipeline, f"{where}: energies are shown by plot = 'response'")
        kinds = {one.kind.name for one in shown}
        if cell.show in RUN_PANELS:
            if kinds != {"trajectory"} or (cell.show != "phase_plane" and len(shown) > 1):
                raise _refuse(stage, pipeline, f"{where} shows one stage of kind 'trajectory', a phase plane also more")
            continue
        if not kinds <= {"sweep", "branch"} or len({tuple(axis.name for axis in one.axes) for one in shown}) != 1:
            raise _refuse(stage, pipeline, f"{where} shows sweeps and branches that vary one and the same parameter")
        if cell.show == "multipliers" and (kinds != {"branch"} or len(cell.families) != 1):
            raise _refuse(stage, pipeline, f"{where} shows one family of stages of kind 'branch'; name it in families")


def _chart(stage: Stage, pipeline: Pipeline) -> None:
    needed = [pipeline.stages[name] for name in stage.needs]
    wrong = [one.name for one in needed if one.kind.name not in ("curve", "reduced")]
    if wrong or not any(one.kind.name == "curve" for one in needed):
        told = f"; {', '.join(wrong)} is of another" if wrong else ""
        raise _refuse(stage, pipeline, f"a chart draws stages of kind 'curve', and shades one of kind 'reduced'{told}")
    if len({frozenset(axis.name for axis in one.axes) for one in needed}) != 1:
        raise _refuse(stage, pipeline, "the stages of a chart have to vary the same two parameters")


def _check(stage: Stage, pipeline: Pipeline) -> None:
    from vines.stages.bodies._claims import read_claims

    if not stage.needs:
        raise _refuse(stage, pipeline, "a check compares with other stages; name them, needs = [...]")
    options: Any = stage.options
    files = stage.kind.files(stage.options, pipeline.root) if stage.kind.files is not None else ()
    known = {name for file in files for name in read_claims(file)}
    for name in options.claims:
        if name not in known:
            raise _refuse(stage, pipeline, f"unknown claim {name!r}: {nearest(name, known)}")


def _reconstruct(stage: Stage, pipeline: Pipeline) -> None:
    for need in stage.needs:
        if pipeline.stages[need].kind.name != "ingest":
            raise _refuse(
                stage,
                pipeline,
                f"it reconstructs what stages of kind ingest keep; {need} is none, remove it from needs",
            )
    if not stage.needs:
        raise _refuse(stage, pipeline, "it reconstructs what was ingested; name a stage of kind ingest in needs")


def _compare(stage: Stage, pipeline: Pipeline) -> None:
    kinds = [pipeline.stages[need].kind for need in stage.needs]
    for need, kind in zip(stage.needs, kinds, strict=True):
        if kind.name != "reconstruct" and "orbits" not in kind.tables:
            raise _refuse(
                stage, pipeline, f"it compares reconstructed runs with orbits; {need} has neither, remove it from needs"
            )
    if all(kind.name != "reconstruct" for kind in kinds):
        raise _refuse(stage, pipeline, "it compares what was reconstructed; name a stage of kind reconstruct in needs")


_SENSE: dict[str, Callable[[Stage, Pipeline], None]] = {
    "branch": _branch,
    "check": _check,
    "compare": _compare,
    "curve": _curve,
    "figure": _figure,
    "reconstruct": _reconstruct,
}
"""What each kind of stage must fulfil."""
