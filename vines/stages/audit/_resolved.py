"""Orbits solved again from a disturbed state, and flown by the simulator as a check of another kind."""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import simulate
from vines.dynamics.kernels import room_of
from vines.errors import OrbitNotFound
from vines.model import STATE_NAMES, VI_NES, Params, Word
from vines.orbits import Orbit, all_orbits, find_orbit, orbit_row, shoots
from vines.schema import system_table
from vines.stages.audit._compare import TOLERANCE, Comparison, compare_rows, stored_row
from vines.stages.audit._located import locate_again
from vines.stages.audit._systems import parameters_of_row, system_of
from vines.stages.bodies._family_rows import family_orbit
from vines.stages.kinds._family import HarvestLaw

if TYPE_CHECKING:
    from vines.store import Result

__all__ = ["resolve_again"]

_DISTURBED = 1e-6
"""Disturbance of the impact times from which an orbit is solved again, relative to the period."""
_ROUNDING = 1e-13
_UNSTABLE = 1e4
"""Largest multiplier up to which the simulator is asked to follow an orbit for a period."""
_FOLD = 1e-6
"""Multipliers so near to 1 are those of an orbit at a fold, which solutions near it approach as a square root."""
_MULTIPLIERS = ("multipliers_re", "multipliers_im", "max_multiplier", "stable")
_NAMES = ("point_id", "orbit_id", "branch_id", "violation_time")


def resolve_again(result: Result, table: str, place: int, rng: np.random.Generator) -> Comparison:
    """Solve the orbit of a row of a table of orbits again and compare everything that is stored of it.

    Near a bifurcation the solution is as sensitive as the multiplier is near 1, and what is allowed grows with that.
    Multipliers are compared by the coefficients of their polynomial, which are smooth where two of them meet. At a fold
    two orbits meet and none is isolated at these parameters: its row is located again, as the bifurcation that it is.
    """
    row, system = stored_row(result, table, place), system_of(result)
    if min(math.hypot(a - 1, b) for a, b in zip(row["multipliers_re"], row["multipliers_im"], strict=True)) < _FOLD:
        others = system_table(system, "bifurcations")
        places = _bifurcations_of(result, others, row["orbit_id"])
        return locate_again(result, others, places[0]) if places else Comparison()
    word, p = Word(row["word"]), parameters_of_row(system, row)
    t = np.array(row["t"])
    scale = _DISTURBED * word.p * p.period
    # The relative times are disturbed by less than a tenth of the shortest flight, so that their order stays.
    shortest = float(np.diff(t, append=t[0] + word.p * p.period).min())
    if word.sticking:
        orbit = _searched(word, p, t)
    elif p.system.stops:
        first = np.array([row["x1"][0], row["v1"][0], row["v2"][0], t[0]])
        orbit = _solve(word, p, first, rng.uniform(-1, 1, 4) * min(scale, 0.1 * shortest))
    else:
        disturbance = rng.uniform(-1, 1, len(t)) * min(scale, 0.1 * shortest)
        if shoots(p):
            t = np.column_stack([t, *(row[name] for name in _coordinates(p))])
            disturbance = np.pad(disturbance[:, None], ((0, 0), (0, t.shape[1] - 1)))
        orbit = _solve(word, p, t, disturbance)
    comparison = Comparison()
    m = np.array(row["multipliers_re"]) + 1j * np.array(row["multipliers_im"])
    finite = bool(np.isfinite(m).all())
    nearest = float(np.abs(m - 1).min()) if finite else 0.0
    allowed = max(TOLERANCE, _ROUNDING / max(nearest, 1e-10))
    again = orbit_row(orbit) if system == VI_NES.name else family_orbit(orbit, None, _law(result))
    compare_rows(comparison, table, row, again, leave=(*_MULTIPLIERS, *_NAMES), tolerance=allowed)
    if finite and np.abs(m).max() < _UNSTABLE:
        one, other = np.poly(m), np.poly(orbit.multipliers)
        largest = float(np.abs(one).max())
        for k, (a, b) in enumerate(zip(one, other, strict=True)):
            comparison.number(f"coefficient {k} of the multipliers", float(abs(a - b)), 0.0, allowed * 10 * largest)
        if row["admissible"] and not word.sticking and all(word.sides):
            _fly(comparison, orbit)
    return comparison


def _law(result: Result) -> HarvestLaw | None:
    """Return what the result declares that impacts yield."""
    import msgspec

    declared = result.manifest["ingredients"]["options"].get("harvest")
    return None if declared is None else msgspec.convert(declared, HarvestLaw)


def _bifurcations_of(result: Result, table: str, orbit_id: str) -> list[int]:
    """Return the rows of the table of bifurcations that are this orbit."""
    if table not in result.tables:
        return []
    ids = result.table(table).column("orbit_id").to_pylist()
    return [place for place, each in enumerate(ids) if each == orbit_id]


def _coordinates(p: Any) -> tuple[str, ...]:
    """Return what states at impacts are, in the order of `Orbit.states`."""
    return (*STATE_NAMES, *room_of(p).beside)


def _solve(word: Word, p: Any, t: npt.NDArray[np.float64], disturbance: npt.NDArray[np.float64]) -> Orbit:
    """Solve for the orbit; where Newton's method all but stalls, next to a bifurcation, from a smaller disturbance."""
    for part in (1.0, 1e-2, 1e-4):
        with contextlib.suppress(OrbitNotFound):
            return find_orbit(word, p, t + part * disturbance)
    return find_orbit(word, p, t)


def _searched(word: Word, p: Params, t: npt.NDArray[np.float64]) -> Orbit:
    """Search for an orbit that sticks: what its row tells is no release from which to solve for it."""
    found = all_orbits(word, p)
    if not found:
        raise OrbitNotFound(f"no {word} orbit at {p}: it was not found again ({found.remark})")
    return min(found, key=lambda orbit: float(np.abs(orbit.t - t).max()))


def _fly(comparison: Comparison, orbit: Orbit) -> None:
    """Compare the impacts of the orbit with those that the simulator meets in a period from the first one."""
    start: dict[str, Any] = orbit.start()
    run = simulate(orbit.params, **start, periods=orbit.word.p * (1 + 1e-9))
    met = run.impacts[: len(orbit.t)]
    comparison.same("number of impacts in the simulator", len(orbit.t), len(met))
    if len(met) != len(orbit.t):
        return
    allowed = TOLERANCE * max(1.0, orbit.max_multiplier)
    stored = np.roll(orbit.states, -1, axis=0)
    times = np.append(orbit.t[1:], orbit.t[0] + orbit.period)
    flown = np.column_stack([met[name] for name in _coordinates(orbit.params)])
    comparison.number("an impact in the simulator", float(np.abs(flown - stored).max()), 0.0, allowed)
    comparison.number("a time in the simulator", float(np.abs(met["t"] - times).max()), 0.0, allowed)
