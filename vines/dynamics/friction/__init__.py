"""One oscillator with a ball that slides with Coulomb friction; docs/dynamics.md, "A ball that slides"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics._advance import S_DECIDE
from vines.dynamics._room import Room
from vines.dynamics.friction import _advance as _advance
from vines.dynamics.friction import _bodies as _bodies
from vines.dynamics.friction._constants import FrictionConstants, FrictionTable, friction_constants

__all__ = ["ROOM", "FrictionConstants"]


class _Friction(Room):
    def constants(self, values: Sequence[float]) -> FrictionConstants:
        return friction_constants(*values)

    def table(self, points: list[list[float]]) -> FrictionTable:
        return FrictionTable(self.constants(points[0]))

    def begin(self, c: Any, state: npt.NDArray[np.float64], x1: float, v1: float, x2: Any, v2: Any,
              phase: float, t: float) -> None:  # fmt: skip
        super().begin(c, state, x1, v1, x2, v2, phase, t)
        if v1 == v2:
            state[S_DECIDE] = 1.0

    def push(self, p: Any, x1: Any, v1: Any, phase: Any) -> Any:
        return super().push(p, x1, v1, phase) + p.G

    def conserves(self, p: Any) -> bool:
        return p.f == 0.0 and super().conserves(p)

    def stored(self, p: Any, at: Any) -> tuple[Any, Any, Any]:
        frame, ball, spring = super().stored(p, at)
        return frame, ball, spring + p.mu * p.G * at["x2"]


ROOM = _Friction()
