"""The kind ``synth``: a synthetic campaign."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec
from msgspec import Meta

from vines.errors import ParameterError
from vines.pipeline import Kind

__all__ = ["KIND", "SynthOptions"]


class SynthOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A synthetic campaign: a sweep of the base amplitude up and down with ring-downs between."""

    amplitudes: Annotated[
        tuple[Annotated[float, Meta(gt=0)], ...], Meta(min_length=1, description="A = E/b in rising order")
    ]
    seed: Annotated[int, Meta(ge=0, description="Seed of noise and of what is drawn")] = 0
    draw: Annotated[bool, Meta(description="Whether imperfections are drawn over their ranges")] = False
    warming: Annotated[float, Meta(description="Change of temperature over the campaign [K]")] = 0.0
    settings: Annotated[dict[str, Any], Meta(description="Settings of the synthetic rig (docs/rig.md)")] = {}


def _check(params: dict[str, float], options: SynthOptions) -> None:
    del params
    if list(options.amplitudes) != sorted(set(options.amplitudes)):
        raise ParameterError(f"amplitudes are {list(options.amplitudes)}, allowed are numbers in rising order")


KIND = Kind(
    name="synth",
    summary="run folders of a synthetic rig, a sweep up and down with ring-downs; their truth is sealed",
    shape="whole",
    options=SynthOptions,
    body="vines.stages.rig._synth:compute",
    tables=("rig_made",),
    check=_check,
)
