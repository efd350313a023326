"""Body of the kind ``figure``: tables of other stages into a picture."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from vines.errors import DeclarationError
from vines.figures import BranchLine, ImpactDots, Marker, bifurcation_figure, reduced_figure, save
from vines.pipeline import Batch, Input, WholeJob
from vines.stages._error_map import error_map

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["compute"]


def compute(job: WholeJob) -> Batch:
    """Draw the needed stages."""
    options: Any = job.options
    if options.plot == "reduced":
        maps = [error_map(stage) for stage in job.inputs.values()]
        figure = reduced_figure(maps, panels=options.panels, title=options.title, width=options.width)
    else:
        figure = _bifurcation(job, options)
    save(figure, job.folder)
    return Batch()


def _bifurcation(job: WholeJob, options: Any) -> Figure:
    """Draw stages with impacts as dots, those with orbits as lines."""
    axes = dict.fromkeys(axis for stage in job.inputs.values() for axis in stage.axes)
    if len(axes) != 1:
        raise DeclarationError(
            f"a bifurcation figure needs stages that vary one and the same parameter; here: {', '.join(axes) or 'none'}"
        )
    (axis,) = axes
    dots = [_dots(stage, axis) for stage in job.inputs.values() if "impacts" in stage.tables]
    branches = [stage for stage in job.inputs.values() if "orbits" in stage.tables]
    return bifurcation_figure(
        axis,
        dots,
        [line for stage in branches for line in _lines(stage, axis)],
        [marker for stage in branches for marker in _markers(stage, axis)],
        panels=options.panels or ("w_dot", "dt"),
        caption=options.title or _caption(job.inputs.values(), axis),
        width=options.width,
    )


def _dots(stage: Input, axis: str) -> ImpactDots:
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
    )


def _lines(stage: Input, axis: str) -> Iterable[BranchLine]:
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
                label=label,
            )


def _markers(stage: Input, axis: str) -> Iterable[Marker]:
    for row in stage.table("bifurcations").to_pylist():
        if row["type"] == "pair_turns_real":  # a change of the multipliers, but no bifurcation
            continue
        period = 2 * math.pi / row["Omega"]
        periods = _periods(row["name"])
        t = np.array(row["t"])
        yield Marker(
            type=row["type"],
            x=row[axis],
            values={
                "w_dot": np.array(row["w_dot"]),
                "dt": np.diff(t, append=t[0] + periods * period) / period,
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


def _periods(name: str) -> int:
    return int(name.split("/")[1][:-1]) if "/" in name else 1


def _caption(stages: Iterable[Input], axis: str) -> str:
    fixed = next(iter(stages)).params
    symbols = {"mu": r"\mu", "A": "A", "Omega": r"\Omega", "r": "r", "lam": r"\lambda"}
    return ",  ".join(f"${symbols[name]} = {fixed[name]:.4g}$" for name in symbols if name != axis and name in fixed)
