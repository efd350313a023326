"""What kinds are for the systems beside the VI-NES: their parameters, starts, tables and code."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from vines.errors import ParameterError
from vines.model import VI_NES, Parameters, System, read_system, word_for
from vines.pipeline import Kind
from vines.schema import OF_EACH_SYSTEM, system_table
from vines.stages.kinds._simulation import (
    Bare,
    InLog,
    Keep,
    LargestP,
    PerPeriod,
    Random,
    Record,
    Seed,
    Settle,
    Watch,
    check_length,
)
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
    """The settled attractor of each point: `settle` periods, then `record` periods that are classified and measured.

    A start may be "random", which draws it at each point. The table ``SYSTEM_attractors`` lists every attractor that
    random starts come to beside the point's own.
    """

    system: str
    start: Annotated[
        dict[str, float | list[float]] | Literal["random"],
        Meta(
            description="Start by the names of the system; what is left out is as it declares; or 'random' to draw it "
            "at each point"
        ),
    ] = {}
    settle: Settle = 400
    record: Record = 64
    watch: Watch = 512
    largest_p: LargestP = msgspec.UNSET
    keep: Keep = 64
    random: Random = 0
    seed: Seed = 0
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
    """Families of periodic orbits of one word, followed in the varied parameter.

    `families = "one"` follows the orbit that `find_orbit` chooses at the start of the range to its end, `"all"` every
    family that is found at one of `seeds` values of the parameter.
    """

    system: str
    word: Annotated[str, Meta(description="Word of the impacts, such as LR")]
    points: Annotated[
        int,
        Meta(ge=2, description="Evenly spaced values of the parameter that have an orbit on every sheet of a branch"),
    ] = 400
    families: Annotated[Literal["one", "all"], Meta(description="Which families are followed")] = "one"
    seeds: Annotated[int, Meta(ge=2, description="Values of the parameter at which families are sought")] = 13
    switch: Annotated[
        int, Meta(ge=0, description="Generations followed out of symmetry breakings and period doublings")
    ] = 0
    harvest: Annotated[HarvestLaw | None, Meta(description="What impacts yield, for the harvested power")] = None


def of_systems(
    kind: Kind,
    systems: Iterable[str],
    options: type[msgspec.Struct],
    body: str,
    tables: tuple[str, ...],
    more: Callable[[Parameters, Any], None] | None = None,
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
    more : callable, optional
        ``more(p, options)`` refuses what parameters and start alone do not show.
    """

    def make(system: str, balls: int) -> Kind:
        return replace(
            kind,
            options=options,
            body=body,
            tables=tuple(system_table(system, name) if name in OF_EACH_SYSTEM else name for name in tables),
            parameters=_parameters(kind, read_system(system, balls)),
            check=partial(_check, more),
            code=_code,
            kernels=(),
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


def _check(more: Callable[[Parameters, Any], None] | None, params: dict[str, float], options: Any) -> None:
    """Refuse parameters, starts, words and laws that the system cannot have."""
    given = {name: value for name, value in params.items() if name != "level"}
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
    if values.get("start") != "random":
        p.system.started(values.get("start", {}))
    if more is not None:
        more(p, options)


def _code(options: Any) -> tuple[str, ...]:
    """Return where the system's kernels and parameters are: they are looked up by its name, which no import shows."""
    form = parameters(options.system)
    return (f"vines.dynamics.{options.system}:ROOM", f"{form.__module__}:{form.__name__}")
