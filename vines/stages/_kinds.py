"""The kinds of stages that vines knows: light specifications, without numba, pyarrow, rerun or matplotlib.

A body is named by its dotted path and imported only when there is something to compute.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import msgspec

from vines.errors import FileMissingError, ParameterError, StateError
from vines.model import LAM_TABLE_1, Params
from vines.pipeline import Kind, register
from vines.places import shipped

__all__ = [
    "BranchOptions",
    "CheckOptions",
    "FigureOptions",
    "OptimumOptions",
    "ReducedOptions",
    "Start",
    "SweepOptions",
    "TrajectoryOptions",
    "register_kinds",
]

PARAMETERS: dict[str, float | None] = {"mu": None, "A": None, "Omega": 1.0, "r": 0.65, "lam": LAM_TABLE_1}


class Start(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Start state (dimensionless): the oscillator at rest and the ball moving, if nothing is said."""

    x1: float = 0.0
    v1: float = 0.0
    x2: float = 0.0
    v2: float = 0.1


class TrajectoryOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One run of the simulator: `settle` periods unrecorded, then `record` periods into an MCAP log.

    With `bare` the log also carries what a viewer without vines understands (docs/logs.md).
    """

    start: Start = msgspec.field(default_factory=Start)
    settle: int = 400
    record: int = 10
    per_period: int = 200
    bare: bool = True


class SweepOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The settled attractor of each point: `settle` periods, then `record` periods that are classified and measured.

    `keep` is the number of recorded periods whose impacts are kept where the attractor is not periodic; of a periodic
    one, one repetition is.
    """

    start: Start = msgspec.field(default_factory=Start)
    settle: int = 400
    record: int = 64
    keep: int = 64


class BranchOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A family of periodic orbits of one word, followed in the varied parameter.

    `points` values of the parameter, evenly spaced from end to end, are among the orbits on every sheet of the branch.
    """

    word: str
    points: int = 400


class ReducedOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The multiple-scales approximation of the symmetric 1:1 response beside the exact orbit; nothing to choose."""


class OptimumOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The stable orbit of a word with least max|x1| or largest K2/K1 over the varied parameters.

    `largest_multiplier` keeps the Floquet multipliers inside that radius.
    """

    word: str
    objective: Literal["max_abs_x1", "kinetic_ratio"]
    largest_multiplier: float = 1.0


class FigureOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A picture of the needed stages; `panels` are the quantities shown, by default those of the plot."""

    plot: Literal["bifurcation", "reduced"]
    panels: tuple[str, ...] = ()
    title: str = ""
    width: float = 7.0


class CheckOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Published values against the tables of the needed stages."""

    claims: tuple[str, ...]


def _check_simulation(params: dict[str, float], options: Any) -> None:
    Params(**params)
    for name, least in (("settle", 0), ("record", 2), ("per_period", 2), ("keep", 1)):
        value = getattr(options, name, least)
        if value < least:
            raise ParameterError(f"{name} is {value}, allowed is {name} >= {least}")
    gap = options.start.x1 - options.start.x2
    if abs(gap) > 1:
        raise StateError(
            f"start has the gap w = x1 - x2 = {gap:g}, allowed is |w| <= 1: the ball would be outside the cavity"
        )


def _check_model(params: dict[str, float], options: Any) -> None:
    del options
    Params(**params)


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


def _check_branch(params: dict[str, float], options: Any) -> None:
    from vines.model import Word

    Params(**params)
    Word(options.word)
    if options.points < 2:
        raise ParameterError(f"points is {options.points}, allowed is points >= 2")


def _claims_file(options: Any, root: Path) -> tuple[Path, ...]:
    del options
    for file in (root / "pipelines" / "claims.toml", shipped("pipelines") / "claims.toml"):
        if file.is_file():
            return (file,)
    raise FileMissingError("pipelines/claims.toml, the published values, is missing; take it from the vines sources")


def register_kinds() -> None:
    """Make the kinds of vines known to declarations; calling it again changes nothing."""
    register(
        Kind(
            name="trajectory",
            summary="one run of the simulator, as an MCAP log",
            shape="points",
            options=TrajectoryOptions,
            body="vines.stages._trajectory:compute",
            tables=("points", "impacts"),
            parameters=PARAMETERS,
            vary="grid",
            logs=True,
            check=_check_simulation,
        )
    )
    register(
        Kind(
            name="sweep",
            summary="the settled attractor, impacts and energy measures of each point of a grid",
            shape="points",
            options=SweepOptions,
            body="vines.stages._sweep:compute",
            tables=("points", "impacts"),
            parameters=PARAMETERS,
            vary="grid",
            carry=True,
            check=_check_simulation,
        )
    )
    register(
        Kind(
            name="branch",
            summary="a family of periodic orbits with multipliers and bifurcations",
            shape="whole",
            options=BranchOptions,
            body="vines.stages._branch:compute",
            tables=("orbits", "branches", "bifurcations"),
            parameters=PARAMETERS,
            vary="range",
            check=_check_branch,
        )
    )
    register(
        Kind(
            name="reduced",
            summary="the multiple-scales approximation of the symmetric 1:1 response beside the exact orbit",
            shape="points",
            options=ReducedOptions,
            body="vines.stages._reduced:compute",
            tables=("reduced",),
            parameters=PARAMETERS,
            vary="grid",
            check=_check_model,
        )
    )
    register(
        Kind(
            name="optimum",
            summary="the stable orbit with least max|x1| or largest K2/K1, and its distance to bifurcations",
            shape="whole",
            options=OptimumOptions,
            body="vines.stages._optimum:compute",
            tables=("optima", "orbits"),
            parameters={**PARAMETERS, "b": 1.0},
            vary="range",
            check=_check_optimum,
        )
    )
    register(
        Kind(
            name="figure",
            summary="a picture of other stages, PNG and SVG",
            shape="whole",
            options=FigureOptions,
            body="vines.stages._figure:compute",
            needs=True,
            pictures=True,
        )
    )
    register(
        Kind(
            name="check",
            summary="published values against the tables of other stages",
            shape="whole",
            options=CheckOptions,
            body="vines.stages._check:compute",
            tables=("checks",),
            needs=True,
            files=_claims_file,
        )
    )
