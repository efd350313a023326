"""All systems by name."""

from __future__ import annotations

import importlib

from vines.model import Parameters, with_one_ball
from vines.model import system_names as names

__all__ = ["names", "parameters"]


def parameters(name: str) -> type[Parameters]:
    """Return the class of the parameters of a system.

    Raises
    ------
    UnknownNameError
        If there is no such system; the message names the nearest.

    Examples
    --------
    >>> parameters("impact_pair").__name__
    'ImpactPair'
    """
    declared = with_one_ball(name)
    package, _, form = declared.parameters_of.partition(":")
    return getattr(importlib.import_module(package), form)
