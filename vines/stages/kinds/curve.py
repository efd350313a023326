"""The kind ``curve``: a bifurcation followed in two parameters."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from vines.errors import ParameterError
from vines.model import Params, Word
from vines.pipeline import Kind, Pipeline, Stage
from vines.stages.kinds._checks import check_axes, check_least
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "CurveOptions"]


class CurveOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Every curve of one type of bifurcation of a word in the plane of the two varied parameters.

    The bifurcations are found on the families of the word along the first parameter, at `lines` values of the second
    and from `seeds` values of the first, and along what comes out of these families by symmetry breaking. `step` is
    the largest step, relative to the box.
    """

    word: str
    type: Literal["fold", "symmetry_breaking", "period_doubling", "neimark_sacker", "grazing"]
    lines: int = 3
    seeds: int = 9
    step: float = 0.02


def _check(params: dict[str, float], options: Any) -> None:
    Params(**params)
    Word(options.word)
    check_least(msgspec.structs.asdict(options), {"lines": 1, "seeds": 2})
    if not 0 < options.step <= 1:
        raise ParameterError(f"step is {options.step:g}, allowed is 0 < step <= 1")


def _fits(stage: Stage, pipeline: Pipeline) -> None:
    del pipeline
    check_axes(stage, 2, "a curve is followed in two parameters", "give vary.X and vary.Y")


KIND = Kind(
    name="curve",
    summary="a bifurcation followed in two parameters, with its special points",
    shape="whole",
    options=CurveOptions,
    body="vines.stages.bodies._curve:compute",
    tables=("curves",),
    parameters=PARAMETERS,
    vary="range",
    check=_check,
    kernels=("orbits", "curves"),
    fits=_fits,
)
