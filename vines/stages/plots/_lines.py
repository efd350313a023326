"""Curves of bifurcations as lines in the plane of two parameters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vines.figures import CurveLine
    from vines.pipeline import Input

__all__ = ["lines"]


def lines(stage: Input, first: str, second: str) -> Iterator[CurveLine]:
    """Return the curves of a stage, the first parameter along x."""
    from vines.figures import CurveLine
    from vines.packages import need
    from vines.stages.plots._diagram import family_label

    need("pandas")
    frame = stage.table().to_pandas()
    for _, points in frame[frame["special"].isna()].groupby("curve_id", sort=False):
        row = points.iloc[0]
        yield CurveLine(row["type"], family_label(row), points[first].to_numpy(), points[second].to_numpy())
