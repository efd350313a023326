"""What kinds that run the simulator share: the start state, and what they refuse."""

from __future__ import annotations

from typing import Any

import msgspec

from vines.errors import StateError
from vines.model import VI_NES, Params
from vines.stages.kinds._checks import check_least

__all__ = ["Start", "check_simulation"]


_State = msgspec.defstruct("_State", [(each.name, float, each.start) for each in VI_NES.state])


class Start(_State, frozen=True, forbid_unknown_fields=True):
    """Start state (dimensionless): the oscillator at rest and the ball moving, if nothing is said."""


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
