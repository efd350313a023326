"""What kinds that run the simulator share: the start state, and what they refuse."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from vines.errors import ParameterError, StateError
from vines.model import VI_NES, Params

__all__ = ["Start", "check_length", "check_simulation"]

MOST_PERIODS = 10_000_000
"""Forcing periods of one point that nobody computes by mistake: it takes a minute, and a sweep has hundreds."""
ALLOWED_BY = "VINES_LONG_POINTS"
"""Variable of the environment that allows more; no option, since it changes no result and belongs to no key."""


_State = msgspec.defstruct(
    "_State", [(each.name, Annotated[float, Meta(description=each.text)], each.start) for each in VI_NES.state]
)


class Start(_State, frozen=True, forbid_unknown_fields=True):
    """Start state (dimensionless): the oscillator at rest and the ball moving, if nothing is said."""


def check_simulation(params: dict[str, float], options: Any) -> None:
    """Refuse parameters that the model cannot have, and a start outside the cavity."""
    Params(**params)
    check_length(msgspec.structs.asdict(options))
    if options.start == "random":
        return
    gap = options.start.x1 - options.start.x2
    if abs(gap) > 1:
        raise StateError(
            f"start has the gap w = x1 - x2 = {gap:g}, allowed is |w| <= 1: the ball would be outside the cavity"
        )


def check_length(values: Mapping[str, Any]) -> None:
    """Refuse options that name more periods than a point should have."""
    for name in ("settle", "record", "watch"):
        if values.get(name, 0) > MOST_PERIODS and not os.environ.get(ALLOWED_BY):
            raise ParameterError(
                f"{name} is {values[name]}, allowed is {name} <= {MOST_PERIODS} periods a point; "
                f"{ALLOWED_BY}=1 in the environment allows more"
            )
