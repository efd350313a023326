"""The kind ``synth``: a synthetic campaign."""

from __future__ import annotations

from typing import Any

import msgspec

from vines.errors import ParameterError
from vines.pipeline import Kind
from vines.stages.kinds._seed import check_seed

__all__ = ["KIND", "SynthOptions"]


class SynthOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A synthetic campaign: a sweep of the base amplitude up and down with ring-downs between.

    `amplitudes` are A = E/b in rising order, `settings` those of the synthetic rig (docs/rig.md), `draw` draws its
    imperfections over their ranges, `warming` is the change of temperature over the campaign [K].
    """

    amplitudes: tuple[float, ...]
    seed: int = 0
    draw: bool = False
    warming: float = 0.0
    settings: dict[str, Any] = {}


def _check(params: dict[str, float], options: Any) -> None:
    del params
    if (
        not options.amplitudes
        or list(options.amplitudes) != sorted(set(options.amplitudes))
        or options.amplitudes[0] <= 0
    ):
        raise ParameterError(f"amplitudes are {list(options.amplitudes)}, allowed are positive numbers in rising order")
    check_seed(options)


KIND = Kind(
    name="synth",
    summary="run folders of a synthetic rig, a sweep up and down with ring-downs; their truth is sealed",
    shape="whole",
    options=SynthOptions,
    body="vines.stages.rig._synth:compute",
    tables=("rig_made",),
    check=_check,
)
