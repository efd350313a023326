"""The kind ``figure``: a picture of other stages, by one of the plots."""

from __future__ import annotations

from typing import Any

from vines.errors import DeclarationError
from vines.pipeline import Kind, Pipeline, Stage
from vines.stages.plots import PLOTS, PlotOptions, check_look, inches, plot_of

__all__ = ["KIND"]


def _fits(stage: Stage, pipeline: Pipeline) -> None:
    if not stage.needs:
        raise DeclarationError("a figure draws other stages; name them, needs = [...]")
    plot = plot_of(stage.options)
    options: Any = stage.options
    inches(options.width)
    check_look(options.worn)
    plot.check_systems(stage, pipeline)
    check = plot.check
    if check is not None:
        check(stage, pipeline)


def _code(options: Any) -> tuple[str, ...]:
    """Name what draws: of all plots only the one that is asked for counts in the key."""
    draw = plot_of(options).draw
    return (f"{draw.__module__}:{draw.__qualname__}",)


KIND = Kind(
    name="figure",
    summary="a picture of other stages, PNG, SVG and PDF",
    shape="whole",
    options=PlotOptions,
    body="vines.stages.plots._figure:compute",
    needs=True,
    pictures=True,
    fits=_fits,
    variants=PLOTS,
    code=_code,
)
