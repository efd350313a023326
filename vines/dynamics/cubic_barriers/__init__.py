"""A mass on a cubic spring in the oscillator, between barriers or without; docs/dynamics.md, "Taylor series"."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from vines.dynamics._room import Layout, Room
from vines.dynamics._start import check_gap
from vines.dynamics.taylor import (
    TaylorConstants,
    TaylorMeasures,
    TaylorRun,
    TaylorTable,
    spring_energy,
    taylor_constants,
    taylor_measures,
)
from vines.dynamics.taylor.kernels import TAYLOR_STATE, TAYLOR_TOTALS, set_mass
from vines.model import read_system

__all__ = ["ROOM", "TaylorMeasures", "TaylorRun"]


_ORDER = read_system("cubic_barriers").order


class _CubicBarriers(Room):
    trajectory = TaylorRun
    measures = staticmethod(taylor_measures)
    unstruck = "0:0"

    def constants(self, values: Sequence[float]) -> TaylorConstants:
        return taylor_constants(*values, order=_ORDER)

    def table(self, points: list[list[float]]) -> TaylorTable:
        return TaylorTable(self.constants(points[0]))

    def layout(self, p: Any) -> Layout:
        return Layout(state=TAYLOR_STATE, totals=TAYLOR_TOTALS)

    def enter(self, p: Any, start: Mapping[str, Any], phase: float) -> tuple[Any, Any, Any, Any]:
        if p.walls:
            check_gap(start["x1"] - start["x2"])
        return start["x1"], start["v1"], start["x2"], start["v2"]

    def begin(self, c: Any, state: np.ndarray, x1: float, v1: float, x2: Any, v2: Any, phase: float, t: float) -> None:
        set_mass(c, state, float(x1), float(v1), float(x2), float(v2), phase, t)

    def let_go(self, p: Any, side: int) -> float:
        return side * (1 + p.mu) * (p.k1 + p.k3)

    def stored(self, p: Any, at: Any) -> tuple[Any, Any, Any]:
        frame, mass, potential = super().stored(p, at)
        return frame, mass, potential + self.spring(p, at)

    def spring(self, p: Any, at: Any) -> Any:
        return spring_energy(p, p.mu, at["w"])


ROOM = _CubicBarriers()
