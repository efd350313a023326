"""The kind ``branch``: families of periodic orbits in one parameter."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from vines.model import Params, Word
from vines.pipeline import Kind, Pipeline, Stage
from vines.stages.kinds._checks import check_axes, check_least
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "BranchOptions"]


class BranchOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Families of periodic orbits of one word, followed in the varied parameter.

    `points` values of the parameter, evenly spaced from end to end, are among the orbits on every sheet of a branch.
    `families = "one"` follows the orbit that `find_orbit` chooses at the start of the range to its end, `"all"` every
    family that is found at one of `seeds` values of the parameter. `switch` is the number of generations that are
    followed out of them at symmetry breakings and period doublings.
    """

    word: str
    points: int = 400
    families: Literal["one", "all"] = "one"
    seeds: int = 13
    switch: int = 0


def _check(params: dict[str, float], options: Any) -> None:
    Params(**params)
    Word(options.word)
    check_least(msgspec.structs.asdict(options), {"points": 2, "seeds": 2, "switch": 0})


def _fits(stage: Stage, pipeline: Pipeline) -> None:
    del pipeline
    check_axes(stage, 1, "a branch is followed in one parameter", "give one vary.X")


KIND = Kind(
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
