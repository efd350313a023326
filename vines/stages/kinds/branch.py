"""The kind ``branch``: families of periodic orbits in one parameter."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from vines.model import VI_NES, Params, word_for
from vines.pipeline import Kind, Pipeline, Stage
from vines.stages.kinds._checks import check_axes
from vines.stages.kinds._family import FamilyBranchOptions, of_systems
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "BranchOptions"]


class BranchOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Families of periodic orbits of one word, followed in the varied parameter.

    `families = "one"` follows the orbit that `find_orbit` chooses at the start of the range to its end, `"all"` every
    family that is found at one of `seeds` values of the parameter.
    """

    word: Annotated[str, Meta(description="Word of the impacts, such as LR")]
    points: Annotated[
        int,
        Meta(ge=2, description="Evenly spaced values of the parameter that have an orbit on every sheet of a branch"),
    ] = 400
    families: Annotated[Literal["one", "all"], Meta(description="Which families are followed")] = "one"
    seeds: Annotated[int, Meta(ge=2, description="Values of the parameter at which families are sought")] = 13
    switch: Annotated[
        int, Meta(ge=0, description="Generations followed out of symmetry breakings and period doublings")
    ] = 0


def _check(params: dict[str, float], options: BranchOptions) -> None:
    Params(**params)
    word_for(options.word, VI_NES)


def _fits(stage: Stage, pipeline: Pipeline) -> None:
    del pipeline
    check_axes(stage, 1, "a branch is followed in one parameter", "give one vary.X")


_VI_NES = Kind(
    name="branch",
    summary="a family of periodic orbits with multipliers and bifurcations",
    shape="whole",
    options=BranchOptions,
    body="vines.stages.bodies._branch:compute",
    tables=("orbits", "branches", "bifurcations"),
    parameters=PARAMETERS,
    vary="range",
    check=_check,
    kernels=("orbits",),
    fits=_fits,
)

KIND = of_systems(
    _VI_NES,
    ("cubic_barriers", "drag", "duffing", "friction", "hybrid", "impact_pair", "modes", "parallel"),
    FamilyBranchOptions,
    "vines.stages.bodies._family_branch:compute",
    ("orbits", "branches", "bifurcations"),
)
