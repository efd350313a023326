"""From what the science returns to rows of the tables of a system beside the VI-NES."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from vines import schema
from vines.attractors import APART
from vines.dynamics import Measures, ball_locked, no_ball
from vines.model import Parameters
from vines.orbits import orbit_outline
from vines.stages.bodies._coexisting import attractor_rows
from vines.stages.bodies._rows import measured_outline, measured_row
from vines.stages.bodies._sweep import representative
from vines.systems import Harvest, parameters

if TYPE_CHECKING:
    from vines.attractors import Attractor
    from vines.orbits import Orbit
    from vines.stages.kinds._family import HarvestLaw

__all__ = [
    "family_attractors",
    "family_impacts",
    "family_orbit",
    "family_outline",
    "family_point",
    "only_own",
    "parameters_of",
    "start_of",
]


def parameters_of(system: str, values: Mapping[str, float]) -> Parameters:
    """Return parameters of a system from their flat names."""
    return parameters(system).of(values)


def start_of(p: Parameters, declared: Mapping[str, Any], before: Mapping[str, Any] | None) -> dict[str, float]:
    """Return the start of a point: as it is declared, or where the point of a row ended that goes before it.

    Balls that would start alike and so move as one for ever start `APART`, as `vines.settle` does.
    """
    start = p.system.started(declared)
    if before is not None:
        return {name: float(before[f"end_{name}"]) for name in start}
    for group in getattr(p, "together", ()):
        states = [(start[f"x2_{ball}"], start[f"v2_{ball}"]) for ball in group]
        for place, ball in enumerate(group):
            start[f"v2_{ball}"] += APART * states[:place].count(states[place])
    return start


def family_point(
    point_id: str,
    attractor: Attractor,
    start: dict[str, float],
    carry: str | None,
    law: HarvestLaw | None,
    seed: int | None = None,
) -> dict[str, Any]:
    """Return the row of the system's ``points`` for one simulated point.

    Parameters
    ----------
    point_id : str
        Id of the point.
    attractor : Attractor
        What the simulation settled to.
    start : dict
        Start of the run: the coordinates of the system and the phase of the forcing [rad].
    carry : str or None
        The carried axis.
    law : HarvestLaw or None
        What impacts yield.
    seed : int, optional
        With which the start was drawn, if it was.
    """
    return only_own(
        attractor.params,
        "points",
        family_outline(attractor, law) | measured_row(point_id, attractor, start, carry=carry, before=0, seed=seed),
    )


def family_outline(attractor: Attractor, law: HarvestLaw | None) -> dict[str, Any]:
    """Return what every table of attractors of a system tells of one; some of it may be of other systems only."""
    repeats = attractor.settled and bool(attractor.p)
    periods = float(attractor.p or 0) if repeats else attractor.recorded
    hits = representative(attractor, 0)[:-1] if repeats else attractor.impacts
    return (
        measured_outline(attractor)
        | _powers(attractor.measures, hits, periods * attractor.params.period, law)
        | _of_balls(attractor.measures)
        | _yardsticks(attractor.params, attractor.measures)
    )


def family_attractors(
    point_id: str, found: list[tuple[Attractor, int]], random: int, law: HarvestLaw | None
) -> list[dict[str, Any]]:
    """Return rows of the system's ``attractors`` for one point, as `attractor_rows`."""
    rows = attractor_rows(point_id, found, random, partial(family_outline, law=law))
    return [only_own(attractor.params, "attractors", row) for (attractor, _), row in zip(found, rows, strict=True)]


def family_orbit(orbit: Orbit, branch_id: str | None, law: HarvestLaw | None) -> dict[str, Any]:
    """Return the row of the system's ``orbits``; what each impact has is a list."""
    p = orbit.params
    lists = {name: values.tolist() for name, values in _at_impacts(orbit.impacts).items()}
    powers = _powers(orbit.measures, orbit.impacts, orbit.period, law) | _of_balls(orbit.measures)
    values = orbit_outline(orbit, branch_id) | lists | powers | _yardsticks(p, orbit.measures)
    return only_own(p, "orbits", values)


