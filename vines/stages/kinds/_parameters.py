"""Parameters that kinds of stages take, with their defaults."""

from __future__ import annotations

from vines.model import VI_NES

__all__ = ["PARAMETERS", "TABLE_1"]

PARAMETERS: dict[str, float | None] = {each.name: each.default for each in VI_NES.parameters}
"""Those of the model; None where a declaration must give the value."""

TABLE_1: dict[str, float | None] = {each.name: each.default for each in VI_NES.rig}
"""The rig of the paper in SI units (Table 1)."""
