"""The impact pair: a ball of negligible mass in a capsule that moves as it is driven, level or tilted.

``w'' = -B sin(theta) + G`` between impacts; docs/dynamics.md, "Impact pair".
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from vines.dynamics._impact_law import ImpactLaw, impact_law
from vines.dynamics._room import Layout, Room
from vines.dynamics._scatter import Scatter
from vines.dynamics._start import check_gap
from vines.dynamics.impact_pair import _energies as _energies
from vines.dynamics.impact_pair import _motion as _motion
from vines.dynamics.impact_pair._constants import PairConstants, PairTable, pair_constants
from vines.dynamics.impact_pair._scatter import PairScatterTable
from vines.errors import ParameterError

__all__ = ["ROOM", "PairConstants"]


class _Pair(Room):
    """The capsule is x1 = B sin(theta); users see the gap w and w', not the laboratory."""

    def constants(self, values: Sequence[float]) -> PairConstants:
        return pair_constants(*values)

    def table(self, points: list[list[float]]) -> PairTable:
        return PairTable(np.array(points))

    def scattered(
        self, values: Any, scatter: Scatter, streams: Any, begun: Any = None
    ) -> tuple[PairScatterTable, np.ndarray]:
        if wrong := [name for name in scatter.parts if name not in ("sigma_r", "spread")]:
            raise ParameterError(
                f"scatter of the impact pair has {', '.join(wrong)}; it can have sigma_r and spread: its capsule moves "
                "as it is driven"
            )
        return PairScatterTable(values, scatter.sigma_r, scatter.seed, streams), np.empty(0)

    def layout(self, p: Any) -> Layout:
        return Layout(directions=2)

    def enter(self, p: Any, start: Mapping[str, Any], phase: float) -> tuple[Any, Any, Any, Any]:
        check_gap(start["w"])
        x1, v1 = p.B * math.sin(phase), p.B * math.cos(phase)
        return x1, v1, x1 - start["w"], v1 - start["w_dot"]

    def leave(self, p: Any, at: Sequence[float], phase: float, more: Sequence[float] = ()) -> dict[str, float]:
        x1, v1, x2, v2 = at
        return {"w": x1 - x2, "w_dot": v1 - v2}

    def gaps(self, p: Any, at: Mapping[str, Any]) -> Any:
        return np.stack([at["w"]], axis=-1)

    def draw(self, p: Any, rng: np.random.Generator) -> dict[str, float]:
        # Motions in the long run rarely meet an end at three times the speed of the capsule, and a fall through all of
        # it adds 2 sqrt(G).
        size = max(3.0 * p.B + 2.0 * math.sqrt(abs(p.G)), 0.1)
        return {"w": float(rng.uniform(-1.0, 1.0)), "w_dot": float(rng.uniform(-size, size))}

    def amplitude(self, p: Any, mass: float) -> float:
        raise ParameterError("p is of ImpactPair, whose capsule moves as it is driven: no oscillator answers")

    def push(self, p: Any, x1: Any, v1: Any, phase: Any) -> Any:
        return p.G - p.B * np.sin(phase)

    def law(self, p: Any, balls: Any) -> ImpactLaw:
        return impact_law(0.0, p.r)

    def mass(self, p: Any) -> float:
        return 1.0

    def base(self, p: Any, phase: Any) -> Any:
        return p.B * np.sin(phase)

    def stored(self, p: Any, at: Any) -> tuple[Any, Any, Any]:
        # The driven capsule stores nothing that could come back.
        return 0.0, 0.5 * at["v2"] ** 2, p.G * at["x2"]


ROOM = _Pair()
