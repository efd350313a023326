"""Columns that a table takes from the declaration of the system: its parameters, its state."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from vines.errors import SchemaError, nearest
from vines.model import VI_NES, Coordinate, Parameter, System

__all__ = ["expand", "names_of"]

_GROUPS = {"parameters": "parameters", "state": "met", "start": "start"}
"""Rows with a state are of impacts: it is that of the ball that hits."""


def names_of(group: str, system: System = VI_NES) -> tuple[str, ...]:
    """Return the names in a group of the declaration of a system.

    Examples
    --------
    >>> names_of("start")
    ('x1', 'v1', 'x2', 'v2', 'phase')

    Raises
    ------
    SchemaError
        If there is none of that name.
    """
    return tuple(each.name for each in _group(group, system))


def _group(group: str, system: System) -> tuple[Parameter, ...] | tuple[Coordinate, ...]:
    if group not in _GROUPS:
        raise SchemaError(f"unknown group {group!r} of columns: {nearest(group, _GROUPS)}")
    return getattr(system, _GROUPS[group])


def expand(form: Mapping[str, Any], system: System = VI_NES) -> list[dict[str, Any]]:
    """Return the columns that an entry of a table's file stands for: itself, or those of a group of a system.

    Parameters
    ----------
    form : mapping
        A column with ``values`` listed or those of a group (``values = "parameters"``); or ``of``, a group, with
        names to leave out (``without``), what to put before names (``prefix``) and after descriptions (``when``), and
        the type if it is not float64 (``dtype``).
    system : System
        Whose.

    Raises
    ------
    SchemaError
        If a group is unknown, or a key beside it.

    Examples
    --------
    >>> [column["name"] for column in expand({"of": "state", "prefix": "end_", "when": "at the end"})]
    ['end_x1', 'end_v1', 'end_x2', 'end_v2']
    """
    values = form.get("values", ())
    if "of" not in form:
        return [{**form, "values": names_of(values, system) if isinstance(values, str) else tuple(values)}]
    known = ("of", "without", "prefix", "when", "dtype")
    for key in form:
        if key not in known:
            raise SchemaError(f"unknown key {key!r} beside 'of': {nearest(key, known)}")
    return [_column(each, form) for each in _group(form["of"], system) if each.name not in form.get("without", ())]


def _column(each: Parameter | Coordinate, form: Mapping[str, Any]) -> dict[str, Any]:
    dtype = form.get("dtype", "float64")
    # Limits are for numbers, not for lists of them.
    ends = {"minimum": each.allowed.least, "maximum": each.allowed.most} if dtype == "float64" else {}
    return {
        "name": form.get("prefix", "") + each.name,
        "dtype": dtype,
        "unit": each.unit,
        "description": f"{each.text} {form.get('when', '')}".rstrip(),
        "source": each.source,
        "values": (),
        **{key: end for key, end in ends.items() if math.isfinite(end)},
    }
