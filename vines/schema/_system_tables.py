"""Tables that each system beside the VI-NES has of its own, made from the files of those of the VI-NES."""

from __future__ import annotations

import functools
import tomllib
from typing import Any

from vines.model import VI_NES, System, system_names, with_all_balls
from vines.places import shipped
from vines.schema._columns import Column, Table
from vines.schema._declared import expand

__all__ = ["OF_EACH_SYSTEM", "of_system", "of_systems", "system_table"]

OF_EACH_SYSTEM = (
    "attractors", "basins", "bifurcations", "branches", "curves", "exit_points", "exit_regimes", "exits", "impacts",
    "orbits", "points", "transients",
)  # fmt: skip
"""Tables that every system has: the VI-NES under these names, another one with its name before them."""

WITH_SCATTER = ("impact_pair",)
"""Systems beside the VI-NES whose runs can have noise."""


@functools.cache
def of_systems() -> dict[str, tuple[str, str]]:
    """Return the tables that each system beside the VI-NES has of its own, with the table each is like."""
    others = [name for name in system_names() if name != VI_NES.name]
    return {f"{system}_{base}": (system, base) for system in others for base in _tables_of(system)}


def _tables_of(system: str) -> list[str]:
    """Return the tables that a system has: only what has a damper of its own decays, and few can have scatter."""
    decays = "damper_loss" in with_all_balls(system).energies.lost
    none = set() if decays else {"transients"}
    none |= set() if system in WITH_SCATTER else {"exit_points", "exit_regimes", "exits"}
    return [base for base in OF_EACH_SYSTEM if base not in none]


def system_table(system: str, base: str) -> str:
    """Return what a table of :data:`OF_EACH_SYSTEM` is called for a system.

    Examples
    --------
    >>> system_table("vi_nes", "points"), system_table("impact_pair", "points")
    ('points', 'impact_pair_points')
    """
    return base if system == VI_NES.name else f"{system}_{base}"


def of_system(name: str) -> Table:
    """Return a table like one of the VI-NES: with the names of the system, and what every other system has beside."""
    called, base = of_systems()[name]
    system = with_all_balls(called)
    folder = shipped("schemas")
    form = tomllib.loads((folder / f"{base}.toml").read_text("utf-8"))
    more = folder / "systems" / "columns" / f"{base}.toml"
    entries = [*form["columns"], *(tomllib.loads(more.read_text("utf-8"))["columns"] if more.exists() else ())]
    # what only some systems have says which
    entries = [each for each in entries if called in each.pop("only", (called,))]
    # a coordinate may be called as a column that the common table has anyhow
    expanded = [each for entry in entries for own in _of_balls(entry, system) for each in expand(own, system)]
    columns = {each["name"]: each for each in reversed(expanded)}
    kept = [each for each in reversed(columns.values()) if each["name"] not in system.without]
    about = f"Of the system {called}: {form['description'][:1].lower()}{form['description'][1:]}"
    return Table(name, about, form["version"], tuple(Column(**each) for each in kept), True, called)


def _of_balls(entry: dict[str, Any], system: System) -> list[dict[str, Any]]:
    """Return an entry, one a ball or a mode where it is there for each, none where its parameter is not there."""
    entry = dict(entry)
    if entry.pop("beside", None) not in (None, *(each.name for each in system.parameters)):
        return []
    if "each" not in entry:
        return [entry]
    rest = {key: value for key, value in entry.items() if key != "each"}
    what = entry["each"]
    return [
        rest | {"name": f"{rest['name']}_{number}", "description": f"{rest['description']}, {what} {number}"}
        for number in range(1, (system.modes if what == "mode" else system.balls) + 1)
    ]
