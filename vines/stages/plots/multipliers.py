"""The plot ``multipliers``: moduli of the Floquet multipliers along branches."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated

from msgspec import Meta

from vines.errors import DeclarationError, nearest
from vines.stages.plots._checks import called, check_window, one_axis, one_system
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures import MultiplierLines
    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "MultipliersOptions", "multiplier_lines"]


class MultipliersOptions(PlotOptions, frozen=True, tag="multipliers"):
    """Stages of kind `branch` over one parameter: a panel for each branch, side by side."""

    panels: Annotated[
        tuple[str, ...], Meta(description="Labels of the branches shown, such as '1:1 symmetric'; all if empty")
    ] = ()
    window: Annotated[tuple[float, float] | None, Meta(description="The part of the parameter that is shown")] = None


def _check(stage: Stage, pipeline: Pipeline) -> None:
    check_window(stage.options)
    one_axis(stage, pipeline)
    one_system((pipeline.stages[name] for name in stage.needs), "a figure of multipliers")
    if not any(called(pipeline.stages[name].kind.tables, "branches") for name in stage.needs):
        raise DeclarationError("multipliers are those of branches; name a stage of kind 'branch' in needs")


def _draw(inputs: Mapping[str, Input], options: MultipliersOptions) -> Figure:
    from vines.figures import multiplier_figure
    from vines.stages.plots._caption import listed

    stages = [stage for stage in inputs.values() if called(stage.tables, "branches")]
    return multiplier_figure(
        stages[0].axes[0],
        multiplier_lines(stages, options.panels),
        caption=options.title or listed(stages[0].params),
        width=options.inches,
        window=options.window,
    )


def multiplier_lines(stages: Iterable[Input], labels: Sequence[str]) -> list[MultiplierLines]:
    """Return the branches of these labels, or all; the first where several have the same.

    Raises
    ------
    DeclarationError
        If there is no branch of a label.
    """
    found = [branch for stage in stages for branch in _branches(stage)]
    known = list(dict.fromkeys(branch.label for branch in found))
    for label in labels:
        if label not in known:
            raise DeclarationError(f"no branch {label!r} to show multipliers of: {nearest(label, known)}")
    return [next(b for b in found if b.label == label) for label in labels] or found


def _branches(stage: Input) -> list[MultiplierLines]:
    import numpy as np
    import pyarrow.compute as pc

    from vines.figures import MultiplierLines
    from vines.stages.plots._diagram import family_label, family_of

    axis = stage.axes[0]
    orbits, branches, bifurcations = (
        stage.table(called(stage.tables, like)) for like in ("orbits", "branches", "bifurcations")
    )
    lines = []
    for branch in branches.to_pylist():
        mine = orbits.filter(pc.field("branch_id") == branch["branch_id"])
        met = bifurcations.filter(pc.field("branch_id") == branch["branch_id"])
        real, imaginary = (np.array(mine[f"multipliers_{part}"].to_pylist()) for part in ("re", "im"))
        lines.append(
            MultiplierLines(
                x=mine[axis].to_numpy(),
                moduli=-np.sort(-np.hypot(real, imaginary), axis=1),
                marks=tuple(zip(met["type"].to_pylist(), met["value"].to_pylist(), strict=True)),
                label=family_label(branch),
                family=family_of(branch),
            )
        )
    return lines


PLOT = Plot(
    summary="moduli of the multipliers along branches",
    options=MultipliersOptions,
    draw=_draw,
    check=_check,
    tables=("branches", "orbits", "bifurcations"),
)
