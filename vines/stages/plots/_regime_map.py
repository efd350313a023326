"""From the table ``points`` of a sweep over two parameters to the map of what is reached."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.errors import DeclarationError
from vines.figures import REGIME_CLASSES, SYMBOLS, RegimeMap
from vines.packages import need

if TYPE_CHECKING:
    from vines.pipeline import Input

__all__ = ["regime_map"]

_PLACES = {name: k for k, name in enumerate(REGIME_CLASSES)}


def regime_map(stage: Input) -> RegimeMap:
    """Return the grid of a sweep over two parameters, the first of them along x.

    Raises
    ------
    DeclarationError
        If the stage is no sweep or does not vary two parameters.
    """
    if stage.kind != "sweep" or len(stage.axes) != 2:
        raise DeclarationError(
            f"stage {stage.name!r} is of kind {stage.kind!r} and varies {len(stage.axes)} parameters; "
            "plot regimes needs a stage of kind 'sweep' that varies two"
        )
    first, second = stage.axes
    wanted = [first, second, "regime", "name", "n", "m", "p", "symmetric", "recurrent_sticking", "kinetic_ratio"]
    table = stage.table().select(wanted)
    need("pandas")
    frame = table.to_pandas()
    x, y = np.unique(frame[first]), np.unique(frame[second])
    where = np.searchsorted(y, frame[second]), np.searchsorted(x, frame[first])

    def grid(values: Any, empty: Any) -> Any:
        out = np.full((len(y), len(x)), empty)
        out[where] = values
        return out

    return RegimeMap(
        axes=(first, second),
        x=x,
        y=y,
        regime=grid(_classes(frame), -1),
        sticks=grid(frame["recurrent_sticking"].eq(True).to_numpy(), False),
        name=grid(np.array(table["name"].to_pylist(), dtype=object), None),
        ratio=grid(frame["kinetic_ratio"].to_numpy(), math.nan),
        caption=", ".join(
            f"${SYMBOLS.get(name, name)} = {value:.4g}$"
            for name, value in stage.params.items()
            if name not in stage.axes
        ),
    )


def _classes(frame: Any) -> np.ndarray:
    """Return for each point its place in REGIME_CLASSES."""
    regime = frame["regime"].to_numpy()
    n, m, p = (frame[name].fillna(0).to_numpy(dtype=np.int64) for name in ("n", "m", "p"))
    symmetric = frame["symmetric"].eq(True).to_numpy()
    kind = np.select(
        [p > 1, n != m, n > 1, symmetric],
        [_PLACES["p > 1 periods"], _PLACES["n:m, n ≠ m"], _PLACES["n:n, n > 1"], _PLACES["1:1, symmetric"]],
        _PLACES["1:1, asymmetric"],
    )
    others = ("quasiperiodic", "quasi-periodic"), ("chaotic", "chaotic"), ("no_impact", "no impact")
    for told, shown in (*others, ("unsettled", "unsettled")):
        kind[regime == told] = _PLACES[shown]
    return kind
