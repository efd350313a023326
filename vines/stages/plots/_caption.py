"""What captions say of parameters."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import TYPE_CHECKING

from vines.figures import SYMBOLS

if TYPE_CHECKING:
    from vines.pipeline import Input

__all__ = ["fixed", "listed", "shared_params"]


def listed(params: Mapping[str, float], between: str = ",  ") -> str:
    r"""Return parameters and their values as a caption has them.

    Examples
    --------
    >>> listed({"mu": 0.01, "A": 0.015})
    '$\\mu = 0.01$,  $A = 0.015$'
    """
    return between.join(f"${SYMBOLS.get(name, name)} = {value:.4g}$" for name, value in params.items())


def fixed(stage: Input, axes: Collection[str]) -> str:
    """Return the parameters of one stage but those along the axes, as the panels of maps have them."""
    return listed({name: value for name, value in stage.params.items() if name not in axes}, ", ")


def shared_params(stages: Iterable[Input]) -> dict[str, float]:
    """Return the parameters that all stages share."""
    first, *others = (stage.params for stage in stages)
    return {name: value for name, value in first.items() if all(other.get(name) == value for other in others)}
