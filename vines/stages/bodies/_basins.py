"""Body of the kind ``basins``: to which attractor each start of a grid comes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa

from vines.attractors import basins
from vines.model import Params
from vines.pipeline import Batch, WholeJob
from vines.stages.bodies._rows import outline

if TYPE_CHECKING:
    from vines.stages.kinds.basins import BasinsOptions

__all__ = ["compute"]


def compute(job: WholeJob[BasinsOptions]) -> Batch:
    """Find the basins and describe the attractors."""
    options = job.options
    p = Params(**job.params)
    axes = [(axis.name, np.linspace(axis.start, axis.stop, axis.count)) for axis in (options.x, options.y)]
    found = basins(
        p,
        *axes,
        others=dict(options.start),
        refine=options.refine,
        settle=options.settle,
        patience=options.patience,
        watch=options.watch,
    )
    n = len(found.x)
    cells = {name: np.full(n, value) for name, value in p.as_dict().items()}
    cells |= {"x_name": np.full(n, found.axes[0], dtype=object), "y_name": np.full(n, found.axes[1], dtype=object)}
    cells |= {"x": found.x, "y": found.y, "level": found.level, "weight": found.weight}
    cells |= {"attractor": found.label, "mirrored": found.mirrored, "periods": found.periods}
    rows = []
    for k, attractor in enumerate([*found.attractors, None]):
        share, error = found.fraction(k if attractor is not None else -1)
        row = {**p.as_dict(), "attractor": k, "fraction": share, "fraction_error": error, "regime": "unsettled"}
        if attractor is None:
            rows.append(row | {"attractor": -1})
            continue
        stay = found.lifetimes[k]
        lifetime = {
            "lifetime": stay.periods if stay.periods == stay.periods else None,
            "lifetime_error": stay.error if stay.error == stay.error else None,
        }
        rows.append(row | lifetime | outline(attractor))
    return Batch(tables={"attractors": rows, "basins": pa.table(cells)})
