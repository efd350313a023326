"""From curves of bifurcations to a chart of two parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.figures import CurveLine, Region, SpecialMark, chart_figure
from vines.packages import need
from vines.pipeline import Input
from vines.stages.plots._diagram import family_label, listed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["chart"]


def chart(inputs: Mapping[str, Input], options: Any) -> Figure:
    """Draw the curves of stages of kind ``curve``; one of kind ``reduced`` shades where the exact orbit is stable."""
    curves = [stage for stage in inputs.values() if stage.kind == "curve"]
    # Along x is A where it varies, as in the diagrams.
    first, second = sorted(curves[0].axes, key=lambda axis: axis != "A")
    lines = [line for stage in curves for line in _lines(stage, first, second)]
    special = [mark for stage in curves for mark in _special(stage, first, second)]
    regions = [_stable(stage, first, second) for stage in inputs.values() if stage.kind == "reduced"]
    return chart_figure(
        (first, second),
        lines,
        special,
        regions,
        caption=options.title or listed(curves[0].params),
        width=options.width,
    )


def _lines(stage: Input, first: str, second: str) -> Iterable[CurveLine]:
    need("pandas")
    frame = stage.table().to_pandas()
    for _, points in frame[frame["special"].isna()].groupby("curve_id", sort=False):
        row = points.iloc[0]
        yield CurveLine(row["type"], family_label(row), points[first].to_numpy(), points[second].to_numpy())


def _special(stage: Input, first: str, second: str) -> Iterable[SpecialMark]:
    for row in stage.table().to_pylist():
        if row["special"] is not None:
            yield SpecialMark(row["special"], row[first], row[second])


def _stable(stage: Input, first: str, second: str) -> Region:
    need("pandas")
    frame = stage.table().to_pandas()
    x, y = np.unique(frame[first]), np.unique(frame[second])
    inside = np.zeros((len(y), len(x)), dtype=bool)
    holds = frame["exact_stable"].eq(True) & frame["exact_admissible"].eq(True)
    inside[np.searchsorted(y, frame[second]), np.searchsorted(x, frame[first])] = holds
    return Region(x, y, inside, "1:1 symmetric is stable")
