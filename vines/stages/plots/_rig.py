"""Rows of reconstructed and compared runs as plots of a rig need them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.figures import RigCycle

if TYPE_CHECKING:
    from vines.pipeline import Input

__all__ = ["Row", "column", "cycles_of", "reconstructed", "tables_of"]

Row = dict[str, Any]


def tables_of(inputs: Mapping[str, Input], table: str) -> list[Input]:
    """Return the stages that have a table."""
    return [stage for stage in inputs.values() if table in stage.tables]


def reconstructed(inputs: Mapping[str, Input]) -> list[Row]:
    """Return the rows of all runs that could be reconstructed."""
    rows = [row for stage in tables_of(inputs, "reconstructions") for row in stage.table().to_pylist()]
    return [row for row in rows if row["status"] == "ok"]


def column(rows: list[Row], name: str) -> np.ndarray:
    """Return a column of rows, nan where there is nothing."""
    return np.array([math.nan if row.get(name) is None else row[name] for row in rows], dtype=float)


def cycles_of(inputs: Mapping[str, Input]) -> list[RigCycle]:
    """Return the nearest branch beside each run at measured parameters, in the order of the runs' names."""
    found: list[RigCycle] = []
    for stage in tables_of(inputs, "rig_cycles"):
        told = {row["point_id"]: row for row in stage.table("comparisons").to_pylist()}
        for row in stage.table("rig_cycles").to_pylist():
            if row["rank"] or row["basis"] != "measured":
                continue
            about = told[row["point_id"]]
            columns = {name: np.array(row[name]) for name in ("w", "w_dot", "model_w", "model_w_dot")}
            found.append(
                RigCycle(
                    title=f"{row['run_id']}: {row['branch']}, {about['verdict'].replace('_', ' ')}",
                    edges=np.array(row["wait_edges"]),
                    share=np.array(row["wait_share"]),
                    model_share=np.array(row["model_wait_share"]),
                    rms=(about["rms_w"] or math.nan, about["rms_w_dot"] or math.nan),
                    **columns,
                )
            )
    return sorted(found, key=lambda cycle: cycle.title)
