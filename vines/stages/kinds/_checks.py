"""Checks that several kinds of stages share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vines.errors import DeclarationError

if TYPE_CHECKING:
    from vines.pipeline import Stage

__all__ = ["check_axes"]


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
