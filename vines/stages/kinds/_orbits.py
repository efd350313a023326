"""Kinds of periodic orbits: branches, curves of bifurcations, atlases, optima."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from vines.errors import ParameterError
from vines.model import Params
from vines.pipeline import Kind, register
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["Amplitudes", "AtlasOptions", "BranchOptions", "CurveOptions", "OptimumOptions", "register_orbits"]


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


class OptimumOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The stable orbit of a word with least max|x1| or largest K2/K1 over the varied parameters.

    `largest_multiplier` keeps the Floquet multipliers inside that radius.
    """

    word: str
    objective: Literal["max_abs_x1", "kinetic_ratio"]
    largest_multiplier: float = 1.0


def _check_branch(params: dict[str, float], options: Any) -> None:
    from vines.model import Word

    Params(**params)
    Word(options.word)
    for name, least in (("points", 2), ("seeds", 2), ("switch", 0)):
        value = getattr(options, name)
        if value < least:
            raise ParameterError(f"{name} is {value}, allowed is {name} >= {least}")


def _check_curve(params: dict[str, float], options: Any) -> None:
    from vines.model import Word

    Params(**params)
    Word(options.word)
    for name, least in (("lines", 1), ("seeds", 2)):
        value = getattr(options, name)
        if value < least:
            raise ParameterError(f"{name} is {value}, allowed is {name} >= {least}")
    if not 0 < options.step <= 1:
        raise ParameterError(f"step is {options.step:g}, allowed is 0 < step <= 1")


def _check_atlas(params: dict[str, float], options: Any) -> None:
    from vines.model import Word

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


def _check_optimum(params: dict[str, float], options: Any) -> None:
    from vines.model import Word

    Params(**{name: value for name, value in params.items() if name != "b"})
    Word(options.word)
    if not params["b"] > 0:
        raise ParameterError(f"b is {params['b']:g}, allowed is b > 0: it is the half length of the cavity")
    if not 0 < options.largest_multiplier <= 1:
        raise ParameterError(
            f"largest_multiplier is {options.largest_multiplier:g}, allowed is 0 < largest_multiplier <= 1"
        )


def register_orbits() -> None:
    """Make the kinds of periodic orbits known to declarations."""
    register(
        Kind(
            name="branch",
            summary="a family of periodic orbits with multipliers and bifurcations",
            shape="whole",
            options=BranchOptions,
            body="vines.stages.bodies._branch:compute",
            tables=("orbits", "branches", "bifurcations"),
            parameters=PARAMETERS,
            vary="range",
            check=_check_branch,
            kernels=("orbits",),
        )
    )
    register(
        Kind(
            name="curve",
            summary="a bifurcation followed in two parameters, with its special points",
            shape="whole",
            options=CurveOptions,
            body="vines.stages.bodies._curve:compute",
            tables=("curves",),
            parameters=PARAMETERS,
            vary="range",
            check=_check_curve,
            kernels=("orbits", "curves"),
        )
    )
    register(
        Kind(
            name="atlas",
            summary="all orbits of all words up to a length over a box of parameters, linked to their branches",
            shape="points",
            options=AtlasOptions,
            body="vines.stages.bodies._atlas:compute",
            tables=("atlas", "orbits", "branches", "bifurcations"),
            parameters={name: value for name, value in PARAMETERS.items() if name != "A"},
            vary="grid",
            check=_check_atlas,
            kernels=("orbits",),
        )
    )
    register(
        Kind(
            name="optimum",
            summary="the stable orbit with least max|x1| or largest K2/K1, and its distance to bifurcations",
            shape="whole",
            options=OptimumOptions,
            body="vines.stages.bodies._optimum:compute",
            tables=("optima", "orbits"),
            parameters={**PARAMETERS, "b": 1.0},
            vary="range",
            check=_check_optimum,
            kernels=("orbits",),
        )
    )
