"""The kind ``basins``: to which attractor each start of a grid comes."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Annotated, Literal

import msgspec
from msgspec import Meta

from vines.errors import ParameterError, nearest
from vines.model import START_NAMES, Parameters, Params
from vines.pipeline import Kind
from vines.stages.kinds._family import HarvestLaw, of_systems
from vines.stages.kinds._parameters import PARAMETERS
from vines.stages.kinds._simulation import check_length

__all__ = ["KIND", "BasinsOptions", "FamilyBasinsOptions", "FamilyGrid", "Grid"]


if TYPE_CHECKING:
    _Coordinate = str
else:
    _Coordinate = Literal[START_NAMES]


MOST_CELLS = 10_000_000
"""Cells of a grid: days of computing, and as much memory as a machine has."""


class Grid(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A coordinate of the start with evenly spaced values, `from` and `to` included."""

    name: Annotated[_Coordinate, Meta(description="Which coordinate")]
    start: Annotated[float, Meta(description="The first value")] = msgspec.field(name="from")
    stop: Annotated[float, Meta(description="The last value")] = msgspec.field(name="to")
    count: Annotated[int, Meta(ge=2, description="How many")] = 100


Refine = Annotated[int, Meta(ge=0, description="How often cells at a boundary are halved in both directions")]
SettleAll = Annotated[
    int, Meta(ge=1, description="Forcing periods after which a start that came to no known orbit is classified")
]
PatienceOfAll = Annotated[
    int,
    Meta(
        ge=1,
        description="Forcing periods after which a start is called unsettled, and so is chaos that ends sooner",
    ),
]
WatchAll = Annotated[int, Meta(ge=16, description="Forcing periods more before a Lyapunov exponent is believed")]


class BasinsOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """To which attractor each start of a grid over the coordinates `x` and `y` comes, the others as in `start`."""

    x: Annotated[Grid, Meta(description="Coordinate of the start along the grid")]
    y: Annotated[Grid, Meta(description="Coordinate of the start across the grid")]
    start: Annotated[
        dict[str, float], Meta(description="Values of the other coordinates; 0 where nothing is said")
    ] = {}
    refine: Refine = 0
    settle: SettleAll = 256
    patience: PatienceOfAll = 4000
    watch: WatchAll = 128


class FamilyGrid(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A coordinate of the start with evenly spaced values, `from` and `to` included."""

    name: Annotated[str, Meta(description="Which coordinate of the system, or phase")]
    start: Annotated[float, Meta(description="The first value")] = msgspec.field(name="from")
    stop: Annotated[float, Meta(description="The last value")] = msgspec.field(name="to")
    count: Annotated[int, Meta(ge=2, description="How many")] = 100


class FamilyBasinsOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """To which attractor each start of a grid over the coordinates `x` and `y` comes, the others as in `start`."""

    system: str
    x: Annotated[FamilyGrid, Meta(description="Coordinate of the start along the grid")]
    y: Annotated[FamilyGrid, Meta(description="Coordinate of the start across the grid")]
    start: Annotated[
        dict[str, float | list[float]], Meta(description="Values of the other coordinates; 0 where nothing is said")
    ] = {}
    refine: Refine = 0
    settle: SettleAll = 256
    patience: PatienceOfAll = 4000
    watch: WatchAll = 128
    harvest: Annotated[HarvestLaw | None, Meta(description="What impacts yield, for the harvested power")] = None


def _check(params: dict[str, float], options: BasinsOptions) -> None:
    Params(**params)
    check_length(msgspec.structs.asdict(options))
    _check_grid(options, START_NAMES)
    for name in options.start:
        if name not in START_NAMES:
            raise ParameterError(f"unknown coordinate {name!r} in start: {nearest(name, START_NAMES)}")


def _check_grid(options: BasinsOptions | FamilyBasinsOptions, known: Collection[str]) -> None:
    """Refuse more cells than a machine can do, and a grid over anything but two coordinates."""
    cells = options.x.count * options.y.count
    if cells > MOST_CELLS:
        raise ParameterError(f"x and y make {cells} cells, allowed are {MOST_CELLS} before they are halved")
    names = {options.x.name, options.y.name}
    for name in names:
        if name not in known:
            raise ParameterError(f"unknown coordinate {name!r} of the grid: {nearest(name, known)}")
    if len(names) < 2 or names & set(options.start):
        raise ParameterError(f"x is {options.x.name}, y is {options.y.name}: give two coordinates, not again in start")


def _check_family(p: Parameters, options: FamilyBasinsOptions) -> None:
    _check_grid(options, [each.name for each in p.system.start])


_VI_NES = Kind(
    name="basins",
    summary="to which attractor each start of a grid comes, and the attractors that coexist",
    shape="whole",
    options=BasinsOptions,
    body="vines.stages.bodies._basins:compute",
    tables=("attractors", "basins"),
    parameters=PARAMETERS,
    check=_check,
    kernels=("one_run", "lanes", "runs", "many_runs"),
    again="starts",
)

KIND = of_systems(
    _VI_NES,
    ("cubic_barriers", "drag", "duffing", "friction", "hybrid", "impact_pair", "modes", "parallel"),
    FamilyBasinsOptions,
    "vines.stages.bodies._family_basins:compute",
    ("attractors", "basins"),
    _check_family,
)
