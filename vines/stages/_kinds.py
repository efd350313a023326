"""The kinds of stages that vines knows: light specifications, without numba, pyarrow, rerun or matplotlib.

A body is named by its dotted path and imported only when there is something to compute.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any, Literal

import msgspec

from vines.errors import FileMissingError, ParameterError, StateError
from vines.model import LAM_TABLE_1, Params, PhysicalParams
from vines.pipeline import Kind, register
from vines.places import shipped
from vines.stages._rig_kinds import register_rig_kinds

__all__ = [
    "Amplitudes",
    "AtlasOptions",
    "BasinsOptions",
    "BranchOptions",
    "Cell",
    "CheckOptions",
    "CurveOptions",
    "DimensionlessOptions",
    "FigureOptions",
    "Grid",
    "OptimumOptions",
    "ReducedOptions",
    "Start",
    "SweepOptions",
    "TrajectoryOptions",
    "register_kinds",
]

PARAMETERS: dict[str, float | None] = {"mu": None, "A": None, "Omega": 1.0, "r": 0.65, "lam": LAM_TABLE_1}

TABLE_1: dict[str, float | None] = dataclasses.asdict(PhysicalParams())
"""The rig of the paper in SI units (Table 1)."""


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

    Where nothing repeats, a point runs on for `watch` periods before its Lyapunov exponent is believed. `keep` is the
    number of recorded periods whose impacts are kept where the attractor is not periodic; of a periodic one, one
    repetition is; 0 keeps no impacts. At each point `random` further starts are drawn with `seed`, and the table
    ``attractors`` lists every attractor that they come to beside the point's own. With `start = "random"` the own
    start is drawn in the same way.
    """

    start: Start | Literal["random"] = msgspec.field(default_factory=Start)
    settle: int = 400
    record: int = 64
    watch: int = 512
    keep: int = 64
    random: int = 0
    seed: int = 0


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


class ReducedOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The multiple-scales approximation of the symmetric 1:1 response beside the exact orbit; nothing to choose."""


class DimensionlessOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A rig in SI units, Table 1 of the paper by default, and its dimensionless parameters; nothing to choose."""


class OptimumOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The stable orbit of a word with least max|x1| or largest K2/K1 over the varied parameters.

    `largest_multiplier` keeps the Floquet multipliers inside that radius.
    """

    word: str
    objective: Literal["max_abs_x1", "kinetic_ratio"]
    largest_multiplier: float = 1.0


class Grid(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A coordinate of the start with evenly spaced values, `from` and `to` included."""

    name: Literal["x1", "v1", "x2", "v2", "phase"]
    start: float = msgspec.field(name="from")
    stop: float = msgspec.field(name="to")
    count: int = 100


class BasinsOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """To which attractor each start of a grid over the coordinates `x` and `y` comes, the others as in `start`.

    Cells at a boundary are halved in both directions `refine` times; after `patience` periods a start is unsettled.
    """

    x: Grid
    y: Grid
    start: dict[str, float] = {}
    refine: int = 0
    patience: int = 4000


