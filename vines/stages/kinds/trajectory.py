"""The kind ``trajectory``: one run of the simulator."""

from __future__ import annotations

import msgspec

from vines.pipeline import Kind
from vines.stages.kinds._parameters import PARAMETERS
from vines.stages.kinds._simulation import Start, check_simulation

__all__ = ["KIND", "TrajectoryOptions"]


class TrajectoryOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One run of the simulator: `settle` periods unrecorded, then `record` periods into an MCAP log.

    With `bare` the log also carries what a viewer without vines understands (docs/logs.md).
    """

    start: Start = msgspec.field(default_factory=Start)
    settle: int = 400
    record: int = 10
    per_period: int = 200
    bare: bool = True


KIND = Kind(
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
    check=check_simulation,
    kernels=("one_run", "runs"),
    again="points",
)
