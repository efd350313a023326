"""A ball in an oscillator whose spring hardens with the cube of its way; docs/dynamics.md, "A Duffing frame"."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from vines.dynamics._room import Layout, Room, Slopes
from vines.dynamics.duffing import _energies as _energies
from vines.dynamics.duffing import _held as _held
from vines.dynamics.duffing import _series as _series
from vines.dynamics.duffing._constants import DuffingField, duffing_constants
from vines.dynamics.duffing._response import largest_response
from vines.dynamics.taylor import SeriesRun, TaylorConstants, TaylorTable
from vines.dynamics.taylor.kernels import TAYLOR_STATE, TAYLOR_TOTALS, set_mass
from vines.model import read_system

__all__ = ["ROOM", "DuffingField", "duffing_constants"]

_ORDER = read_system("duffing").order


class _Duffing(Room):
    trajectory = SeriesRun
    unstruck = "0:0"

    def constants(self, values: Sequence[float]) -> TaylorConstants:
        return duffing_constants(*values, order=_ORDER)

    def table(self, points: list[list[float]]) -> TaylorTable:
        return TaylorTable(self.constants(points[0]))

    def layout(self, p: Any) -> Layout:
        return Layout(state=TAYLOR_STATE, totals=TAYLOR_TOTALS)

    def begin(self, c: Any, state: np.ndarray, x1: float, v1: float, x2: Any, v2: Any, phase: float, t: float) -> None:
        set_mass(c, state, float(x1), float(v1), float(x2), float(v2), phase, t)

    def amplitude(self, p: Any, mass: float) -> float:
        """Return the largest |x1| of the largest stable response of the frame alone, in closed form at alpha = 0."""
        if p.alpha == 0.0:
            return super().amplitude(p, mass)
        return largest_response(p.A, p.Omega, p.lam, p.alpha, mass, _ORDER)[0]

    def swings(self, p: Any) -> list[dict[str, float]]:
        """Return where the largest stable response of the frame alone begins, the ball in the middle."""
        if p.alpha == 0.0:
            return []
        _, x1, v1 = largest_response(p.A, p.Omega, p.lam, p.alpha, 1.0, _ORDER)
        return [{"x1": x1, "v1": v1, "x2": x1}]

    def push(self, p: Any, x1: Any, v1: Any, phase: Any) -> Any:
        return super().push(p, x1, v1, phase) - p.alpha * x1**3

    def slopes(self, p: Any, x1: float, v1: float, phase: float, beside: Any) -> Slopes:
        found = super().slopes(p, x1, v1, phase, beside)
        found.by_state[0] -= 3.0 * p.alpha * x1**2
        return found

    def frame_energy(self, p: Any, at: Mapping[str, float], sag: float) -> float:
        return super().frame_energy(p, at, sag) + 0.25 * p.alpha * at["x1"] ** 4

    def stored(self, p: Any, at: Any) -> tuple[Any, Any, Any]:
        frame, ball, potential = super().stored(p, at)
        return frame, ball, potential + 0.25 * p.alpha * at["x1"] ** 4


ROOM = _Duffing()
