"""What a stored result is of: its kind for its system, and the parameters and words of its rows."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from vines import schema
from vines.model import VI_NES, Params, with_all_balls
from vines.pipeline import Kind, kind
from vines.systems import parameters

if TYPE_CHECKING:
    from vines.store import Result

__all__ = ["base_of", "kind_of", "parameters_of_row", "start_names", "system_of"]


def base_of(table: str) -> str:
    """Return what the VI-NES calls a table that a system has of its own.

    Examples
    --------
    >>> base_of("parallel_points"), base_of("basins")
    ('points', 'basins')
    """
    system = schema.table(table).system
    return table if system == VI_NES.name else table.removeprefix(f"{system}_")


def system_of(result: Result) -> str:
    """Return the name of the system that a result is of."""
    return result.manifest["ingredients"]["options"].get("system", VI_NES.name)


def kind_of(result: Result) -> Kind:
    """Return the kind of a result as it is for its system."""
    form: Any = result.manifest["ingredients"]
    spec, system = kind(result.manifest["kind"]), system_of(result)
    names = [*form["params"], *(axis[0] for axis in form["vary"]), *form.get("link", ())]
    numbers = [int(name.rpartition("_")[2]) for name in names if name.rpartition("_")[2].isdecimal()]
    return spec.of_system(system, max(numbers, default=0))


def parameters_of_row(system: str, row: Mapping[str, Any]) -> Any:
    """Return the parameters of a row; of balls that it has none of the columns are empty."""
    known = [each.name for each in with_all_balls(system).parameters]
    given = {name: row[name] for name in known if row.get(name) is not None}
    return Params(**given) if system == VI_NES.name else parameters(system).of(given)


def start_names(row: Mapping[str, Any]) -> list[str]:
    """Return the coordinates, phase included, that a row of points has at its start and at its end."""
    names = [name.removeprefix("end_") for name in row if name.startswith("end_")]
    return [name for name in names if isinstance(row[name], float) and math.isfinite(row[name])]
