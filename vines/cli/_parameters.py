"""Options for the parameters of the model, as it declares them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from vines.cli._finite import finite
from vines.model import VI_NES

__all__ = ["parameter_options"]


def parameter_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command an option for each parameter, called as the parameter is; those without default are required."""
    for each in reversed(VI_NES.parameters):
        # a default of None would be taken for one, and the option not be asked for
        default: dict[str, Any] = {} if each.default is None else {"default": each.default}
        command = click.option(
            f"--{each.name}",
            each.name,
            type=float,
            callback=finite,
            required=each.default is None,
            show_default=True,
            help=f"{each.text}.",
            **default,
        )(command)
    return command
