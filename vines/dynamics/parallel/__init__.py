"""One oscillator with balls in parallel cavities, level or tilted; docs/dynamics.md, "Several balls"."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics._impact_law import ImpactLaw, impact_law
from vines.dynamics._room import Layout, Room
from vines.dynamics._start import check_gap
from vines.dynamics._totals import TOTALS
from vines.dynamics.parallel import _energies as _energies
from vines.dynamics.parallel import _frame as _frame
from vines.dynamics.parallel import _tangent as _tangent
from vines.dynamics.parallel._advance import set_balls
from vines.dynamics.parallel._constants import ParallelConstants, ParallelTable, parallel_constants
from vines.dynamics.parallel._layout import S_IN_TURN, row_width, state_size
from vines.dynamics.parallel._run import BallMeasures, ParallelMeasures, ParallelRun, parallel_measures
from vines.dynamics.parallel._strike import PASSES

__all__ = ["ROOM", "BallMeasures", "ParallelConstants", "ParallelMeasures", "ParallelRun"]


class _Parallel(Room):
    """Balls are numbered from 1 on; x2 and v2 are arrays."""

    trajectory = ParallelRun
    measures = staticmethod(parallel_measures)

    def constants(self, values: Sequence[float]) -> ParallelConstants:
        return parallel_constants(*values)

    def table(self, points: list[list[float]]) -> ParallelTable:
        return ParallelTable(self.constants(points[0]))

    def layout(self, p: Any) -> Layout:
        n = p.balls
        totals = TOTALS + 1 + _energies.EACH * n
        return Layout(state_size(n), row_width(n), totals, 2 + 2 * n, 256 + 2 * (PASSES + 1) * n)

    def enter(self, p: Any, start: Mapping[str, Any], phase: float) -> tuple[Any, Any, Any, Any]:
        x2 = np.array([start[f"x2_{k}"] for k in range(1, p.balls + 1)])
        v2 = np.array([start[f"v2_{k}"] for k in range(1, p.balls + 1)])
        for beta, x in zip(p.beta, x2, strict=True):
            check_gap((start["x1"] - x) / beta)
        return start["x1"], start["v1"], x2, v2

    def leave(self, p: Any, at: Sequence[float], phase: float, more: Sequence[float] = ()) -> dict[str, float]:
        each = more[3:]
        balls = {f"{name}_{k + 1}": each[2 * k + j] for k in range(p.balls) for j, name in enumerate(("x2", "v2"))}
        return {"x1": at[0], "v1": at[1], **balls}

    def begin(self, c: Any, state: npt.NDArray[np.float64], x1: float, v1: float, x2: Any, v2: Any,
              phase: float, t: float) -> None:  # fmt: skip
        set_balls(c, state, float(x1), float(v1), x2, v2, phase, t)

    def strike_in_turn(self, state: npt.NDArray[np.float64]) -> None:
        state[S_IN_TURN] = 1.0

    def gaps(self, p: Any, at: Mapping[str, Any]) -> Any:
        return np.stack([(at["x1"] - at[f"x2_{k}"]) / p.beta[k - 1] for k in range(1, p.balls + 1)], axis=-1)

    def draw(self, p: Any, rng: np.random.Generator) -> dict[str, float]:
        # As of the VI-NES, the longest cavity being the unit.
        unit = max(p.beta)
        size = unit * float(np.clip(2.0 * self.amplitude(p, 1.0) / unit, 0.1, 3.0))
        x1, v1, *v2 = rng.uniform(-size, size, 2 + p.balls).tolist()
        found = {"x1": x1, "v1": v1}
        for k, (beta, speed) in enumerate(zip(p.beta, v2, strict=True), start=1):
            found |= {f"x2_{k}": x1 - beta * float(rng.uniform(-1.0, 1.0)), f"v2_{k}": speed}
        return found

    def law(self, p: Any, balls: Any) -> ImpactLaw:
        at = np.asarray(balls) - 1
        return impact_law(np.array(p.mu)[at], np.array(p.r)[at])

    def mass(self, p: Any) -> float:
        return sum(p.mu)


ROOM = _Parallel()
