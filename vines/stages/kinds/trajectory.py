"""The kind ``trajectory``: one run of the simulator."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from vines.pipeline import Kind
from vines.stages.kinds._family import FamilyTrajectoryOptions, of_systems
from vines.stages.kinds._parameters import PARAMETERS
from vines.stages.kinds._simulation import Bare, InLog, PerPeriod, Settle, Start, check_simulation

__all__ = ["KIND", "TrajectoryOptions"]


class TrajectoryOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One run of the simulator: `settle` periods unrecorded, then `record` periods into an MCAP log."""

    start: Annotated[Start, Meta(description="Start state (dimensionless)")] = msgspec.field(default_factory=Start)
    settle: Settle = 400
    record: InLog = 10
    per_period: PerPeriod = 200
    bare: Bare = True


_VI_NES = Kind(
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

KIND = of_systems(
    _VI_NES,
    ("cubic_barriers", "drag", "duffing", "friction", "hybrid", "impact_pair", "modes", "parallel"),
    FamilyTrajectoryOptions,
    "vines.stages.bodies._family_trajectory:compute",
    ("points", "impacts"),
)
