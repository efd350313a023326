"""A ball in a cavity and a mass on a cubic spring beside it; docs/dynamics.md, "A ball beside a spring"."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics._room import Layout, Room, Slopes
from vines.dynamics._start import check_gap
from vines.dynamics.hybrid import _energies as _energies
from vines.dynamics.hybrid import _tangent as _tangent
from vines.dynamics.hybrid._advance import set_hybrid
from vines.dynamics.hybrid._constants import HybridConstants, HybridTable, hybrid_constants
from vines.dynamics.hybrid._energies import HYBRID_TOTALS
from vines.dynamics.hybrid._layout import HYBRID_ROW, HYBRID_STATE
from vines.dynamics.hybrid._run import HybridMeasures, HybridRun, hybrid_measures
from vines.dynamics.taylor import spring_energy
from vines.model import read_system

__all__ = ["ROOM", "HybridConstants", "HybridMeasures", "HybridRun", "hybrid_constants"]

_ORDER = read_system("hybrid").order


class _Hybrid(Room):
    """x2 and v2 are arrays: those of the ball, then those of the mass on the spring."""

    trajectory = HybridRun
    measures = staticmethod(hybrid_measures)
    unstruck = "0:0"
    beside = ("x3", "v3")

    def constants(self, values: Sequence[float]) -> HybridConstants:
        return hybrid_constants(*values, order=_ORDER)

    def table(self, points: list[list[float]]) -> HybridTable:
        return HybridTable(self.constants(points[0]))

    def layout(self, p: Any) -> Layout:
        return Layout(state=HYBRID_STATE, width=HYBRID_ROW, totals=HYBRID_TOTALS, directions=6)

    def enter(self, p: Any, start: Mapping[str, Any], phase: float) -> tuple[Any, Any, Any, Any]:
        check_gap(start["x1"] - start["x2"])
        x, v = (np.array([start[f"{name}2"], start[f"{name}3"]]) for name in "xv")
        return start["x1"], start["v1"], x, v

    def leave(self, p: Any, at: Sequence[float], phase: float, more: Sequence[float] = ()) -> dict[str, float]:
        return {**super().leave(p, at, phase), "x3": more[-2], "v3": more[-1]}

    def begin(self, c: Any, state: npt.NDArray[np.float64], x1: float, v1: float, x2: Any, v2: Any,
              phase: float, t: float) -> None:  # fmt: skip
        at = (float(x1), float(v1), float(x2[0]), float(v2[0]), float(x2[1]), float(v2[1]))
        set_hybrid(c, state, *at, phase, t)

    def draw(self, p: Any, rng: np.random.Generator) -> dict[str, float]:
        # As of the VI-NES; the mass is as far from the oscillator as that may be from its place, and as fast.
        start = super().draw(p, rng)
        size = self.size(p)
        u, v3 = rng.uniform(-size, size, 2).tolist()
        return {**start, "x3": start["x1"] - u, "v3": v3}

    def pushed(self, p: Any, x1: Any, v1: Any, phase: Any, beside: Any) -> Any:
        u, rate = x1 - beside[0], v1 - beside[1]
        return self.push(p, x1, v1, phase) - p.mu_n * (p.k1 * u + p.k3 * u**3 + p.l2 * rate)

    def slopes(self, p: Any, x1: float, v1: float, phase: float, beside: npt.NDArray[np.float64]) -> Slopes:
        frame = super().slopes(p, x1, v1, phase, beside)
        u, rate = x1 - float(beside[0]), v1 - float(beside[1])
        of_spring = np.array([p.k1 + 3.0 * p.k3 * u**2, p.l2])
        by_state = np.append(frame.by_state - p.mu_n * of_spring, p.mu_n * of_spring)
        rates = np.array([float(beside[1]), p.k1 * u + p.k3 * u**3 + p.l2 * rate])
        return Slopes(frame.by_time, by_state, rates, np.zeros(2))

    def alongside(self, p: Any) -> tuple[float, ...]:
        return 1.0, 0.0

    def mass(self, p: Any) -> float:
        return p.mu + p.mu_n

    def stored(self, p: Any, at: Any) -> tuple[Any, Any, Any]:
        frame, ball, potential = super().stored(p, at)
        return frame, ball, potential + self.spring(p, at)

    def spring(self, p: Any, at: Any) -> Any:
        return spring_energy(p, p.mu_n, at["x1"] - at["x3"])

    def conserves(self, p: Any) -> bool:
        return super().conserves(p) and (p.l2 == 0.0 or p.mu_n == 0.0)


ROOM = _Hybrid()
