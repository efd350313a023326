"""The kind ``sweep``: the settled attractor of each point of a grid."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from vines.pipeline import Kind
from vines.stages.kinds._family import FamilySweepOptions, of_systems
from vines.stages.kinds._parameters import PARAMETERS
from vines.stages.kinds._simulation import Keep, LargestP, Random, Record, Seed, Settle, Start, Watch, check_simulation

__all__ = ["KIND", "SweepOptions"]


class SweepOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The settled attractor of each point: `settle` periods, then `record` periods that are classified and measured.

    The table ``attractors`` lists every attractor that random starts come to beside the point's own.
    """

    start: Annotated[
        Start | Literal["random"], Meta(description="Start state (dimensionless), or 'random' to draw it at each point")
    ] = msgspec.field(default_factory=Start)
    settle: Settle = 400
    record: Record = 64
    watch: Watch = 512
    largest_p: LargestP = msgspec.UNSET
    keep: Keep = 64
    random: Random = 0
    seed: Seed = 0


def _kernels(options: SweepOptions, carried: bool) -> tuple[str, ...]:
    # Lanes run the points that do not wait for each other, and random starts.
    alone = carried and not options.random
    return ("one_run",) if alone else ("one_run", "lanes", "many_runs")


_VI_NES = Kind(
    name="sweep",
    summary="the settled attractor, impacts and energy measures of each point of a grid",
    shape="points",
    options=SweepOptions,
    body="vines.stages.bodies._sweep:compute",
    tables=("points", "impacts", "attractors"),
    parameters=PARAMETERS,
    vary="grid",
    carry=True,
    check=check_simulation,
    kernels=_kernels,
    again="points",
)

KIND = of_systems(
    _VI_NES,
    ("cubic_barriers", "drag", "duffing", "friction", "hybrid", "impact_pair", "modes", "parallel"),
    FamilySweepOptions,
    "vines.stages.bodies._family_sweep:compute",
    ("points", "impacts", "attractors"),
)
