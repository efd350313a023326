"""What kinds that run the simulator share: the start state, and what they refuse."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from vines.bounds import check_periods
from vines.errors import StateError
from vines.model import VI_NES, Params

__all__ = [
    "Bare",
    "InLog",
    "Keep",
    "LargestP",
    "PerPeriod",
    "Random",
    "Record",
    "Seed",
    "Settle",
    "Start",
    "Watch",
    "check_length",
    "check_simulation",
]

Settle = Annotated[int, Meta(ge=0, description="Forcing periods that are left out")]
Record = Annotated[int, Meta(ge=2, description="Forcing periods that are classified and measured")]
Watch = Annotated[
    int, Meta(ge=16, description="Where nothing repeats: forcing periods more before a Lyapunov exponent is believed")
]
# Unset is absent from the key, so that studies from before there was this option keep theirs.
LargestP = (
    Annotated[
        int,
        Meta(
            ge=1,
            le=4096,
            description="Largest number of forcing periods over which a repetition is looked for, as if 32 if left "
            "out; at least twice as many are recorded",
        ),
    ]
    | msgspec.UnsetType
)
Keep = Annotated[
    int,
    Meta(
        ge=0,
        description="Recorded periods whose impacts are kept, of a periodic attractor one repetition; 0 keeps none",
    ),
]
Random = Annotated[int, Meta(ge=0, description="Further starts that are drawn at each point")]
Seed = Annotated[int, Meta(ge=0, description="Seed of these draws")]
InLog = Annotated[int, Meta(ge=2, description="Forcing periods in the log")]
PerPeriod = Annotated[int, Meta(ge=2, description="Samples of the state in a forcing period")]
Bare = Annotated[
    bool, Meta(description="Whether the log also carries what a viewer without vines understands (docs/logs.md)")
]

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
    """Refuse options that make runs of years, and random starts that take years together."""
    for name in ("settle", "record", "watch", "patience"):
        check_periods(name, values.get(name, 0))
    if starts := values.get("random", 0):
        check_periods("(settle + record) (1 + random)", (values["settle"] + values["record"]) * (1 + starts))
