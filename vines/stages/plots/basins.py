"""The plot ``basins``: to which attractor each start comes, as a map of the starts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from vines.schema import table
from vines.stages.plots._checks import called, one_stage
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures import BasinMap
    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "BasinsOptions"]


class BasinsOptions(PlotOptions, frozen=True, tag="basins"):
    """One stage with basins: a hue for each attractor, darker where its mirror image is reached."""


def _check(stage: Stage, pipeline: Pipeline) -> None:
    one_stage(stage, pipeline, lambda one: bool(called(one.kind.tables, "basins")), "one stage of kind basins")


def _draw(inputs: Mapping[str, Input], options: BasinsOptions) -> Figure:
    from vines.figures import basins_figure

    (stage,) = inputs.values()
    return basins_figure(_map(stage), title=options.title, width=options.inches)


def _map(stage: Input) -> BasinMap:
    """Return what is drawn of a stage with basins."""
    import numpy as np

    from vines.figures import BasinMap

    cells = stage.table(called(stage.tables, "basins"))
    column = {name: cells[name].to_numpy(zero_copy_only=False) for name in cells.column_names}
    told = {row["attractor"]: row for row in stage.table(called(stage.tables, "attractors")).to_pylist()}
    order = sorted(told, key=lambda k: (k < 0, k))
    shown = [k for k in order if k >= 0 or told[k]["fraction"] > 0]
    steps = []
    for name in ("x", "y"):
        values = np.unique(column[name][column["level"] == column["level"].min()])
        steps.append(float(np.min(np.diff(values))) if len(values) > 1 else 1.0)
    return BasinMap(
        axes=(_symbol(stage, column["x_name"][0]), _symbol(stage, column["y_name"][0])),
        coordinates=(column["x_name"][0], column["y_name"][0]),
        x=column["x"],
        y=column["y"],
        level=column["level"],
        attractor=column["attractor"],
        mirrored=column["mirrored"].astype(bool),
        names=[_name(told[k]) for k in shown],
        regimes=[told[k]["regime"] for k in shown if k >= 0],
        steps=(steps[0], steps[1]),
    )


def _symbol(stage: Input, name: str) -> str:
    """Return a coordinate as an axis shows it."""
    from vines.figures import start_symbol

    return start_symbol(str(name), table(stage.tables[0]).system)


def _name(row: dict[str, Any]) -> str:
    """Return what is written of an attractor: what it is, its share, and how long it lasts if not for good."""
    what = row["name"] or row["regime"] if row["attractor"] >= 0 else "not settled"
    share, error = 100 * row["fraction"], 100 * row["fraction_error"]
    digits = max(0, -math.floor(math.log10(error)))
    text = f"{what}: {share:.{digits}f} ± {error:.{digits}f} % of the starts"
    if row.get("lifetime") is None:
        return text
    return f"{text}, left after {_rounded(row['lifetime']):,.0f} periods on average"


def _rounded(value: float) -> float:
    """Return a number to two digits."""
    return float(f"{value:.2g}")


PLOT = Plot(
    summary="to which attractor each start comes, a map of the starts",
    options=BasinsOptions,
    draw=_draw,
    check=_check,
    tables=("basins",),
)
