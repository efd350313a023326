"""Kinds that evaluate formulas: the multiple-scales reduction, a rig in SI units made dimensionless."""

from __future__ import annotations

from typing import Any

import msgspec

from vines.model import Params, PhysicalParams
from vines.pipeline import Kind, register
from vines.stages.kinds._parameters import PARAMETERS, TABLE_1

__all__ = ["DimensionlessOptions", "ReducedOptions", "register_formulas"]


class ReducedOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The multiple-scales approximation of the symmetric 1:1 response beside the exact orbit; nothing to choose."""


class DimensionlessOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A rig in SI units, Table 1 of the paper by default, and its dimensionless parameters; nothing to choose."""


def _check_model(params: dict[str, float], options: Any) -> None:
    del options
    Params(**params)


def _check_rig(params: dict[str, float], options: Any) -> None:
    del options
    rig = PhysicalParams(**{name: params[name] for name in TABLE_1})
    rig.dimensionless(**{name: value for name, value in params.items() if name not in TABLE_1})


def register_formulas() -> None:
    """Make the kinds that evaluate formulas known to declarations."""
    register(
        Kind(
            name="reduced",
            summary="the multiple-scales approximation of the symmetric 1:1 response beside the exact orbit",
            shape="points",
            options=ReducedOptions,
            body="vines.stages.bodies._reduced:compute",
            tables=("reduced",),
            parameters=PARAMETERS,
            vary="grid",
            check=_check_model,
            kernels=("orbits",),
        )
    )
    register(
        Kind(
            name="dimensionless",
            summary="a rig in SI units and its dimensionless parameters",
            shape="points",
            options=DimensionlessOptions,
            body="vines.stages.bodies._dimensionless:compute",
            tables=("dimensionless",),
            parameters={**TABLE_1, "E": None, "omega": None, "m": None},
            vary="grid",
            check=_check_rig,
        )
    )
