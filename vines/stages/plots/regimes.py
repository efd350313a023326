"""The plot ``regimes``: what is reached over two parameters, and K2/K1 beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from vines.model import most_balls, read_system
from vines.schema import table
from vines.stages.plots._checks import called, one_stage
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "RegimesOptions"]

_COLUMNS = ("regime", "name", "p", "symmetric", "recurrent_sticking")


class RegimesOptions(PlotOptions, frozen=True, tag="regimes"):
    """One sweep over two parameters, the first along x: a map of what is reached, and one of K2/K1.

    Of several balls K2 is the sum. Of a system whose cavity is driven itself the second map is of the power that
    impacts take.
    """


def _check(stage: Stage, pipeline: Pipeline) -> None:
    def fits(one: Stage) -> bool:
        return called(one.kind.tables[:1], "points") != "" and len(one.axes) == 2

    one_stage(stage, pipeline, fits, "one sweep over two parameters")


def _draw(inputs: Mapping[str, Input], options: RegimesOptions) -> Figure:
    import numpy as np

    from vines.figures import RegimeMap, regimes_figure
    from vines.stages.plots._caption import fixed
    from vines.stages.plots._grid import grid_of

    (stage,) = inputs.values()
    first, second = stage.axes
    system = table(stage.tables[0]).system
    balls = most_balls(system)
    measure = "impact_power" if "x1_no_ball" in read_system(system, balls).without else "kinetic_ratio"
    points = stage.table().select([first, second, *_COLUMNS, measure])
    grid = grid_of(points, first, second)
    shown = RegimeMap(
        axes=(first, second),
        x=grid.x,
        y=grid.y,
        regime=grid.of(_classes(grid.rows), -1),
        sticks=grid.of(grid.rows["recurrent_sticking"].eq(True).to_numpy(), False),
        name=grid.of(np.array(points["name"].to_pylist(), dtype=object), None),
        ratio=grid.of(grid.rows[measure].to_numpy(), math.nan),
        measure="kinetic_ratios" if balls and measure == "kinetic_ratio" else measure,
        caption=fixed(stage, stage.axes),
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
    summary="what is reached over two parameters, and K2/K1",
    options=RegimesOptions,
    draw=_draw,
    check=_check,
    tables=("points",),
)
