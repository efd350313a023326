"""The plot ``regimes``: what is reached over two parameters, and K2/K1 beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from vines.stages.plots._checks import one_stage
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "RegimesOptions"]

_COLUMNS = ("regime", "name", "n", "m", "p", "symmetric", "recurrent_sticking", "kinetic_ratio")


class RegimesOptions(PlotOptions, frozen=True, tag="regimes"):
    """One sweep over two parameters, the first along x: a map of what is reached, and one of K2/K1."""


def _check(stage: Stage, pipeline: Pipeline) -> None:
    def fits(one: Stage) -> bool:
        return one.kind.tables[:1] == ("points",) and len(one.axes) == 2

    one_stage(stage, pipeline, fits, "one sweep over two parameters")


def _draw(inputs: Mapping[str, Input], options: RegimesOptions) -> Figure:
    import numpy as np

    from vines.figures import RegimeMap, regimes_figure
    from vines.stages.plots._caption import fixed
    from vines.stages.plots._grid import grid_of

    (stage,) = inputs.values()
    first, second = stage.axes
    table = stage.table().select([first, second, *_COLUMNS])
    grid = grid_of(table, first, second)
    shown = RegimeMap(
        axes=(first, second),
        x=grid.x,
        y=grid.y,
        regime=grid.of(_classes(grid.rows), -1),
        sticks=grid.of(grid.rows["recurrent_sticking"].eq(True).to_numpy(), False),
        name=grid.of(np.array(table["name"].to_pylist(), dtype=object), None),
        ratio=grid.of(grid.rows["kinetic_ratio"].to_numpy(), math.nan),
        caption=fixed(stage, stage.axes),
    )
    return regimes_figure(shown, title=options.title, width=options.width)


def _classes(frame: Any) -> Any:
    """Return for each point its place in REGIME_CLASSES."""
    import numpy as np

    from vines.figures import REGIME_CLASSES

    places = {name: k for k, name in enumerate(REGIME_CLASSES)}
    regime = frame["regime"].to_numpy()
    n, m, p = (frame[name].fillna(0).to_numpy(dtype=np.int64) for name in ("n", "m", "p"))
    symmetric = frame["symmetric"].eq(True).to_numpy()
    kind = np.select(
        [p > 1, n != m, n > 1, symmetric],
        [places["p > 1 periods"], places["n:m, n ≠ m"], places["n:n, n > 1"], places["1:1, symmetric"]],
        places["1:1, asymmetric"],
    )
    others = ("quasiperiodic", "quasi-periodic"), ("chaotic", "chaotic"), ("no_impact", "no impact")
    for told, shown in (*others, ("unsettled", "unsettled")):
        kind[regime == told] = places[shown]
    return kind


PLOT = Plot(
    summary="what is reached over two parameters, and K2/K1",
    options=RegimesOptions,
    draw=_draw,
    check=_check,
)
