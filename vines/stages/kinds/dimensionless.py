"""The kind ``dimensionless``: a rig in SI units made dimensionless."""

from __future__ import annotations

import msgspec

from vines.model import VI_NES, PhysicalParams
from vines.pipeline import Kind
from vines.stages.kinds._parameters import TABLE_1

__all__ = ["KIND", "DimensionlessOptions"]


class DimensionlessOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A rig in SI units, Table 1 of the paper by default, and its dimensionless parameters; nothing to choose."""


def _check(params: dict[str, float], options: DimensionlessOptions) -> None:
    del options
    rig = PhysicalParams(**{name: params[name] for name in TABLE_1})
    rig.dimensionless(**{name: value for name, value in params.items() if name not in TABLE_1})


KIND = Kind(
    name="dimensionless",
    summary="a rig in SI units and its dimensionless parameters",
    shape="points",
    options=DimensionlessOptions,
    body="vines.stages.bodies._dimensionless:compute",
    tables=("dimensionless",),
    parameters={**TABLE_1, **{each.name: each.default for each in VI_NES.run}},
    vary="grid",
    check=_check,
    again="points",
)
