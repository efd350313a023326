"""All systems by name."""

from __future__ import annotations

import importlib

from vines.model import Parameters, most_balls, read_system
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
    declared = read_system(name, min(most_balls(name), 1))
    package, _, form = declared.parameters_of.partition(":")
    return getattr(importlib.import_module(package), form)
