"""The kind ``atlas``: all orbits of a set of words over a box.

Not `vines.attractors.atlas`, which catalogues the stable orbits of any word over a rectangle.
"""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from vines.errors import ParameterError
from vines.model import VI_NES, Params, word_for
from vines.pipeline import Kind
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "Amplitudes", "AtlasOptions"]


class Amplitudes(msgspec.Struct, frozen=True, forbid_unknown_fields=True, rename={"start": "from", "stop": "to"}):
    """Evenly spaced forcing amplitudes, ends included."""

    start: Annotated[float, Meta(description="The first")]
    stop: Annotated[float, Meta(description="The last, above the first")]
    count: Annotated[int, Meta(ge=2, description="How many")]


class AtlasOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All orbits of all words of up to `length` impacts and `period` forcing periods over a box of parameters.

    A point of the grid is a line through the box along the forcing amplitude, on which the families are followed, so
    that each orbit knows its branch. Unstable orbits are listed too. The Python function `vines.attractors.atlas` is
    another thing: the stable orbits of any word over a rectangle of two parameters, with simulations to say what is
    missing.
    """

    amplitude: Annotated[Amplitudes, Meta(description="Forcing amplitudes at which orbits are listed")]
    length: Annotated[int, Meta(ge=2, le=12, description="Impacts of the longest words")] = 3
    period: Annotated[int, Meta(ge=1, description="Forcing periods of the longest words")] = 1
    words: Annotated[tuple[str, ...], Meta(description="Words instead of all up to `length` and `period`")] = ()


def _check(params: dict[str, float], options: AtlasOptions) -> None:
    along = options.amplitude
    for end in (along.start, along.stop):
        Params(**params, A=end)
    if not along.start < along.stop:
        raise ParameterError(f"amplitude is {along.start:g} to {along.stop:g}, allowed is from < to")
    for word in options.words:
        word_for(word, VI_NES)


KIND = Kind(
    name="atlas",
    summary="all orbits of all words up to a length over a box of parameters, linked to their branches",
    shape="points",
    options=AtlasOptions,
    body="vines.stages.bodies._atlas:compute",
    tables=("atlas", "orbits", "branches", "bifurcations"),
    parameters={name: value for name, value in PARAMETERS.items() if name != "A"},
    vary="grid",
    check=_check,
    kernels=("orbits",),
)
