"""Bifurcations located again: from an orbit beside it, along the branch, through the place."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.errors import OrbitNotFound, ParameterError
from vines.model import Word
from vines.orbits import Bifurcation, Orbit, all_orbits, continue_orbit, find_orbit
from vines.stages.audit._compare import TOLERANCE, Comparison, stored_row
from vines.stages.audit._systems import parameters_of_row, system_of

if TYPE_CHECKING:
    from vines.store import Result

__all__ = ["locate_again"]

_BESIDE = (1e-3, 1e-4, 1e-5)
"""Distances of the orbit that is followed from the bifurcation, relative to the value of the parameter."""

_ENDS = ("incomplete_chatter", "release_tangency")
_SLIDING = "_sliding"
"""Types of ends of families that stick, and what ends those of families with friction."""

_EXTRAPOLATED = 1e-7
"""What is allowed of these, which are extrapolated."""


def locate_again(result: Result, table: str, place: int) -> Comparison:
    """Locate the bifurcation of a row of a table of bifurcations again and compare where it lies."""
    row = stored_row(result, table, place)
    p = parameters_of_row(system_of(result), row)
    comparison = Comparison()
    nearest = min(_met(row, p), key=lambda found: abs(found.value - row["value"]), default=None)
    if nearest is None:
        comparison.same(f"{row['type']} at {row['parameter']} = {row['value']:.10g}", "there", "not met again")
        return comparison
    extrapolated = row["type"] in _ENDS or row["type"].endswith(_SLIDING)
    allowed = _EXTRAPOLATED if extrapolated else TOLERANCE
    comparison.number("value", row["value"], nearest.value, allowed)
    return comparison


def _met(row: dict[str, Any], p: Any) -> Iterator[Bifurcation]:
    """Yield the bifurcations and events of the type of the row that branches through the place meet."""
    word, parameter = Word(row["word"]), row["parameter"]
    times = np.array(row["t"]) + row["phase"][0] / getattr(p, "Omega", 1.0)
    for distance in _BESIDE:
        delta = distance * max(abs(row["value"]), 1e-3)
        for sign in (-1.0, 1.0):
            here, there = row["value"] + sign * delta, row["value"] - sign * delta
            try:
                moved = p.replace(**{parameter: here})
                orbit = _unstruck_beside(word, moved, row) if word.unstruck else _beside(word, moved, times, distance)
                low, high = sorted((here - sign * 0.5 * (here - there), there))
                within = (min(low, here), max(high, here))
                branch = continue_orbit(orbit, parameter, there, within=within, beyond_grazing=True)
            except (OrbitNotFound, ParameterError):
                continue
            found = [each for each in (*branch.bifurcations, *branch.events) if each.type == row["type"]]
            yield from found
            if any(abs(each.value - row["value"]) < TOLERANCE for each in found):
                return


def _unstruck_beside(word: Word, p: Any, row: dict[str, Any]) -> Orbit:
    """Return the orbit without impacts next to that of a row, which tells where it comes through phase 0.

    Raises
    ------
    OrbitNotFound
        If there is none.
    """
    found = all_orbits(word, p)
    if not found:
        raise OrbitNotFound(f"no {word} orbit beside this one at {p}; there is one on the other side")
    x1, w_dot = row["x1"][0], row["w_dot"][0]
    return min(found, key=lambda orbit: math.hypot(orbit.states[0, 0] - x1, orbit.w_dot[0] - w_dot))


def _beside(word: Word, p: Any, times: npt.NDArray[np.float64], distance: float) -> Orbit:
    """Return the orbit next to given impact times.

    At a fold Newton's method has no derivative to go by, and the orbit beside it is the square root of the distance
    away: it is sought from times that are shifted by that much.

    Raises
    ------
    OrbitNotFound
        If there is none on this side.
    """
    for shift in (0.0, 0.3, -0.3, 1.0, -1.0, 3.0, -3.0):
        with contextlib.suppress(OrbitNotFound, ParameterError):
            return find_orbit(word, p, times + shift * math.sqrt(distance))
    near = [orbit for orbit in all_orbits(word, p) if np.abs(orbit.t - times).max() < 10 * math.sqrt(distance)]
    if not near:
        raise OrbitNotFound(f"no {word} orbit beside these times at {p}; there is one on the other side")
    return min(near, key=lambda orbit: float(np.abs(orbit.t - times).max()))