def family_impacts(point_id: str, p: Parameters, impacts: np.ndarray, number: int = 0) -> list[dict[str, Any]]:
    """Return rows of the system's ``impacts`` of one attractor; the last has no successor and is left out."""
    kept = impacts[:-1]
    columns = _at_impacts(kept) | {"index": np.arange(len(kept)), "dt_next": np.diff(impacts["t"])}
    lists = {name: values.tolist() for name, values in columns.items()}
    fixed = {"point_id": point_id, **p.as_dict(), "attractor": number, "ball": 0}
    return [
        only_own(p, "impacts", fixed | dict(zip(lists, row, strict=True))) for row in zip(*lists.values(), strict=True)
    ]


def _at_impacts(impacts: np.ndarray) -> dict[str, np.ndarray]:
    """Return what is known of impacts, under all names that systems may have for it."""
    found = {name: impacts[name] for name in impacts.dtype.names or ()}
    # a gap that is a coordinate is one of a cavity of half length 1: x1 - x2 would be beyond its wall by rounding
    return found | {"w": impacts["side"].astype(np.float64)}


def _powers(measures: Measures, hits: np.ndarray, duration: float, law: HarvestLaw | None) -> dict[str, Any]:
    """Return the mean power of the impacts, and what of it the law harvests on each side."""
    ties = getattr(measures, "ties", 0)
    # a run that the cap on events ended has no window
    power = measures.impact_loss / measures.duration if measures.duration > 0 else None
    travel = measures.travel_loss / measures.duration if measures.duration > 0 else None
    found: dict[str, Any] = {"impact_power": power, "ties": ties}
    if measures.duration > 0:
        found["viscous_power"] = getattr(measures, "viscous_loss", 0.0) / measures.duration
    # by the name that the system has for it, if for any
    found |= dict.fromkeys(("electric_power", "friction_power"), travel)
    if law is not None:
        energy = Harvest(law.threshold, law.coefficients).energy(hits["w_dot"])
        found["harvested_left"] = float(energy[hits["side"] > 0].sum()) / duration
        found["harvested_right"] = float(energy[hits["side"] < 0].sum()) / duration
    return found


def _of_balls(measures: Measures) -> dict[str, float | None]:
    """Return what is told of each ball or each mode, where they have numbers, and of a ball and the mass beside it."""
    of_both = ("kinetic_ratio_ball", "kinetic_ratio_mass")
    found: dict[str, float | None] = {name: getattr(measures, name, None) for name in of_both}
    for number, each in enumerate(getattr(measures, "balls", ()), start=1):
        found[f"kinetic_ratio_{number}"] = each.kinetic_ratio
        loss = each.impact_loss_left + each.impact_loss_right
        found[f"impact_power_{number}"] = loss / measures.duration if measures.duration > 0 else None
    for number, each in enumerate(getattr(measures, "modes", ()), start=1):
        found[f"modal_energy_{number}"] = each.kinetic + each.potential if measures.duration > 0 else None
        found[f"modal_loss_{number}"] = each.damper_loss / measures.duration if measures.duration > 0 else None
    return found


def _yardsticks(p: Any, measures: Measures) -> dict[str, float | None]:
    """Return what the displacement is compared with, where the frame is not driven itself."""
    if "x1_no_ball" in p.system.without:
        return {}
    free = no_ball(p)
    reduction = measures.max_abs_x1 / free if free > 0 else None
    return {"x1_no_ball": free, "x1_locked": ball_locked(p), "reduction": reduction}


def only_own(p: Parameters, base: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the system's table has columns for."""
    names = set(schema.table(schema.system_table(p.system.name, base)).names)
    return {name: value for name, value in values.items() if name in names}
