"""Options for the parameters of the model, as it declares them."""

from __future__ import annotations

import re
from typing import Any

import click

from vines.cli._finite import finite
from vines.model import VI_NES, Parameter, System, counted, read_system

__all__ = ["OfSystem"]

_SYSTEM = "--system"
_UNSTRUCK = re.compile(r"-(/\d*T)?")
_NUMBERED = re.compile(r"--[a-zA-Z]+_([1-9])(=.*)?")


class OfSystem(click.Command):
    """A command with an option for each parameter of the system that ``--system`` names, called as the parameter is.

    Parameters without default are required. Balls and modes are counted by the options given: ``--mu_2``
    is of a second one.
    """

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the system first, since options are those of its parameters."""
        ctx.meta[_SYSTEM] = VI_NES if ctx.resilient_parsing else _declared(args)
        # A word of no impacts looks like an option: its type is the same.
        args = ["0:0" + each[1:] if _UNSTRUCK.fullmatch(each) else each for each in args]
        return super().parse_args(ctx, args)

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """Return the argument, an option for each parameter, and the other options."""
        argument, *others = super().get_params(ctx)
        return [argument, *map(_option, ctx.meta[_SYSTEM].parameters), *others]


def _declared(args: list[str]) -> System:
    """Return the system that arguments name, the VI-NES if none.

    Raises
    ------
    UnknownNameError
        If there is no such system; the message names the nearest.
    """
    name = VI_NES.name
    for word, after in zip(args, [*args[1:], ""], strict=True):
        if word == _SYSTEM or word.startswith(f"{_SYSTEM}="):
            name = after if word == _SYSTEM else word.partition("=")[2]
    if name == VI_NES.name:
        return VI_NES
    count = max((int(found[1]) for word in args if (found := _NUMBERED.fullmatch(word))), default=1)
    return read_system(name, min(count, counted(name)[1]))


def _option(each: Parameter) -> click.Option:
    # a default of None would be taken for one, and the option not be asked for
    default: dict[str, Any] = {} if each.default is None else {"default": each.default}
    return click.Option(
        [f"--{each.name}", each.name],
        type=float,
        callback=finite,
        required=each.default is None,
        show_default=True,
        help=f"{each.text}.",
        **default,
    )
