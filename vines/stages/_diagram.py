"""Bifurcation diagrams: from the tables of stages to what the figure draws."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from vines.figures import SYMBOLS, BranchLine, ImpactDots, Marker, bifurcation_figure
from vines.model import Word
from vines.pipeline import Input

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["bifurcation_diagram"]


def bifurcation_diagram(inputs: Mapping[str, Input], options: Any) -> Figure:
    """Draw stages with impacts as dots, those with orbits as lines.

    Parameters that all stages share stand in the caption; those that differ in the labels, so that no curve is shown
    under another's parameters.
    """
    stages = list(inputs.values())
    axis = stages[0].axes[0]
    shared = {
        name: value
        for name, value in stages[0].params.items()
        if all(stage.params.get(name) == value for stage in stages)
    }
    branches = [stage for stage in stages if "orbits" in stage.tables]
    return bifurcation_figure(
        axis,
        [_dots(stage, axis, shared) for stage in stages if "impacts" in stage.tables],
        [line for stage in branches for line in _lines(stage, axis, shared)],
        [marker for stage in branches for marker in _markers(stage, axis)],
        panels=options.panels or ("w_dot", "dt"),
        caption=options.title or _listed(shared),
        width=options.width,
    )


def _dots(stage: Input, axis: str, shared: dict[str, float]) -> ImpactDots:
    impacts = stage.table("impacts")
    column = _numpy(impacts)
    return ImpactDots(
        x=column(axis),
        side=column("side"),
        values={
            "w_dot": column("w_dot"),
            "dt": column("dt_next") * column("Omega") / (2 * math.pi),
            "x1": column("x1"),
            "phase": column("phase"),
        },
        label=_label("simulation", stage, shared),
    )


def _lines(stage: Input, axis: str, shared: dict[str, float]) -> Iterable[BranchLine]:
    """Yield a line for each impact of the orbits of each branch."""
    orbits = stage.table("orbits")
    for branch in stage.table("branches").to_pylist():
        mine = orbits.filter(pc.field("branch_id") == branch["branch_id"])
        x = _numpy(mine)(axis)
        stable = mine["stable"].to_numpy(zero_copy_only=False).astype(bool)
        values, sides = _per_impact(mine)
        for k, side in enumerate(sides):
            label = f"{branch['name']} {'symmetric' if branch['symmetric'] else 'asymmetric'}"
            yield BranchLine(
                x=x,
                side=int(side),
                stable=stable,
                values={q: v[:, k] for q, v in values.items()},
                label=_label(label, stage, shared),
            )


def _markers(stage: Input, axis: str) -> Iterable[Marker]:
    for row in stage.table("bifurcations").to_pylist():
        period = 2 * math.pi / row["Omega"]
        t = np.array(row["t"])
        yield Marker(
            type=row["type"],
            x=row[axis],
            values={
                "w_dot": np.array(row["w_dot"]),
                "dt": np.diff(t, append=t[0] + Word(row["word"]).p * period) / period,
                "phase": np.array(row["phase"]),
                "x1": np.array(row["x1"]),
            },
        )


def _per_impact(orbits: pa.Table) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Return the quantities of each impact as (orbits, impacts) arrays, and the side of each impact."""
    period = 2 * math.pi / _numpy(orbits)("Omega")
    t = _matrix(orbits, "t")
    span = orbits["p"].to_numpy() * period
    dt = np.diff(t, axis=1, append=(t[:, 0] + span)[:, None]) / period[:, None]
    values = {name: _matrix(orbits, name) for name in ("w_dot", "x1", "phase")} | {"dt": dt}
    return values, _matrix(orbits, "side")[0]


def _matrix(orbits: pa.Table, name: str) -> np.ndarray:
    return np.array(orbits[name].to_pylist())


def _numpy(table: pa.Table) -> Any:
    return lambda name: table[name].to_numpy()


def _label(what: str, stage: Input, shared: dict[str, float]) -> str:
    own = {name: value for name, value in stage.params.items() if name not in shared}
    return f"{what}, {_listed(own)}" if own else what


def _listed(params: dict[str, float]) -> str:
    return ",  ".join(f"${SYMBOLS[name]} = {value:.4g}$" for name, value in params.items())
