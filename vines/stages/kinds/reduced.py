"""The kind ``reduced``: the multiple-scales reduction beside the exact orbit."""

from __future__ import annotations

import msgspec

from vines.model import Params
from vines.pipeline import Kind
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "ReducedOptions"]


class ReducedOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The multiple-scales approximation of the symmetric 1:1 response beside the exact orbit; nothing to choose."""


def _check(params: dict[str, float], options: ReducedOptions) -> None:
    del options
    Params(**params)


KIND = Kind(
    name="reduced",
    summary="the multiple-scales approximation of the symmetric 1:1 response beside the exact orbit",
    shape="points",
    options=ReducedOptions,
    body="vines.stages.bodies._reduced:compute",
    tables=("reduced",),
    parameters=PARAMETERS,
    vary="grid",
    check=_check,
    kernels=("orbits",),
    again="points",
    meaningless={
        "impact_pair": "its level 1:1 motion is known in closed form (docs/systems.md), there is nothing to reduce",
        "parallel": "the reduction is that of one ball in a level cavity",
        "cubic_barriers": "the reduction is that of a ball that flies freely between its impacts",
        "duffing": "the reduction is that of a ball in a linear oscillator",
        "hybrid": "the reduction has no mass on a spring beside the ball",
    },
)
