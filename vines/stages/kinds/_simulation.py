"""What kinds that run the simulator share: the start state, and what they refuse."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec
from msgspec import Meta

from vines.errors import StateError
from vines.model import Params

__all__ = ["Start", "check_simulation"]


class Start(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Start state (dimensionless): the oscillator at rest and the ball moving, if nothing is said."""

    x1: Annotated[float, Meta(description="Displacement of the oscillator")] = 0.0
    v1: Annotated[float, Meta(description="Its velocity")] = 0.0
    x2: Annotated[float, Meta(description="Displacement of the ball")] = 0.0
    v2: Annotated[float, Meta(description="Its velocity")] = 0.1


def check_simulation(params: dict[str, float], options: Any) -> None:
    """Refuse parameters that the model cannot have, and a start outside the cavity."""
    Params(**params)
    if options.start == "random":
        return
    gap = options.start.x1 - options.start.x2
    if abs(gap) > 1:
        raise StateError(
            f"start has the gap w = x1 - x2 = {gap:g}, allowed is |w| <= 1: the ball would be outside the cavity"
        )
