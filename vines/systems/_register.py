"""All systems by name."""

from __future__ import annotations

import importlib

from vines.model import Parameters, most_balls, read_system, system_names

__all__ = ["names", "parameters"]


def names() -> tuple[str, ...]:
    """Return the names of all systems, the vibro-impact nonlinear energy sink among them.

    Examples
    --------
    >>> names()
    ('impact_pair', 'parallel', 'vi_nes')
    """
    return system_names()


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
