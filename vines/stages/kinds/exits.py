"""The kind ``exits``: how long regimes hold under noise, and where they are left to."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec
from msgspec import Meta

from vines.bounds import check_hold, check_periods, check_splitting
from vines.errors import DeclarationError, ParameterError, nearest
from vines.model import VI_NES, Parameters, Params, system_names, word_for
from vines.pipeline import Kind
from vines.stages.kinds._family import of_systems
from vines.stages.kinds._parameters import PARAMETERS
from vines.stages.kinds._simulation import Record, Seed, Settle, Start, Watch, check_simulation

__all__ = ["KIND", "ColouredForce", "ExitsOptions", "FamilyExitsOptions", "PairScatter", "ScatterOptions"]

_Deviation = Annotated[float, Meta(ge=0)]
SigmaR = Annotated[_Deviation, Meta(description="Standard deviation of the restitution from impact to impact")]
Spread = Annotated[
    dict[str, Annotated[float, Meta(ge=0, le=1)]],
    Meta(
        description="Standard deviation of parameters from unit to unit, as shares of their values; each run is a unit"
    ),
]
DrawnFrom = Annotated[
    int, Meta(ge=0, le=2**53 - 1, description="Seed; what a run draws follows from it, the point, and its own number")
]


class ColouredForce(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A random force with a memory, an Ornstein-Uhlenbeck process."""

    sigma: Annotated[float, Meta(ge=0, description="Its standard deviation, in units of A")]
    correlation_time: Annotated[float, Meta(gt=0, description="Forcing periods after which it has forgotten 1 - 1/e")]


class ScatterOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The noise of runs, as of `vines.Scatter`: restitution, forces, phase, units."""

    sigma_r: SigmaR = 0.0
    noise: Annotated[
        float, Meta(ge=0, description="Standard deviation of a force on the oscillator that is held, in units of A")
    ] = 0.0
    hold: Annotated[
        int, Meta(ge=1, le=4096, description="How often in a forcing period that force and the phase change")
    ] = 32
    phase_diffusion: Annotated[
        float,
        Meta(ge=0, description="Standard deviation of what a forcing period adds to the phase of the base [rad]"),
    ] = 0.0
    ou: Annotated[ColouredForce | None, Meta(description="A random force with a memory")] = None
    spread: Spread = {}
    seed: DrawnFrom = 0


class PairScatter(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The noise of runs of the impact pair, whose capsule moves as it is driven: restitution and units."""

    sigma_r: SigmaR = 0.0
    spread: Spread = {}
    seed: DrawnFrom = 0


Words = Annotated[tuple[str, ...], Meta(description="Words whose stable orbits are regimes, too: few starts may come")]
Runs = Annotated[int, Meta(ge=1, le=100_000, description="Runs that begin in each regime")]
Periods = Annotated[int, Meta(ge=1, description="Forcing periods after which a run is censored")]
Confirm = Annotated[
    int, Meta(ge=1, le=4096, description="Forcing periods in a row over which the pattern of impacts has to differ")
]
Wait = Annotated[
    int, Meta(ge=0, description="Forcing periods that a run has to hold before it counts: for the noise to settle in")
]
Splitting = Annotated[
    int,
    Meta(
        ge=0,
        le=100_000,
        description="Runs of each level of a splitting, for exits that runs are too few for; 0 for none",
    ),
]
RandomStarts = Annotated[int, Meta(ge=0, description="Random starts without noise, for the regimes and their basins")]


class ExitsOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How long each regime of a point holds under noise: runs that begin in it, until they have left it.

    Regimes are the attractors that start, random starts and words come to without noise, and those that runs go to. A
    run has left its regime when its pattern of impacts has differed for `confirm` periods and it would not come back
    without noise. The parameter `level` multiplies everything that the scatter draws.
    """

    scatter: Annotated[ScatterOptions, Meta(description="The noise")]
    start: Annotated[Start, Meta(description="Start of the first run without noise")] = msgspec.field(
        default_factory=Start
    )
    words: Words = ()
    runs: Runs = 64
    periods: Periods = 2000
    confirm: Confirm = 8
    wait: Wait = 0
    splitting: Splitting = 0
    random: RandomStarts = 64
    seed: Seed = 0
    settle: Settle = 400
    record: Record = 64
    watch: Watch = 512


class FamilyExitsOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How long each regime of a point holds under noise: runs that begin in it, until they have left it.

    As of the VI-NES; the impact pair can have scatter of its restitution, and units that differ.
    """

    system: str
    scatter: Annotated[PairScatter, Meta(description="The noise")]
    start: Annotated[
        dict[str, float], Meta(description="Start by the names of the system; what is left out is as it declares")
    ] = {}
    words: Words = ()
    runs: Runs = 64
    periods: Periods = 2000
    confirm: Confirm = 8
    wait: Wait = 0
    splitting: Splitting = 0
    random: RandomStarts = 64
    seed: Seed = 0
    settle: Settle = 400
    record: Record = 64
    watch: Watch = 512


def _check(params: dict[str, float], options: ExitsOptions) -> None:
    given = {name: value for name, value in params.items() if name != "level"}
    check_simulation(given, options)
    _check_noise(Params(**given), params["level"], options)
    if options.scatter.ou is not None and options.scatter.ou.sigma > 0:
        check_hold(options.scatter.hold, given["Omega"])


def _check_noise(p: Parameters, level: float, options: Any) -> None:
    """Refuse words, spreads and levels that cannot be, and runs that take years together."""
    if level < 0:
        raise ParameterError(f"level is {level:g}, allowed is level >= 0: it multiplies standard deviations")
    for word in options.words:
        word_for(word, p.system)
    names = [each.name for each in p.system.parameters]
    for name in options.scatter.spread:
        if name not in names:
            raise DeclarationError(f"scatter.spread: unknown parameter {name!r}: {nearest(name, names)}")
    check_periods("runs periods", float(options.runs) * options.periods)
    check_periods("(settle + record) (1 + random)", (options.settle + options.record) * (1 + options.random))
    asked = [name for name in ("phase_diffusion", "spread") if getattr(options.scatter, name, None)]
    check_splitting(options.splitting, asked, getattr(options.scatter, "hold", 32))
    if not options.wait < options.periods:
        raise DeclarationError(f"wait is {options.wait}, allowed is wait < periods, which is {options.periods}")


def _check_pair(p: Parameters, options: FamilyExitsOptions) -> None:
    _check_noise(p, 0.0, options)


def _kernels(options: ExitsOptions, carried: bool) -> tuple[str, ...]:
    del carried
    asked = ("one_run", "lanes", "many_runs", "exits")
    return (*asked, "orbits") if options.words else asked


SCATTERED = (VI_NES.name, "impact_pair")
"""Systems whose kernels have scatter."""

_VI_NES = Kind(
    name="exits",
    summary="how long regimes hold under noise, where they are left to, and which holds most of the time",
    shape="points",
    options=ExitsOptions,
    body="vines.stages.bodies._exits:compute",
    tables=("exit_points", "exit_regimes", "exits", "attractors"),
    parameters={**PARAMETERS, "level": 1.0},
    vary="grid",
    check=_check,
    again="long_points",
    kernels=_kernels,
    meaningless={name: "its kernels have no scatter" for name in system_names() if name not in SCATTERED},
)

KIND = of_systems(
    _VI_NES,
    [name for name in SCATTERED if name != VI_NES.name],
    FamilyExitsOptions,
    "vines.stages.bodies._exits:compute",
    ("exit_points", "exit_regimes", "exits", "attractors"),
    _check_pair,
)
