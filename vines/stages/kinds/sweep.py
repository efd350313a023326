"""The kind ``sweep``: the settled attractor of each point of a grid."""

from __future__ import annotations

from typing import Literal

import msgspec

from vines.pipeline import Kind
from vines.stages.kinds._parameters import PARAMETERS
from vines.stages.kinds._simulation import Start, check_simulation

__all__ = ["KIND", "SweepOptions"]


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


def _kernels(options: SweepOptions, carried: bool) -> tuple[str, ...]:
    # Lanes run the points that do not wait for each other, and random starts.
    alone = carried and not options.random
    return ("one_run",) if alone else ("one_run", "lanes", "many_runs")


KIND = Kind(
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
