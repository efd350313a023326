"""The plot ``regimes``: what is reached over two parameters, a measure beside it, and curves of bifurcations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from vines.errors import DeclarationError
from vines.model import most_balls, with_all_balls
from vines.schema import table
from vines.stages.plots._checks import called, one_system
from vines.stages.plots._lines import lines
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "RegimesOptions"]

_COLUMNS = ("regime", "name", "p", "symmetric", "recurrent_sticking")

_COLUMNS_OF = {
    "kinetic_ratio": ("kinetic_ratio",),
    "impact_power": ("impact_power",),
    "harvested_power": ("harvested_left", "harvested_right"),
}
"""The columns of which each measure is the sum."""


class RegimesOptions(PlotOptions, frozen=True, tag="regimes"):
    """One sweep over two parameters, the first along x: a map of what is reached, and one of K2/K1 or of a power.

    Of several balls K2 is the sum. Where the sweep declares a law of harvest the second map is of the power harvested
    at both ends, else of a system whose cavity is driven itself of the power that impacts take. Stages of kind
    `curve` over the same two parameters are laid over both maps.
    """


def _check(stage: Stage, pipeline: Pipeline) -> None:
    needed = [pipeline.stages[name] for name in stage.needs]
    sweeps = [one for one in needed if called(one.kind.tables[:1], "points") and len(one.axes) == 2]
    curves = [one for one in needed if called(one.kind.tables, "curves")]
    if len(sweeps) != 1 or len(sweeps) + len(curves) != len(needed):
        raise DeclarationError(
            "a map of regimes draws one sweep over two parameters, and over it stages of kind 'curve'; "
            f"needs = [{', '.join(stage.needs)}] is not that"
        )
    [sweep] = sweeps
    one_system(needed, "a map of regimes")
    names = {axis.name for axis in sweep.axes}
    others = [one.name for one in curves if {axis.name for axis in one.axes} != names]
    if others:
        raise DeclarationError(f"{', '.join(others)} varies other parameters than {sweep.name}; give the same two")


def _measure(system: str, points: Any) -> str:
    """Return what the second map shows, from the table of the points."""
    columns = _COLUMNS_OF["harvested_power"]
    if set(columns) <= set(points.column_names) and points.num_rows > points[columns[0]].null_count:
        return "harvested_power"
    driven = "x1_no_ball" in with_all_balls(system).without
    return "impact_power" if driven else "kinetic_ratio"


def _draw(inputs: Mapping[str, Input], options: RegimesOptions) -> Figure:
    import numpy as np

    from vines.figures import RegimeMap, regimes_figure
    from vines.stages.plots._caption import fixed
    from vines.stages.plots._grid import grid_of

    (stage,) = (each for each in inputs.values() if called(each.tables, "points"))
    first, second = stage.axes
    system = table(stage.tables[0]).system
    balls = most_balls(system)
    measure = _measure(system, stage.table())
    points = stage.table().select([first, second, *_COLUMNS, *_COLUMNS_OF[measure]])
    grid = grid_of(points, first, second)
    shown = RegimeMap(
        axes=(first, second),
        x=grid.x,
        y=grid.y,
        regime=grid.of(_classes(grid.rows), -1),
        sticks=grid.of(grid.rows["recurrent_sticking"].eq(True).to_numpy(), False),
        name=grid.of(np.array(points["name"].to_pylist(), dtype=object), None),
        ratio=grid.of(grid.rows[[*_COLUMNS_OF[measure]]].sum(axis=1, skipna=False).to_numpy(), math.nan),
        measure="kinetic_ratios" if balls and measure == "kinetic_ratio" else measure,
        caption=fixed(stage, stage.axes),
        curves=tuple(
            line for each in inputs.values() if called(each.tables, "curves") for line in lines(each, first, second)
        ),
    )
    return regimes_figure(shown, title=options.title, width=options.inches)


def _classes(frame: Any) -> Any:
    """Return for each point its place in REGIME_CLASSES."""
    import numpy as np

    from vines.figures import REGIME_CLASSES

    places = {name: k for k, name in enumerate(REGIME_CLASSES)}
    regime = frame["regime"].to_numpy()
    counts = [_counts(name) for name in frame["name"]]
    p = frame["p"].fillna(0).to_numpy(dtype=np.int64)
    unequal = np.array([any(n != m for n, m in balls) for balls in counts], dtype=bool)
    several = np.array([any(n != 1 for n, _ in balls) for balls in counts], dtype=bool)
    symmetric = frame["symmetric"].eq(True).to_numpy()
    kind = np.select(
        [p > 1, unequal, several, symmetric],
        [places["p > 1 periods"], places["n:m, n ≠ m"], places["n:n, n > 1"], places["1:1, symmetric"]],
        places["1:1, asymmetric"],
    )
    others = ("quasiperiodic", "quasi-periodic"), ("chaotic", "chaotic"), ("no_impact", "no impact")
    for told, shown in (*others, ("unsettled", "unsettled")):
        kind[regime == told] = places[shown]
    return kind


def _counts(name: Any) -> list[tuple[int, int]]:
    """Return the impacts of each ball on both ends, from the name of an attractor; none if it has no name.

    Examples
    --------
    >>> _counts("1:1|4:2/2T"), _counts(None)
    ([(1, 1), (4, 2)], [])
    """
    if not isinstance(name, str):
        return []
    pairs = (ball.split(":") for ball in name.partition("/")[0].split("|"))
    return [(int(n), int(m)) for n, m in pairs]


PLOT = Plot(
    summary="what is reached over two parameters, and K2/K1 or a power, with curves of bifurcations over them",
    options=RegimesOptions,
    draw=_draw,
    check=_check,
    tables=("points",),
)
