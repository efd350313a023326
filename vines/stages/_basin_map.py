"""From the tables of a stage of the kind ``basins`` to its picture."""

from __future__ import annotations

import numpy as np

from vines.errors import DeclarationError
from vines.figures import BasinMap
from vines.pipeline import Input

__all__ = ["basin_map"]


def basin_map(stage: Input) -> BasinMap:
    """Return what is drawn of a basins stage.

    Raises
    ------
    DeclarationError
        If the stage is of another kind.
    """
    if "basins" not in stage.tables:
        raise DeclarationError(f"plot basins needs a stage of the kind basins; {stage.name!r} is {stage.kind!r}")
    cells = stage.table("basins")
    column = {name: cells[name].to_numpy(zero_copy_only=False) for name in cells.column_names}
    names = [
        f"{row['name'] or row['regime']}: {100 * row['fraction']:.3g} ± {100 * row['fraction_error']:.1g} %"
        for row in sorted(stage.table("attractors").to_pylist(), key=lambda row: row["attractor"])
        if row["attractor"] >= 0
    ]
    steps = []
    for name in ("x", "y"):
        values = np.unique(column[name][column["level"] == column["level"].min()])
        steps.append(float(np.min(np.diff(values))) if len(values) > 1 else 1.0)
    return BasinMap(
        axes=(str(column["x_name"][0]), str(column["y_name"][0])),
        x=column["x"],
        y=column["y"],
        level=column["level"],
        attractor=column["attractor"],
        mirrored=column["mirrored"].astype(bool),
        names=names,
        steps=(steps[0], steps[1]),
    )
