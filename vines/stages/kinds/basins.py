"""The kind ``basins``: to which attractor each start of a grid comes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import msgspec
from msgspec import Meta

from vines.errors import ParameterError, nearest
from vines.model import START_NAMES, Params
from vines.pipeline import Kind
from vines.stages.kinds._parameters import PARAMETERS
from vines.stages.kinds._simulation import check_length

__all__ = ["KIND", "BasinsOptions", "Grid"]


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


class BasinsOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """To which attractor each start of a grid over the coordinates `x` and `y` comes, the others as in `start`."""

    x: Annotated[Grid, Meta(description="Coordinate of the start along the grid")]
    y: Annotated[Grid, Meta(description="Coordinate of the start across the grid")]
    start: Annotated[
        dict[str, float], Meta(description="Values of the other coordinates; 0 where nothing is said")
    ] = {}
    refine: Annotated[int, Meta(ge=0, description="How often cells at a boundary are halved in both directions")] = 0
    settle: Annotated[
        int, Meta(ge=1, description="Forcing periods after which a start that came to no known orbit is classified")
    ] = 256
    patience: Annotated[
        int,
        Meta(
            ge=1,
            description="Forcing periods after which a start is called unsettled, and so is chaos that ends sooner",
        ),
    ] = 4000
    watch: Annotated[int, Meta(ge=16, description="Forcing periods more before a Lyapunov exponent is believed")] = 128


def _check(params: dict[str, float], options: BasinsOptions) -> None:
    Params(**params)
    check_length(msgspec.structs.asdict(options))
    cells = options.x.count * options.y.count
    if cells > MOST_CELLS:
        raise ParameterError(f"x and y make {cells} cells, allowed are {MOST_CELLS} before they are halved")
    names = {options.x.name, options.y.name}
    if len(names) < 2 or names & set(options.start):
        raise ParameterError(f"x is {options.x.name}, y is {options.y.name}: give two coordinates, not again in start")
    for name in options.start:
        if name not in START_NAMES:
            raise ParameterError(f"unknown coordinate {name!r} in start: {nearest(name, START_NAMES)}")


KIND = Kind(
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
