"""Numbers of options that have to be finite: click takes nan and inf for numbers like others."""

from __future__ import annotations

import math

import click

__all__ = ["finite"]


def finite(context: click.Context, option: click.Parameter, value: float | None) -> float | None:
    """Refuse a number that is not finite; the callback of an option.

    Raises
    ------
    click.BadParameter
        If it is nan or infinite.
    """
    if value is not None and not math.isfinite(value):
        raise click.BadParameter(f"{value} is not a finite number.", context, option)
    return value
