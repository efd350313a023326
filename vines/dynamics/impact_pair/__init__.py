"""The impact pair: a ball of negligible mass in a capsule that moves as it is driven, level or tilted.

``w'' = -B sin(theta) + G`` between impacts; docs/systems.md, "Impact pair".
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from vines.dynamics._impact_law import ImpactLaw, impact_law
from vines.dynamics._room import Room
from vines.dynamics._start import check_gap
from vines.dynamics.impact_pair import _energies as _energies
from vines.dynamics.impact_pair import _motion as _motion
from vines.dynamics.impact_pair._constants import PairConstants, PairTable, pair_constants

__all__ = ["ROOM", "PairConstants"]


def _enter(p: Any, start: dict[str, float], phase: float) -> tuple[float, float, float, float]:
    check_gap(start["w"])
    x1, v1 = p.B * math.sin(phase), p.B * math.cos(phase)
    return x1, v1, x1 - start["w"], v1 - start["w_dot"]


def _leave(p: Any, x1: float, v1: float, x2: float, v2: float, phase: float) -> dict[str, float]:
    return {"w": x1 - x2, "w_dot": v1 - v2}


def _push(p: Any, x1: Any, v1: Any, phase: Any) -> Any:
    return p.G - p.B * np.sin(phase)


def _law(p: Any, balls: Any) -> ImpactLaw:
    return impact_law(0.0, p.r)


def _mass(p: Any) -> float:
    return 1.0


def _base(p: Any, phase: Any) -> Any:
    return p.B * np.sin(phase)


def _stored(p: Any, at: Any) -> tuple[Any, Any, Any]:
    # The driven capsule stores nothing that could come back.
    return 0.0, 0.5 * at["v2"] ** 2, p.G * at["x2"]


ROOM = Room(pair_constants, PairTable, _enter, _leave, _push, _law, lambda p: 2, _mass, _base, _stored)
