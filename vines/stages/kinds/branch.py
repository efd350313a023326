"""The kind ``branch``: families of periodic orbits in one parameter."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from vines.errors import DeclarationError, ParameterError
from vines.model import Params, Word
from vines.pipeline import Kind, Pipeline, Stage
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
    for name, least in (("points", 2), ("seeds", 2), ("switch", 0)):
        value = getattr(options, name)
        if value < least:
            raise ParameterError(f"{name} is {value}, allowed is {name} >= {least}")


def _fits(stage: Stage, pipeline: Pipeline) -> None:
    if len(stage.axes) != 1:
        names = ", ".join(axis.name for axis in stage.axes) or "nothing"
        raise DeclarationError(f"a branch is followed in one parameter, this one varies {names}; give one vary.X")


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
