"""Body of the kind ``basins``: to which attractor each start of a grid comes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from vines.attractors import Attractor, Basins, basins
from vines.model import Params
from vines.pipeline import Batch, WholeJob
from vines.stages.bodies._rows import outline

if TYPE_CHECKING:
    from vines.stages.kinds.basins import BasinsOptions, FamilyBasinsOptions

__all__ = ["attractors_of", "cells_of", "compute", "found_of"]


def compute(job: WholeJob[BasinsOptions]) -> Batch:
    """Find the basins and describe the attractors."""
    found = found_of(Params(**job.params), job.options, job.options.start)
    return Batch(tables={"attractors": attractors_of(found, outline), "basins": pa.table(cells_of(found))})


def found_of(p: Any, options: BasinsOptions | FamilyBasinsOptions, others: Mapping[str, float]) -> Basins:
    """Return the basins that a stage asks for, the coordinates that are not on its grid given."""
    x, y = ((axis.name, np.linspace(axis.start, axis.stop, axis.count)) for axis in (options.x, options.y))
    return basins(
        p,
        x,
        y,
        others=dict(others),
        refine=options.refine,
        settle=options.settle,
        patience=options.patience,
        watch=options.watch,
    )


def cells_of(found: Basins) -> dict[str, Any]:
    """Return the columns of the table ``basins``."""
    n = len(found.x)
    cells = {name: np.full(n, value) for name, value in found.params.as_dict().items()}
    cells |= {"x_name": np.full(n, found.axes[0], dtype=object), "y_name": np.full(n, found.axes[1], dtype=object)}
    cells |= {"x": found.x, "y": found.y, "level": found.level, "weight": found.weight}
    return cells | {"attractor": found.label, "mirrored": found.mirrored, "periods": found.periods}


def attractors_of(found: Basins, told: Callable[[Attractor], dict[str, Any]]) -> list[dict[str, Any]]:
    """Return rows of ``attractors`` with what is told of each; the last is for starts that did not settle."""
    rows = []
    for k, attractor in enumerate([*found.attractors, None]):
        share, error = found.fraction(k if attractor is not None else -1)
        row = {**found.params.as_dict(), "attractor": k, "fraction": share, "fraction_error": error}
        if attractor is None:
            rows.append(row | {"attractor": -1, "regime": "unsettled"})
            continue
        stay = found.lifetimes[k]
        lifetime = {
            "lifetime": stay.periods if stay.periods == stay.periods else None,
            "lifetime_error": stay.error if stay.error == stay.error else None,
        }
        rows.append(row | lifetime | told(attractor))
    return rows
