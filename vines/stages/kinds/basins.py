"""The kind ``basins``: to which attractor each start of a grid comes."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec

from vines.errors import ParameterError, nearest
from vines.model import START_NAMES, Params
from vines.pipeline import Kind
from vines.stages.kinds._checks import check_least
from vines.stages.kinds._parameters import PARAMETERS

__all__ = ["KIND", "BasinsOptions", "Grid"]


class Grid(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A coordinate of the start with evenly spaced values, `from` and `to` included."""

    name: Annotated[str, msgspec.Meta(extra_json_schema={"enum": list(START_NAMES)})]
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


def _check(params: dict[str, float], options: Any) -> None:
    Params(**params)
    names = {options.x.name, options.y.name}
    if len(names) < 2 or names & set(options.start):
        raise ParameterError(f"x is {options.x.name}, y is {options.y.name}: give two coordinates, not again in start")
    for name in (options.x.name, options.y.name, *options.start):
        if name not in START_NAMES:
            raise ParameterError(f"unknown coordinate {name!r} of the start: {nearest(name, START_NAMES)}")
    values = msgspec.structs.asdict(options) | {"count": min(options.x.count, options.y.count)}
    check_least(values, {"count": 2, "refine": 0, "settle": 1, "patience": 1, "watch": 16})


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
