"""On which side of a branching point the other family lies, and how fast it leaves; derived in docs/orbits.md."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.model import PARAMETER_NAMES, Params
from vines.orbits._family import closing_at
from vines.orbits._joined import unfolded
from vines.orbits._moved import moved
from vines.orbits._orbit import Orbit
from vines.orbits._release_of_balls import run_closed
from vines.orbits._shooting import closing_of
from vines.orbits._slid import first_impact
from vines.orbits._slid_round import SlidRound, slides
from vines.orbits._sticking_family import closing_of_round
from vines.orbits._sticking_of_balls import by_sections
from vines.orbits._sticking_orbit import Round, release_of
from vines.orbits._values import frequency_of, values_of

__all__ = ["branching_curvature"]

Floats = npt.NDArray[np.float64]
Equations = Callable[..., tuple[Floats, Floats]]
"""Closing equations and their slope in the unknowns, by these and by how far the parameters moved."""

_STEP = 1e-3
"""Step of the differences in the unknowns, phases [rad]; they are central, with an error of the order of its square."""

_CHANGE = 1e-5
"""The same in the parameters, relative to the direction given."""


def _equations(kind: str, orbit: Orbit, names: tuple[str, str], direction: Floats) -> tuple[Equations, Floats]:
    """Return the equations of the family that comes out of an orbit, and their unknowns there."""
    if orbit.word.sticking:
        return _of_rounds(kind, orbit, names, direction)
    if slides(orbit.params):
        return _of_runs(kind, orbit, names, direction)
    orbit = unfolded(kind, orbit)
    phases = orbit.t * frequency_of(orbit.params)
    if not isinstance(orbit.params, Params):
        closing = closing_of(orbit, names, symmetric=False)
        begin = closing.start[-len(names) :]

        def at(z: Floats, shift: float = 0.0) -> tuple[Floats, Floats]:
            closed = closing.at(z, begin + shift * direction)
            return (closed.defect, closed.slope) if closed else (z * np.nan, np.outer(z, z) * np.nan)

        return at, closing.start[: -len(names)]
    values = values_of(orbit.params)
    where = [PARAMETER_NAMES.index(name) for name in names]
    side = np.array(orbit.word.sides, dtype=np.int64)

    def of_bare_values(z: Floats, shift: float = 0.0) -> tuple[Floats, Floats]:
        there = values.copy()
        there[where] += shift * direction
        return closing_at(there, orbit.word.p, side, z)[:2]

    return of_bare_values, phases


def _of_runs(kind: str, orbit: Orbit, names: tuple[str, str], direction: Floats) -> tuple[Equations, Floats]:
    """Return the same of an orbit with friction, the unknowns being those of its first impact."""
    word = orbit.word.doubled if kind == "period_doubling" else orbit.word
    values = np.array([orbit.params.as_dict()[name] for name in names])

    def of_runs(z: Floats, shift: float = 0.0) -> tuple[Floats, Floats]:
        p = moved(orbit.params, dict(zip(names, values + shift * direction, strict=True)))
        if p is None:
            return z * np.nan, np.outer(z, z) * np.nan
        way = SlidRound(word, p, z, len(word))
        return way.closing(half=False), way.slopes(half=False)

    return of_runs, first_impact(orbit)


def _of_rounds(kind: str, orbit: Orbit, names: tuple[str, str], direction: Floats) -> tuple[Equations, Floats]:
    """Return the same of an orbit that sticks, the unknowns being phase and velocity of a release."""
    word = orbit.word.doubled if kind == "period_doubling" else orbit.word
    values = np.array([orbit.params.as_dict()[name] for name in names])
    if by_sections(orbit.params):
        section, start = orbit.release

        def of_balls(z: Floats, shift: float = 0.0) -> tuple[Floats, Floats]:
            p = moved(orbit.params, dict(zip(names, values + shift * direction, strict=True)))
            met = None if p is None else run_closed(p, section, word.p * p.period, z, mirrored=False)
            return (z * np.nan, np.outer(z, z) * np.nan) if met is None else met[1]

        return of_balls, start
    way = Round(word)
    begin = release_of(orbit)

    def of_rounds(z: Floats, shift: float = 0.0) -> tuple[Floats, Floats]:
        p = moved(orbit.params, dict(zip(names, values + shift * direction, strict=True)))
        nothing = z * np.nan, np.outer(z, z) * np.nan
        return nothing if p is None else closing_of_round(way, p, float(z[0]), float(z[1]))

    return of_rounds, np.array([begin.phase, begin.v1])


def branching_curvature(kind: str, orbit: Orbit, names: tuple[str, str], direction: Floats) -> float:
    """Return c of ``parameters = c s² direction``, along the family that branches off, s being its distance.

    Parameters
    ----------
    kind : str
        Type of the branching point.
    orbit : Orbit
        The orbit there.
    names : tuple of str, str
        Parameters that vary.
    direction : (2,) float array
        A direction in them, transversal to the curve of branching points.

    Returns
    -------
    float
        Zero where the branching is degenerate, changing from supercritical to subcritical.
    """
    at, phases = _equations(kind, orbit, names, direction)
    slope = at(phases)[1]
    u, _, v = np.linalg.svd(slope)
    left, null = u[:, -1], v[-1]

    def solve(right: npt.NDArray[Any]) -> Floats:
        # The right-hand sides have no part along `left`, and the solution needs none along `null`.
        balanced: Floats = np.asarray(right - left * (left @ right), dtype=np.float64)
        return np.asarray(np.linalg.solve(slope + np.outer(left, null), balanced), dtype=np.float64)

    # The critical eigenvalue's change along the old family.
    tilt = solve(-(at(phases, _CHANGE)[0] - at(phases, -_CHANGE)[0]) / (2 * _CHANGE))
    ahead, behind = at(phases + _CHANGE * tilt, _CHANGE)[1], at(phases - _CHANGE * tilt, -_CHANGE)[1]
    linear = left @ (ahead - behind) @ null / (2 * _CHANGE)
    # Its change along the new one: the cubic term, with the quadratic one eliminated.
    ahead, behind = at(phases + _STEP * null)[1] @ null, at(phases - _STEP * null)[1] @ null
    bend = solve(-(ahead - behind) / (2 * _STEP))
    cubic = (ahead - 2 * slope @ null + behind) / _STEP**2
    ahead, behind = at(phases + _STEP * bend)[1], at(phases - _STEP * bend)[1]
    total = left @ (cubic / 6 + (ahead - behind) @ null / (4 * _STEP))
    return float(-total / linear)
