"""From SI units to dimensionless parameters, by the formulas of a system's declaration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from vines.errors import ParameterError, nearest
from vines.model._expression import Expression
from vines.model._system import System

__all__ = ["dimensionless"]

_FUNCTIONS = {"sin": math.sin, "sqrt": math.sqrt}


def dimensionless(system: System, given: Mapping[str, Any]) -> dict[str, float]:
    """Return the dimensionless parameters that follow from quantities in SI units.

    Parameters
    ----------
    system : System
    given : mapping of str to float
        Quantities of the rig and of a run by their names, angles in degrees. Those of the rig that are left out have
        the values of the declaration.

    Returns
    -------
    dict of str to float
        Every parameter that something given takes part in and for which nothing is missing.

    Raises
    ------
    ParameterError
        If a name is unknown, a value out of range, or something given is of no use without what is missing.

    Examples
    --------
    >>> from vines.model import VI_NES
    >>> dimensionless(VI_NES, {"E": 0.3e-3, "m": 0.03807})
    {'mu': 0.01, 'A': 0.02}
    """
    known = {each.name: each for each in (*system.rig, *system.run)}
    formulas = {each.name: Expression(each.physical, _FUNCTIONS) for each in system.parameters if each.physical}
    useful = {name for formula in formulas.values() for name in formula.names}
    for name in given:
        if name not in useful:
            raise ParameterError(f"unknown quantity {name!r} in SI units: {nearest(name, useful)}")
    values = {name: each.default for name, each in known.items() if each.default is not None}
    values |= {name: known[name].check(value) for name, value in given.items()}
    numbers = {
        name: math.radians(value) if known[name].unit == "deg" else float(value) for name, value in values.items()
    }
    found: dict[str, float] = {}
    used: set[str] = set()
    for name, formula in formulas.items():
        if any(each in given for each in formula.names) and all(each in numbers for each in formula.names):
            found[name] = formula.value(numbers, float)
            used.update(formula.names)
    for name in given:
        if name not in used:
            missing = sorted({n for f in formulas.values() if name in f.names for n in f.names} - set(numbers))
            raise ParameterError(f"{name} alone gives no parameter; give {' and '.join(missing)} beside it")
    return found
