"""The plot ``response``: energy measures and impact velocities of all attractors of sweeps."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Literal

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError
from vines.model import with_one_ball
from vines.stages.plots._checks import called, cells, has_runs, one_system
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "ResponseCell", "ResponseOptions"]

_SHOWN = ("energy", "max_abs_x1", "w_dot")
_SIZES = {"max_abs_x1", "x1_no_ball"}
"""What a panel of energies compares."""

_Show = Annotated[str, Meta(description="What is shown", extra_json_schema={"enum": list(_SHOWN)})]


class ResponseCell(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A panel: `energy` (K2/K1 and max|x1|), `max_abs_x1` alone, or `w_dot`, of sweeps that are carried along one axis.

    What differs beside the carried axis tells curves apart; they get `colours` in ascending order.
    """

    show: _Show
    of: Annotated[tuple[str, ...], Meta(description="The sweeps that it shows")]
    where: Annotated[dict[str, float], Meta(description="Parameters that the shown points have")] = {}
    colours: Annotated[
        tuple[Literal["red", "green", "blue", "black", "orange"], ...], Meta(description="Colours of the curves")
    ] = ("red", "green", "blue")
    window: Annotated[tuple[float, float] | None, Meta(description="The part of the horizontal axis shown")] = None
    y: Annotated[tuple[float, float] | None, Meta(description="The part of the vertical axis shown")] = None


class ResponseOptions(PlotOptions, frozen=True, tag="response"):
    """Sweeps with all attractors that coexist, and a strip with the reduction of max|x1| below each panel of energies.

    Parameters that all cells share stand above everything, others where they matter.
    """

    cells: Annotated[tuple[ResponseCell, ...], Meta(description="The panels, row by row")] = ()
    columns: Annotated[int, Meta(ge=1, description="Panels in a row")] = 1


def _check(stage: Stage, pipeline: Pipeline) -> None:
    for where, cell, shown in cells(stage, pipeline, _SHOWN):
        carried = {one.carry.axis if one.carry is not None else "" for one in shown}
        listed = all(called(one.kind.tables, "impacts") and not has_runs(one) for one in shown)
        if not listed or len(carried) != 1 or carried == {""}:
            raise DeclarationError(f"{where} shows stages of kind 'sweep' that are carried along one axis")
        system = one_system(shown, where)
        driven = sorted(_SIZES & set(with_one_ball(system).without))
        if cell.show != "w_dot" and driven:
            raise DeclarationError(f"{where}: the system {system!r} has no {', '.join(driven)}; it can show w_dot")
        for name, value in cell.where.items():
            for one in shown:
                there = {axis.name: axis.values() for axis in one.axes}.get(name) or (one.params.get(name, math.nan),)
                if value not in there:
                    near = min(there, key=lambda each: abs(each - value))
                    known = f"the nearest of its {len(there)} values is {near:.10g}"
                    raise DeclarationError(f"{where}: {one.name} has no {name} = {value:g}; {known}")


def _draw(inputs: Mapping[str, Input], options: ResponseOptions) -> Figure:
    from vines.figures import response_figure
    from vines.stages.plots._caption import listed
    from vines.stages.plots._energy import response_panels

    panels, shared = response_panels(options.cells, inputs)
    return response_figure(
        panels, columns=options.columns, caption=options.title or listed(shared), width=options.inches
    )


PLOT = Plot(
    summary="energy measures and impact velocities of all attractors of sweeps",
    options=ResponseOptions,
    draw=_draw,
    check=_check,
    tables=("points", "impacts"),
)
