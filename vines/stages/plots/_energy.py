"""Sweeps carried along one axis as the panels of a response: all attractors, each drawn once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from vines.figures import FOUND, EnergyCurve, EnergyPanel, VelocityPanel
from vines.model import with_all_balls
from vines.schema import table
from vines.stages.bodies._distinct import Seen, all_attractors
from vines.stages.plots._caption import listed
from vines.stages.plots._checks import called

if TYPE_CHECKING:
    from vines.pipeline import Input

__all__ = ["response_panels"]


def response_panels(
    cells: Sequence[Any], inputs: Mapping[str, Input]
) -> tuple[list[EnergyPanel | VelocityPanel], dict[str, float]]:
    """Return a panel for each cell, and the parameters that all share; others stand where they matter."""
    chosen = [(_stages(cell, inputs), cell) for cell in cells]
    fixed = [_fixed(stages, cell) for stages, cell in chosen]
    shared = {name: fixed[0][name] for name in fixed[0] if all(f.get(name) == fixed[0][name] for f in fixed)}
    panels = []
    for (stages, cell), known in zip(chosen, fixed, strict=True):
        caption = listed({name: value for name, value in known.items() if name not in shared})
        panels.append((_velocities if cell.show == "w_dot" else _energy)(stages, cell, caption))
    return panels, shared


def _stages(cell: Any, inputs: Mapping[str, Input]) -> list[Input]:
    """Return the stages of a cell, those carried upwards first: they tell which attractor is "another" one."""
    return sorted((inputs[name] for name in cell.of), key=lambda stage: stage.direction == "down")


def _rows(stage: Input, cell: Any, like: str) -> pa.Table:
    rows = stage.table(called(stage.tables, like))
    for name, value in cell.where.items():
        rows = rows.filter(pc.field(name) == value)
    return rows


def _fixed(stages: list[Input], cell: Any) -> dict[str, float]:
    """Return the parameters that have one value in all points of a cell."""
    values = {name: set[float]() for name in _parameters(stages[0])}
    for stage in stages:
        rows = _rows(stage, cell, "points")
        for name, found in values.items():
            found.update(rows[name].unique().to_pylist())
    return {name: found.pop() for name, found in values.items() if len(found) == 1}


def _parameters(stage: Input) -> list[str]:
    """Return the parameters of a stage's system, of as many balls as it has: of others the columns are empty."""
    own, rows = table(stage.tables[0]).system, stage.table()
    names = [each.name for each in with_all_balls(own).parameters]
    return [name for name in names if rows[name].null_count < rows.num_rows or not rows.num_rows]


def _energy(stages: list[Input], cell: Any, caption: str) -> EnergyPanel:
    axis = stages[0].carried
    points = [_rows(stage, cell, "points") for stage in stages]
    others = [_rows(stage, cell, "attractors") for stage in stages if called(stage.tables, "attractors")]
    fixed = _fixed(stages, cell)
    differing = [name for name in _parameters(stages[0]) if name != axis and name not in fixed]
    groups = _groups(points[0], differing)
    curves = [
        _curve(
            axis,
            [_of(rows, group) for rows in points],
            [_of(rows, group) for rows in others],
            listed(group),
            cell.colours[k % len(cell.colours)],
        )
        for k, group in enumerate(groups)
    ]
    bodies = with_all_balls(table(called(stages[0].tables, "points")).system).bodies
    return EnergyPanel(
        axis,
        curves,
        caption,
        ratio=cell.show == "energy",
        window=cell.window,
        y=cell.y,
        # Of several balls the first tells what they are.
        body=bodies[1].name.partition("_")[0],
    )


def _groups(points: pa.Table, names: list[str]) -> list[dict[str, float]]:
    """Return the combinations of parameters that tell curves apart, ascending."""
    if not names:
        return [{}]
    rows = points.group_by(names).aggregate([]).to_pylist()
    return sorted(rows, key=lambda row: tuple(row[name] for name in names))


def _of(rows: pa.Table, group: dict[str, float]) -> pa.Table:
    for name, value in group.items():
        rows = rows.filter(pc.field(name) == value)
    return rows


def _curve(axis: str, points: list[pa.Table], others: list[pa.Table], label: str, colour: str) -> EnergyCurve:
    seen: list[Seen] = all_attractors(axis, points, others)
    yardsticks = points[0].sort_by(axis)
    free = dict(zip(yardsticks[axis].to_pylist(), yardsticks["x1_no_ball"].to_pylist(), strict=True))
    x, size = np.array([one.x for one in seen]), np.array([one.max_abs_x1 for one in seen])
    return EnergyCurve(
        x=x,
        kinetic_ratio=np.array([one.kinetic_ratio for one in seen]),
        max_abs_x1=size,
        reduction=size / np.array([free[value] for value in x.tolist()]),
        found=np.array([one.found for one in seen]),
        at=yardsticks[axis].to_numpy(),
        no_ball=yardsticks["x1_no_ball"].to_numpy(),
        locked=yardsticks["x1_locked"].to_numpy(),
        label=label,
        colour=colour,
    )


def _velocities(stages: list[Input], cell: Any, caption: str) -> VelocityPanel:
    axis = stages[0].carried
    tables = [_rows(stage, cell, "impacts") for stage in stages]
    numbered = "ball" in tables[0].column_names
    columns = [axis, "w_dot", "side", "attractor", *(["ball"] if numbered else [])]
    together = pa.concat_tables([rows.select(columns) for rows in tables])
    balls = together["ball"].to_numpy() if numbered else np.zeros(0, dtype=np.int64)
    later = np.repeat(np.arange(len(tables)) > 0, [rows.num_rows for rows in tables])
    found = np.where(together["attractor"].to_numpy() > 0, FOUND.index("random"), later.astype(np.int64))
    return VelocityPanel(
        axis=axis,
        x=together[axis].to_numpy(),
        w_dot=together["w_dot"].to_numpy(),
        side=together["side"].to_numpy(),
        found=found,
        caption=caption,
        window=cell.window,
        ball=balls if balls.any() else None,
    )
