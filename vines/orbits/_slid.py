"""Orbits of a ball that slides, from impact to impact with all turns and stops between as the simulator finds them.

Flights are broken by turns and stops, so that no closing equations hold over impacts alone. What has to close is the
run itself: from just before the first contact of the word to just before its return, with the contacts of the word and
no other between; four equations in x1, v1, v2 and the phase of the first impact (docs/orbits.md, "Orbits that stop").
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.domains import Numbers
from vines.dynamics import simulate
from vines.dynamics.kernels import (
    room_of,
    tangent_product,
    window_totals,
)
from vines.dynamics.kernels import rows as col
from vines.dynamics.runs import measures_from
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Word
from vines.orbits._assemble import asymmetry, begun_first
from vines.orbits._closing import difference
from vines.orbits._floquet import FIXED_TIME, half_map, monodromy, sorted_multipliers, squared
from vines.orbits._general import check_word, same
from vines.orbits._moved import moved
from vines.orbits._orbit import Orbit
from vines.orbits._slid_round import SlidRound
from vines.orbits._survey import NO_TURNING

__all__ = [
    "SlidProblem",
    "clearance_of_rests",
    "first_impact",
    "refine_slid",
    "slid_again",
    "slid_image",
    "slid_orbit",
    "slid_orbits",
]

Floats = npt.NDArray[np.float64]

_STEP = 1e-6
"""Step of the differences in a parameter, which steer Newton's method and do not move its goal."""

_CLOSES = 1e-11
_SAME = 1e-9
_ITERATIONS = 25
_STARTS = 12
_PERIODS = 120
"""Random starts from which runs are looked through for the word, and how long these are."""

REMARK = f"Newton's method from runs of {_STARTS} random starts: there may be more"


class SlidProblem:
    """Orbits of a word with stops as the zeros of what does not close, in the first impact and one parameter.

    Parameters
    ----------
    orbit : Orbit
        Gives the word and the parameters that stay fixed.
    parameter : str
        Name of the parameter that varies.
    symmetric : bool, optional
        Whether the family is kept symmetric, its first half closing on its mirror image; by default if the orbit is.
    """

    def __init__(self, orbit: Orbit, parameter: str, symmetric: bool | None = None) -> None:
        self.word, self.parameter = orbit.word, parameter
        self._fixed = orbit.params
        breaks = parameter in orbit.params.system.mirror.broken_by
        self._half = orbit.symmetric and not breaks if symmetric is None else symmetric
        self._contacts = len(self.word) // 2 if self._half else len(self.word)
        self.start = np.append(first_impact(orbit), orbit.params.as_dict()[parameter])

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return what does not close, shape (4,), and its derivatives, (4, 5); nan where the word does not follow."""
        p = moved(self._fixed, {self.parameter: y[-1]})
        if p is None:
            return np.full(4, math.nan), np.full((4, 5), math.nan)
        way = SlidRound(self.word, p, y[:4], self._contacts)
        step = _STEP * max(abs(float(y[-1])), 0.01)
        across = difference(self._defect, y, 4, step)
        return way.closing(self._half), np.column_stack([way.slopes(self._half), across])

    def _defect(self, y: Floats) -> Floats:
        p = moved(self._fixed, {self.parameter: y[-1]})
        if p is None:
            return np.full(4, math.nan)
        return SlidRound(self.word, p, y[:4], self._contacts).closing(self._half)

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        return slid_again(self.word, self._fixed.replace(**{self.parameter: float(y[-1])}), y[:4])


def first_impact(orbit: Orbit) -> Floats:
    """Return x1, v1, v2 and the phase of the first impact; one turn more: the size of unknowns sets that of steps."""
    x1, v1, _, v2 = orbit.states[0]
    return np.array([x1, v1, v2, orbit.phase[0] + 2 * math.pi])


def _solved(word: Word, p: Any, z: Floats) -> Floats | None:
    """Return the first impact of an orbit from a guess, None if Newton's method does not find one."""
    for _ in range(_ITERATIONS):
        way = SlidRound(word, p, z, len(word))
        here, slope = way.closing(False), way.slopes(False)
        if not (np.isfinite(here).all() and np.isfinite(slope).all()):
            return None
        try:
            move = np.linalg.solve(slope, here)
        except np.linalg.LinAlgError:
            return None
        share = min(1.0, 0.3 / np.abs(move).max(initial=1e-300))
        z = z - share * move
        if np.abs(move).max() < _CLOSES:
            return z if np.abs(SlidRound(word, p, z, len(word)).closing(False)).max() < 1e2 * _CLOSES else None
    return None


