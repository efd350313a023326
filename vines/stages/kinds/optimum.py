"""The kind ``optimum``: the best stable orbit of a word."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from vines.errors import ParameterError
from vines.model import VI_NES, Params, word_for
from vines.pipeline import Kind
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "OptimumOptions"]


class OptimumOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The stable orbit of a word with least max|x1| or largest K2/K1 over the varied parameters."""

    word: Annotated[str, Meta(description="Word of the impacts, such as LR")]
    objective: Annotated[
        Literal["max_abs_x1", "kinetic_ratio"], Meta(description="What is best: the least max|x1|, the largest K2/K1")
    ]
    largest_multiplier: Annotated[
        float, Meta(gt=0, le=1, description="Radius that keeps the Floquet multipliers inside")
    ] = 1.0


def _check(params: dict[str, float], options: OptimumOptions) -> None:
    Params(**{name: value for name, value in params.items() if name != "b"})
    word_for(options.word, VI_NES, sticking=False)
    if not params["b"] > 0:
        raise ParameterError(f"b is {params['b']:g}, allowed is b > 0: it is the half length of the cavity")


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
    meaningless={
        "impact_pair": "its capsule moves as it is driven, so that no displacement can be kept small; for its power "
        "vary B and G in a sweep",
        "parallel": "what several cavities are worth depends on the attractor that is reached; vary them in sweeps "
        "and draw the plot designs",
        "cubic_barriers": "what a spring is worth depends on the attractor that is reached; vary it in sweeps and draw "
        "the plot designs",
        "duffing": "what a ball is worth depends on the attractor that is reached; vary it in sweeps and draw the "
        "plot response",
        "hybrid": "what a spring beside the ball is worth depends on the attractor that is reached; vary it in sweeps "
        "and draw the plot designs",
    },
    scaled=("A",),  # with b, the length of the cavity
)