class Cell(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A panel of a figure with panels of several kinds: what it shows of which of the needed stages.

    Of runs it shows the two ends of the cavity with the ball (`ends`) or gap and relative velocity (`gap`) over
    `periods` forcing periods, or the phase plane of all of them. Of sweeps and branches that vary one parameter it
    shows a quantity, or the moduli of the multipliers of the branch that `families` names.

    `families` are the labels of branches, such as ``1:1 symmetric``, all by default. `marks` are the types of
    bifurcations that are marked, each with what is written beside it; all by default. `opacity` is that of simulated
    impacts, where they repeat they add up to solid. `window` and `y` are the parts of the axes that are shown.

    In a ``response`` it shows `energy` (K2/K1 and max|x1|), `max_abs_x1` alone, or `w_dot` of sweeps that are carried
    along one axis, of their points those that agree with `where`. What then differs beside the carried axis tells
    curves apart; they get `colours` in ascending order.
    """

    show: Literal["ends", "gap", "phase_plane", "multipliers", "w_dot", "dt", "x1", "phase", "energy", "max_abs_x1"]
    of: tuple[str, ...]
    title: str = ""
    periods: float = 3.0
    families: tuple[str, ...] = ()
    marks: dict[str, str] = {}
    opacity: float | None = None
    window: tuple[float, float] | None = None
    y: tuple[float, float] | None = None
    where: dict[str, float] = {}
    colours: tuple[Literal["red", "green", "blue", "black", "orange"], ...] = ("red", "green", "blue")


class FigureOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A picture of the needed stages; `panels` are the quantities shown, by default those of the plot.

    `window` is the part of the varied parameter that is shown; with `mirror` the mirror images of asymmetric orbits are
    drawn too. A sheet has `cells` of several kinds in `columns`, in rows of the `height` given in inches,
    with `letters` on each panel or each row. A response has `cells` of sweeps with all attractors that coexist, and a
    strip with the reduction of max|x1| below each that shows energies.
    """

    plot: Literal["bifurcation", "reduced", "multipliers", "chart", "basins", "sheet", "response", "regimes"]
    panels: tuple[str, ...] = ()
    title: str = ""
    width: float = 7.0
    window: tuple[float, float] | None = None
    mirror: bool = False
    cells: tuple[Cell, ...] = ()
    columns: int = 1
    letters: Literal["panels", "rows"] = "panels"
    height: float = 2.3


class CheckOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Published values against the tables of the needed stages."""

    claims: tuple[str, ...]


def _check_simulation(params: dict[str, float], options: Any) -> None:
    Params(**params)
    limits = {"settle": 0, "record": 2, "watch": 16, "per_period": 2, "keep": 0, "random": 0, "seed": 0}
    for name, least in limits.items():
        value = getattr(options, name, least)
        if value < least:
            raise ParameterError(f"{name} is {value}, allowed is {name} >= {least}")
    if options.start == "random":
        return
    gap = options.start.x1 - options.start.x2
    if abs(gap) > 1:
        raise StateError(
            f"start has the gap w = x1 - x2 = {gap:g}, allowed is |w| <= 1: the ball would be outside the cavity"
        )


def _check_model(params: dict[str, float], options: Any) -> None:
    del options
    Params(**params)


def _check_rig(params: dict[str, float], options: Any) -> None:
    del options
    rig = PhysicalParams(**{name: params[name] for name in TABLE_1})
    rig.dimensionless(**{name: value for name, value in params.items() if name not in TABLE_1})


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


def _check_basins(params: dict[str, float], options: Any) -> None:
    Params(**params)
    names = {options.x.name, options.y.name}
    if len(names) < 2 or names & set(options.start):
        raise ParameterError(f"x is {options.x.name}, y is {options.y.name}: give two coordinates, not again in start")
    for name in options.start:
        if name not in ("x1", "v1", "x2", "v2", "phase"):
            raise ParameterError(f"unknown coordinate {name!r} in start, allowed: x1, v1, x2, v2, phase")
    for name, value, least in (
        ("count", min(options.x.count, options.y.count), 2),
        ("refine", options.refine, 0),
        ("patience", options.patience, 1),
    ):
        if value < least:
            raise ParameterError(f"{name} is {value}, allowed is {name} >= {least}")


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
            carry=True,
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
            tables=("points", "impacts", "attractors"),
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
            name="curve",
            summary="a bifurcation followed in two parameters, with its special points",
            shape="whole",
            options=CurveOptions,
            body="vines.stages._curve:compute",
            tables=("curves",),
            parameters=PARAMETERS,
            vary="range",
            check=_check_curve,
        )
    )
    register(
        Kind(
            name="atlas",
            summary="all orbits of all words up to a length over a box of parameters, linked to their branches",
            shape="points",
            options=AtlasOptions,
            body="vines.stages._atlas:compute",
            tables=("atlas", "orbits", "branches", "bifurcations"),
            parameters={name: value for name, value in PARAMETERS.items() if name != "A"},
            vary="grid",
            check=_check_atlas,
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
            name="dimensionless",
            summary="a rig in SI units and its dimensionless parameters",
            shape="points",
            options=DimensionlessOptions,
            body="vines.stages._dimensionless:compute",
            tables=("dimensionless",),
            parameters={**TABLE_1, "E": None, "omega": None, "m": None},
            vary="grid",
            check=_check_rig,
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
            name="basins",
            summary="to which attractor each start of a grid comes, and the attractors that coexist",
            shape="whole",
            options=BasinsOptions,
            body="vines.stages._basins:compute",
            tables=("attractors", "basins"),
            parameters=PARAMETERS,
            check=_check_basins,
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
    register_rig_kinds()