def slid_orbit(word: Word, p: Any, z: Floats, remark: str = "") -> Orbit | None:
    """Return the orbit with this first impact, None if the contacts are not those of the word."""
    way = SlidRound(word, p, z, len(word))
    if not way.places:
        return None
    rows, places, c = way.rows, way.places, way.c
    begin = float(z[3]) % (2 * math.pi) / p.Omega
    t = begin + rows[places[:-1], col.TIME]
    states = rows[places[:-1]][:, [col.X1, col.V1, col.X2, col.V2]]
    # The row of the start has the state just after the impact.
    states[0, [1, 3]] = z[1], z[2]
    jacobians = np.stack([tangent_product(c, rows, a, b) for a, b in pairwise(places)])
    k, t = begun_first(word.rotations(), word, p, t)
    states, jacobians = np.roll(states, -k, axis=0), np.roll(jacobians, -k, axis=0)
    symmetric = p.mirrored and asymmetry(word, word.p * p.period, t, states) < _SAME
    halves = sorted_multipliers(half_map(jacobians, FIXED_TIME)) if symmetric else None
    for array in (t, states, jacobians):
        array.setflags(write=False)
    x1, v1, v2, _ = way.end
    return Orbit(
        word=word,
        params=p,
        t=t,
        states=states,
        jacobians=jacobians,
        multipliers=squared(halves) if halves is not None else sorted_multipliers(monodromy(jacobians)),
        half_multipliers=halves,
        symmetric=symmetric,
        admissible=True,
        min_clearance=clearance_of_rests(rows),
        violation_time=math.nan,
        violation_side=0,
        residual=float(np.abs(np.array([x1, v1, v2]) - z[:3]).max()),
        measures=measures_from(p, window_totals(c, rows, len(rows), 0.0, float(rows[-1, col.TIME]))),
        remark=remark,
    )


def slid_again(word: Word, p: Any, z: Floats, remark: str = "") -> Orbit:
    """Return the orbit with this first impact.

    Raises
    ------
    OrbitNotFound
        If the contacts are not those of the word.
    """
    found = slid_orbit(word, p, z, remark)
    if found is None:
        raise OrbitNotFound(f"no {word} orbit at {p}: from its first impact other contacts come; give a nearer guess")
    return found


def clearance_of_rests(rows: Floats) -> float:
    """Return the least distance of a turn or stop to the wall that the ball came towards."""
    least = NO_TURNING
    for row in rows[1:]:
        came = row[col.SIDE] if row[col.KIND] == col.STOP else -row[col.SIDE]
        if row[col.KIND] == col.STOP or (row[col.KIND] == col.SLIDE and row[col.RUN] == 0.0):
            least = min(least, 1.0 - float(came * (row[col.X1] - row[col.X2])))
    return least


def _guesses(word: Word, p: Any, run: Any) -> list[Floats]:
    """Return the impacts of a run from which the contacts of the word follow, the last ones first."""
    rows = run.rows[np.isin(run.rows[:, col.KIND], (col.IMPACT, col.STOP))]
    marks = np.where(rows[:, col.KIND] == col.IMPACT, rows[:, col.SIDE], 0.0).tolist()
    wanted, found = [*word.sides, word.sides[0]], []
    for i in range(len(marks) - len(wanted), -1, -1):
        if marks[i : i + len(wanted)] == wanted:
            found.append(rows[i, [col.X1, col.V1, col.V2, col.PHASE]])
    return found


def _check(word: Word) -> None:
    if not word.n and not word.m:
        raise ParameterError(f"{word} has no impact, from which orbits with stops are solved for; give a word with one")


def slid_orbits(word: Word, p: Any) -> tuple[list[Orbit], str]:
    """Return the orbits of a word that are found from runs of random starts, and how they were searched for."""
    _check(word)
    rng, room = np.random.default_rng(len(word)), room_of(p)
    found: list[Orbit] = []
    for _ in range(_STARTS):
        start: dict[str, Any] = room.draw(p, rng)
        run = simulate(p, **start, periods=_PERIODS, max_impacts_per_period=2000)
        for guess in _guesses(word, p, run)[:2]:
            z = _solved(word, p, guess)
            orbit = None if z is None else slid_orbit(word, p, z, REMARK)
            if orbit is not None and not any(same(each, orbit.t, orbit.states) for each in found):
                found.append(orbit)
    return found, REMARK


def refine_slid(word: Word, p: Any, guess: Any) -> Orbit:
    """Return the orbit that Newton's method finds from one nearby, or from x1, v1, v2 and t at its first impact.

    Raises
    ------
    ParameterError
        If the guess is neither.
    OrbitNotFound
        If there is none near it.
    """
    _check(word)
    if isinstance(guess, Orbit):
        check_word(guess, word)
        first = first_impact(guess)
    else:
        Numbers(most=4).check("guess", guess, ParameterError)
        first = np.asarray(guess, dtype=np.float64)
        if first.shape != (4,):
            raise ParameterError(
                f"the guess for {word} has to be x1, v1, v2 and t just before its first impact, or an orbit"
            )
        first = first * [1.0, 1.0, 1.0, p.Omega]
    z = _solved(word, p, first)
    orbit = None if z is None else slid_orbit(word, p, z)
    if orbit is None:
        raise OrbitNotFound(f"no {word} orbit from this guess at {p}; give a nearer one, or look what a run settles to")
    return orbit


def slid_image(orbit: Orbit) -> Orbit:
    """Return the mirror image of an orbit."""
    word = orbit.word.mirror
    sides = [-side for side in orbit.word.sides]
    k = next(k for k in range(len(sides)) if tuple(sides[k:] + sides[:k]) == word.sides)
    x1, v1, _, v2 = -orbit.states[k]
    return slid_again(word, orbit.params, np.array([x1, v1, v2, orbit.phase[k] + math.pi]), orbit.remark)
