"""Parameters that kinds of stages take, with their defaults."""

from __future__ import annotations

import dataclasses

from vines.model import LAM_TABLE_1, PhysicalParams

__all__ = ["PARAMETERS", "TABLE_1"]

PARAMETERS: dict[str, float | None] = {"mu": None, "A": None, "Omega": 1.0, "r": 0.65, "lam": LAM_TABLE_1}
"""Those of the model; None where a declaration must give the value."""

TABLE_1: dict[str, float | None] = dataclasses.asdict(PhysicalParams())
"""The rig of the paper in SI units (Table 1)."""
