"""What kinds are for the systems beside the VI-NES: their parameters, starts, tables and code."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from vines.errors import ParameterError
from vines.model import VI_NES, System, read_system, word_for
from vines.pipeline import Kind
from vines.schema import OF_EACH_SYSTEM, system_table
from vines.stages.kinds._simulation import Bare, InLog, Keep, PerPeriod, Record, Settle, Watch, check_length
from vines.systems import Harvest, parameters

__all__ = [
    "FamilyBranchOptions",
    "FamilySweepOptions",
    "FamilyTrajectoryOptions",
    "FamilyTransientOptions",
    "HarvestLaw",
    "of_systems",
]


Start = Annotated[
    dict[str, float | list[float]],
    Meta(description="Start by the names of the system; what is left out is as it declares"),
]


class HarvestLaw(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What an impact yields: the sum of c_k |w'|^k from a threshold of |w'| on."""

    coefficients: Annotated[tuple[float, ...], Meta(min_length=1, description="c_0, c_1, …")]
    threshold: Annotated[float, Meta(ge=0, description="Impact speed below which nothing is yielded")] = 0.0


class FamilySweepOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The settled attractor of each point: `settle` periods, then `record` periods that are classified and measured."""

    system: str
    start: Start = {}
    settle: Settle = 400
    record: Record = 64
    watch: Watch = 512
    keep: Keep = 64
    harvest: Annotated[HarvestLaw | None, Meta(description="What impacts yield, for the harvested power")] = None


class FamilyTrajectoryOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One run of the simulator: `settle` periods unrecorded, then `record` periods into an MCAP log."""

    system: str
    start: Start = {}
    settle: Settle = 400
    record: InLog = 10
    per_period: PerPeriod = 200
    bare: Bare = True


class FamilyTransientOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One run from v1 = V without forcing: shares of the energy that are lost and left, and times until little is left.

    The balls start as `start` says, at rest in the middle if nothing is said.
    """

    system: str
    start: Start = {}
    periods: Annotated[int, Meta(ge=1, le=1_000_000, description="Periods 2 pi to run")] = 100


class FamilyBranchOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The family of periodic orbits of one word that `find_orbit` chooses at the start of the range, to its end."""

    system: str
    word: Annotated[str, Meta(description="Word of the impacts, such as LR")]
    points: Annotated[
        int,
        Meta(ge=2, description="Evenly spaced values of the parameter that have an orbit on every sheet of a branch"),
    ] = 400
    harvest: Annotated[HarvestLaw | None, Meta(description="What impacts yield, for the harvested power")] = None


def of_systems(
    kind: Kind, systems: Iterable[str], options: type[msgspec.Struct], body: str, tables: tuple[str, ...]
) -> Kind:
    """Return a kind that can do other systems too.

    Parameters
    ----------
    kind : Kind
        What it is for the VI-NES.
    systems : iterable of str
        The systems.
    options : type of msgspec.Struct
        Its options there, with the field ``system``.
    body : str
        As of `Kind`.
    tables : tuple of str
        Its tables as the VI-NES calls them.
    """

    def make(system: str, balls: int) -> Kind:
        return replace(
            kind,
            options=options,
            body=body,
            tables=tuple(system_table(system, name) if name in OF_EACH_SYSTEM else name for name in tables),
            parameters=_parameters(kind, read_system(system, balls)),
            check=_check,
            code=_code,
            kernels=(),
            again=kind.again if kind.again == "points" else "",
            systems={},
            system=system,
            balls=balls,
        )

    return replace(kind, systems={system: partial(make, system) for system in systems})


def _parameters(kind: Kind, system: System) -> dict[str, float | None]:
    """Return the parameters of a system, without what the kind leaves out and with what it has beside those of one."""
    own = {each.name for each in VI_NES.parameters}
    found = {each.name: each.default for each in system.parameters if each.name not in own - set(kind.parameters)}
    return found | {name: default for name, default in kind.parameters.items() if name not in own}


def _check(params: dict[str, float], options: Any) -> None:
    """Refuse parameters, starts, words and laws that the system cannot have."""
    given = dict(params)
    if given.pop("V", None) is not None:
        if params["V"] == 0:
            raise ParameterError("V is 0, allowed is V != 0: it is the velocity that decays")
        given["A"] = 0.0
    p = parameters(options.system).of(given)
    values = msgspec.structs.asdict(options)
    if "word" in values:
        word_for(values["word"], p.system)
    if values.get("harvest") is not None:
        Harvest(options.harvest.threshold, options.harvest.coefficients)
    check_length(values)
    p.system.started(values.get("start", {}))


def _code(options: Any) -> tuple[str, ...]:
    """Return where the system's kernels and parameters are: they are looked up by its name, which no import shows."""
    form = parameters(options.system)
    return (f"vines.dynamics.{options.system}:ROOM", f"{form.__module__}:{form.__name__}")
