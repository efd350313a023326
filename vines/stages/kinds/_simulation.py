"""What kinds that run the simulator share: the start state, and what they refuse."""

from __future__ import annotations

from typing import Any

import msgspec

from vines.errors import StateError
from vines.model import Params
from vines.stages.kinds._checks import check_least

__all__ = ["Start", "check_simulation"]


class Start(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Start state (dimensionless): the oscillator at rest and the ball moving, if nothing is said."""

    x1: float = 0.0
    v1: float = 0.0
    x2: float = 0.0
    v2: float = 0.1


def check_simulation(params: dict[str, float], options: Any) -> None:
    """Refuse parameters that the model cannot have, numbers that are too small, and a start outside the cavity."""
    Params(**params)
    limits = {"settle": 0, "record": 2, "watch": 16, "per_period": 2, "keep": 0, "random": 0, "seed": 0}
    values = msgspec.structs.asdict(options)
    check_least(values, {name: least for name, least in limits.items() if name in values})
    if options.start == "random":
        return
    gap = options.start.x1 - options.start.x2
    if abs(gap) > 1:
        raise StateError(
            f"start has the gap w = x1 - x2 = {gap:g}, allowed is |w| <= 1: the ball would be outside the cavity"
        )
