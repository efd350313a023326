"""The kind ``transient``: how a velocity of the oscillator decays without forcing."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from vines.errors import ParameterError
from vines.model import Params
from vines.pipeline import Kind
from vines.stages.kinds._family import FamilyTransientOptions, of_systems
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "TransientOptions"]


class TransientOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One run from v1 = V without forcing: shares of the energy that are lost and left, and times until little is left.

    The ball starts as `x2` and `v2` say, at rest in the middle if nothing is said.
    """

    periods: Annotated[int, Meta(ge=1, le=1_000_000, description="Periods 2 pi to run")] = 100
    x2: Annotated[float, Meta(ge=-1, le=1, description="Position of the ball at the start")] = 0.0
    v2: Annotated[float, Meta(description="Velocity of the ball at the start")] = 0.0


def _check(params: dict[str, float], options: TransientOptions) -> None:
    del options
    Params(**{name: value for name, value in params.items() if name != "V"}, A=0.0)
    if params["V"] == 0:
        raise ParameterError("V is 0, allowed is V != 0: it is the velocity that decays")


_VI_NES = Kind(
    name="transient",
    summary="how a velocity of the oscillator decays without forcing: shares lost and left, times to 10 % and 1 %",
    shape="points",
    options=TransientOptions,
    body="vines.stages.bodies._transient:compute",
    tables=("transients",),
    parameters={**{name: value for name, value in PARAMETERS.items() if name not in ("A", "Omega")}, "V": None},
    vary="grid",
    check=_check,
    kernels=("one_run", "runs"),
    again="points",
    meaningless={"impact_pair": "its capsule moves as it is driven, so nothing decays"},
)

KIND = of_systems(
    _VI_NES,
    ("cubic_barriers", "drag", "duffing", "friction", "hybrid", "modes", "parallel"),
    FamilyTransientOptions,
    "vines.stages.bodies._family_transient:compute",
    ("transients",),
)
