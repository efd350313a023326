"""The kind ``atlas``: all orbits of a set of words over a box."""

from __future__ import annotations

from typing import Any

import msgspec

from vines.errors import ParameterError
from vines.model import Params, Word
from vines.pipeline import Kind
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "Amplitudes", "AtlasOptions"]


class Amplitudes(msgspec.Struct, frozen=True, forbid_unknown_fields=True, rename={"start": "from", "stop": "to"}):
    """Evenly spaced forcing amplitudes, ends included."""

    start: float
    stop: float
    count: int


class AtlasOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All orbits of all words of up to `length` impacts and `period` forcing periods over a box of parameters.

    A point of the grid is a line through the box along the forcing amplitude, on which the families are followed, so
    that each orbit knows its branch. `words` names words instead of `length` and `period`.
    """

    amplitude: Amplitudes
    length: int = 3
    period: int = 1
    words: tuple[str, ...] = ()


def _check(params: dict[str, float], options: Any) -> None:
    along = options.amplitude
    for end in (along.start, along.stop):
        Params(**params, A=end)
    if not along.start < along.stop or along.count < 2:
        raise ParameterError(
            f"amplitude is {along.start:g} to {along.stop:g} in {along.count} values; allowed are from < to, count >= 2"
        )
    for word in options.words:
        Word(word)
    if not 2 <= options.length <= 12 or options.period < 1:
        raise ParameterError(
            f"length is {options.length} and period {options.period}, allowed are 2 <= length <= 12 and period >= 1"
        )


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
