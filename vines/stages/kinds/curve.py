"""The kind ``curve``: a bifurcation followed in two parameters."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError, ParameterError
from vines.model import VI_NES, Parameters, Params, Word, with_one_ball, word_for
from vines.pipeline import Kind, Pipeline, Stage
from vines.stages.kinds._checks import check_axes
from vines.stages.kinds._family import of_systems
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "CurveOptions", "FamilyCurveOptions"]


_BOUNDS = ("incomplete_chatter", "release_tangency")
"""Types that only orbits that stick have, which are those of the VI-NES."""

_NO_MULTIPLIERS = "impact_pair"
"""The system whose orbits that stick have multipliers of zero alone, and no bifurcations."""


class CurveOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Every curve of one type of bifurcation of a word in the plane of the two varied parameters.

    The bifurcations are found on the families of the word along the first parameter, at `lines` values of the second
    and from `seeds` values of the first, and along what comes out of these families by symmetry breaking.
    """

    word: Annotated[str, Meta(description="Word of the impacts, such as LR, or L*R* of orbits that stick")]
    type: Annotated[
        Literal[
            "fold",
            "symmetry_breaking",
            "period_doubling",
            "neimark_sacker",
            "grazing",
            "incomplete_chatter",
            "release_tangency",
        ],
        Meta(description="Which is followed; incomplete_chatter and release_tangency bound orbits that stick"),
    ]
    lines: Annotated[int, Meta(ge=1, description="Values of the second parameter on which it is sought")] = 3
    seeds: Annotated[int, Meta(ge=2, description="Values of the first parameter at which families are sought")] = 9
    step: Annotated[float, Meta(gt=0, le=1, description="Largest step, relative to the box")] = 0.02


class FamilyCurveOptions(CurveOptions, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Every curve of one type of bifurcation of a word in the plane of the two varied parameters, as of the VI-NES."""

    system: str


def _check(params: dict[str, float], options: CurveOptions) -> None:
    Params(**params)
    word = word_for(options.word, VI_NES)
    if options.type in _BOUNDS and not word.sticking:
        raise ParameterError(
            f"type is {options.type!r}, a bound of orbits that stick, and {options.word!r} does not; give a word with "
            "a star, such as L*R*"
        )


def _check_family(p: Parameters, options: FamilyCurveOptions) -> None:
    word_for(options.word, p.system, sticking=p.system.name != _NO_MULTIPLIERS)


def _fits(stage: Stage, pipeline: Pipeline) -> None:
    del pipeline
    check_axes(stage, 2, "a curve is followed in two parameters", "give vary.X and vary.Y")
    system = stage.kind.system
    options: Any = stage.options
    sticking = Word(options.word).sticking
    if system != VI_NES.name and options.type in (*_BOUNDS, *("grazing",) * sticking):
        raise DeclarationError(
            f"type is {options.type!r}: where orbits that stick end is followed for the system {VI_NES.name!r} only; "
            "give another word or type, or branches, which end there"
        )
    if sticking and system == _NO_MULTIPLIERS:
        raise DeclarationError(
            f"orbits of the system {system!r} that stick have multipliers of zero and no {options.type}; "
            "give a word without a star"
        )
    varied = [axis.name for axis in stage.axes]
    for name in with_one_ball(system).mirror.broken_by:
        if options.type == "symmetry_breaking" and (name in varied or stage.params.get(name, 0) != 0):
            raise DeclarationError(f"there is no symmetry to break unless {name} = 0; give that and vary others")


_VI_NES = Kind(
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

KIND = of_systems(
    _VI_NES,
    ("cubic_barriers", "drag", "duffing", "friction", "hybrid", "impact_pair", "modes", "parallel"),
    FamilyCurveOptions,
    "vines.stages.bodies._family_curve:compute",
    ("curves",),
    _check_family,
)
