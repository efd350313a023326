"""From the table ``reduced`` to the error maps of its figure."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from vines.errors import DeclarationError
from vines.figures import ERRORS, ErrorMap
from vines.packages import need

if TYPE_CHECKING:
    from vines.pipeline import Input

__all__ = ["error_map"]

SYMBOLS = {"mu": r"\mu", "A": "A", "Omega": r"\Omega", "r": "r", "lam": r"\lambda"}


def error_map(stage: Input) -> ErrorMap:
    """Return the grid of errors of a stage of kind ``reduced``, the first of its two axes along x.

    Raises
    ------
    DeclarationError
        If it is of another kind or does not vary two parameters.
    """
    if stage.kind != "reduced" or len(stage.axes) != 2:
        raise DeclarationError(
            f"stage {stage.name!r} is of kind {stage.kind!r} and varies {len(stage.axes)} parameters; "
            "an error map needs stages of kind 'reduced' that vary two"
        )
    # Along y is A where it varies: the range of the forcing is what one reads off.
    first, second = sorted(stage.axes, key=lambda axis: axis == "A")
    need("pandas")
    frame = stage.table().to_pandas()
    x, y = np.unique(frame[first]), np.unique(frame[second])
    where = np.searchsorted(y, frame[second]), np.searchsorted(x, frame[first])

    def grid(values: object, empty: float = math.nan) -> np.ndarray:
        out = np.full((len(y), len(x)), empty)
        out[where] = np.asarray(values, dtype=np.float64)
        return out

    valid = frame["exact_stable"].eq(True) & frame["exact_admissible"].eq(True)
    A = frame["A"]
    return ErrorMap(
        axes=(first, second),
        x=x,
        y=y,
        errors={name: grid(frame[f"error_{name}"]) for name in ERRORS},
        valid=grid(valid, 0.0) > 0,
        inside=grid(np.minimum(A - frame["stable_from"], frame["stable_to"] - A)),
        caption=", ".join(
            f"${SYMBOLS[name]} = {value:.4g}$" for name, value in stage.params.items() if name not in stage.axes
        ),
    )
