"""Kinds that run the simulator: trajectories, sweeps, basins."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from vines.errors import ParameterError, StateError
from vines.model import Params
from vines.pipeline import Kind, register
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["BasinsOptions", "Grid", "Start", "SweepOptions", "TrajectoryOptions", "register_runs"]


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


class Grid(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A coordinate of the start with evenly spaced values, `from` and `to` included."""

    name: Literal["x1", "v1", "x2", "v2", "phase"]
    start: float = msgspec.field(name="from")
    stop: float = msgspec.field(name="to")
    count: int = 100


class BasinsOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """To which attractor each start of a grid over the coordinates `x` and `y` comes, the others as in `start`.

    Starts that come to no known orbit within `settle` periods are classified, exponents being believed after `watch`
    periods more. After `patience` periods a start that has not settled is called so, and so is one on chaos that does
    not last as long.
    Cells at a boundary are halved in both directions `refine` times.
    """

    x: Grid
    y: Grid
    start: dict[str, float] = {}
    refine: int = 0
    settle: int = 256
    patience: int = 4000
    watch: int = 128


def _kernels_of_sweep(options: SweepOptions, carried: bool) -> tuple[str, ...]:
    # Lanes run the points that do not wait for each other, and random starts.
    alone = carried and not options.random
    return ("one_run",) if alone else ("one_run", "many_runs")


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
        ("settle", options.settle, 1),
        ("patience", options.patience, 1),
        ("watch", options.watch, 16),
    ):
        if value < least:
            raise ParameterError(f"{name} is {value}, allowed is {name} >= {least}")


def register_runs() -> None:
    """Make the kinds that run the simulator known to declarations."""
    register(
        Kind(
            name="trajectory",
            summary="one run of the simulator, as an MCAP log",
            shape="points",
            options=TrajectoryOptions,
            body="vines.stages.bodies._trajectory:compute",
            tables=("points", "impacts"),
            parameters=PARAMETERS,
            vary="grid",
            carry=True,
            logs=True,
            check=_check_simulation,
            kernels=("one_run", "runs"),
        )
    )
    register(
        Kind(
            name="sweep",
            summary="the settled attractor, impacts and energy measures of each point of a grid",
            shape="points",
            options=SweepOptions,
            body="vines.stages.bodies._sweep:compute",
            tables=("points", "impacts", "attractors"),
            parameters=PARAMETERS,
            vary="grid",
            carry=True,
            check=_check_simulation,
            kernels=_kernels_of_sweep,
        )
    )
    register(
        Kind(
            name="basins",
            summary="to which attractor each start of a grid comes, and the attractors that coexist",
            shape="whole",
            options=BasinsOptions,
            body="vines.stages.bodies._basins:compute",
            tables=("attractors", "basins"),
            parameters=PARAMETERS,
            check=_check_basins,
            kernels=("many_runs", "one_run", "runs"),
        )
    )
