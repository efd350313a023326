"""The kind ``optimum``: the best stable orbit of a word."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from vines.errors import ParameterError
from vines.model import Params, Word
from vines.pipeline import Kind
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "OptimumOptions"]


class OptimumOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The stable orbit of a word with least max|x1| or largest K2/K1 over the varied parameters.

    `largest_multiplier` keeps the Floquet multipliers inside that radius.
    """

    word: str
    objective: Literal["max_abs_x1", "kinetic_ratio"]
    largest_multiplier: float = 1.0


def _check(params: dict[str, float], options: Any) -> None:
    Params(**{name: value for name, value in params.items() if name != "b"})
    Word(options.word)
    if not params["b"] > 0:
        raise ParameterError(f"b is {params['b']:g}, allowed is b > 0: it is the half length of the cavity")
    if not 0 < options.largest_multiplier <= 1:
        raise ParameterError(
            f"largest_multiplier is {options.largest_multiplier:g}, allowed is 0 < largest_multiplier <= 1"
        )


KIND = Kind(
    name="optimum",
    summary="the stable orbit with least max|x1| or largest K2/K1, and its distance to bifurcations",
    shape="whole",
    options=OptimumOptions,
    body="vines.stages.bodies._optimum:compute",
    tables=("optima", "orbits"),
    parameters={**PARAMETERS, "b": 1.0},
    vary="range",
    check=_check,
    kernels=("orbits",),
)
