"""Checks that several kinds of stages share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from vines.errors import DeclarationError, ParameterError

if TYPE_CHECKING:
    from vines.pipeline import Stage

__all__ = ["check_axes", "check_least"]


def check_least(values: Mapping[str, int], limits: Mapping[str, int]) -> None:
    """Refuse numbers that are less than their limits, in the order of the limits.

    Raises
    ------
    ParameterError
        With the first of them.
    """
    for name, least in limits.items():
        if values[name] < least:
            raise ParameterError(f"{name} is {values[name]}, allowed is {name} >= {least}")


def check_axes(stage: Stage, count: int, text: str, remedy: str) -> None:
    """Refuse a stage that does not vary `count` parameters.

    Raises
    ------
    DeclarationError
        With what it varies, after `text` and before `remedy`.
    """
    if len(stage.axes) != count:
        names = ", ".join(axis.name for axis in stage.axes) or "nothing"
        raise DeclarationError(f"{text}, this one varies {names}; {remedy}")
