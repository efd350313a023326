"""Orbits of the impact pair that stick: a release fixes all that follows, so that nothing is left to be solved for.

On the wall sigma the ball rides while sigma (G - B sin theta) > 0. It is let go where that vanishes, with the velocity
of the capsule: at one phase for each wall. An orbit with a star exists if the contacts of its word follow from there
until the ball is let go there again, pT later, and both its multipliers are zero (docs/sticking.md).
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import Trajectory
from vines.dynamics.impact_pair import PairConstants
from vines.dynamics.kernels import constants, open_window, run_window, segment_state, tangent_product, window_totals
from vines.dynamics.kernels import rows as col
from vines.dynamics.runs import EVENTS_PER_PERIOD, measures_from
from vines.errors import OrbitNotFound
from vines.model import Word
from vines.orbits._assemble import asymmetry
from vines.orbits._contacts import slowest_followed
from vines.orbits._moved import moved
from vines.orbits._orbit import SPELL, Orbit
from vines.orbits._survey import NO_TURNING, inspect_flight

__all__ = ["CapsuleSticking", "capsule_orbits", "capsule_sticks", "rides_capsule"]

Floats = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]

REMARK = "the phase at which the ball is let go fixes all that follows: there is no other"

_LATE = 1e-8
"""Largest difference of the time from release to release to the period: the event loop knows it to rounding."""

_SAME = 1e-9
"""Largest difference, in any component, of an orbit to its mirror image that counts as symmetric."""

_SHORT = 1e-4
"""Flights shorter than this turn once, away from the wall; after a release the ball has hardly left the wall before."""


def rides_capsule(p: Any) -> bool:
    """Say whether the ball of a system rides on what is driven itself."""
    return isinstance(constants(p), PairConstants)


def release_phase(p: Any, side: int) -> float | None:
    """Return the phase at which a ball that rides on a wall is let go, None if there is none.

    Examples
    --------
    >>> from vines.systems import ImpactPair
    >>> release_phase(ImpactPair(B=1.0, G=0.5), 1), release_phase(ImpactPair(B=0.4, G=0.5), 1)
    (0.5235987755982989, None)
    """
    if not abs(p.G) < p.B:
        return None
    phase = math.asin(p.G / p.B)
    return phase % (2 * math.pi) if side > 0 else math.pi - phase


class _Round:
    """The run from the release after the first contact of a word that sticks to the next one there.

    Attributes
    ----------
    rows : ndarray
        Its events, from a row for the start on.
    places : ndarray of int
        Rows of the contacts, of a complete chatter of its first impact, in the order of the round.
    order : list of int
        Their places in the word.
    """

    def __init__(self, word: Word, p: Any) -> None:
        first = word.sticks.index(True)
        self.word, self.p = word, p
        self.side = word.sides[first]
        self.order = [(first + 1 + k) % len(word) for k in range(len(word))]
        self.places = np.empty(0, dtype=np.int64)
        self.rows = np.empty((0, col.ROW))
        phase = release_phase(p, self.side)
        if phase is not None:
            self._run(phase)

    def _run(self, phase: float) -> None:
        p, c, word = self.p, constants(self.p), self.word
        state = np.zeros(col.STATE)
        x1, v1 = p.B * math.sin(phase), p.B * math.cos(phase)
        state[col.S_WALL], state[col.S_RELEASED], state[col.S_PHASE] = self.side, 1.0, phase
        state[col.S_X1], state[col.S_V1], state[col.S_X2], state[col.S_V2] = x1, v1, x1 - self.side, v1
        rows = np.empty((512, col.ROW))
        # A little longer, so that the release at its end is among the events.
        stop = (word.p + 0.5) * p.period
        rows, count, code = run_window(c, state, stop, EVENTS_PER_PERIOD, rows, open_window(c, state, rows))
        if code == col.COMPLETE:
            self._read(rows[:count])

    def _read(self, rows: Floats) -> None:
        """Keep the events up to the release that ends the word, if the contacts are those of the word."""
        places: list[int] = []
        chatters = False
        for i, (kind, side) in enumerate(rows[:, [col.KIND, col.SIDE]].tolist()):
            if kind == col.IMPACT and not chatters:
                here = self.order[len(places)]
                if side != self.word.sides[here]:
                    return
                places.append(i)
                chatters = self.word.sticks[here]
            elif kind == col.IMPACT:
                if side != self.word.sides[self.order[len(places) - 1]]:
                    return
            elif kind in (col.STICK, col.RELEASE) and not chatters:
                return
            elif kind == col.RELEASE:
                chatters = False
                if len(places) == len(self.order):
                    if abs(rows[i, col.TIME] - self.word.p * self.p.period) < _LATE:
                        self.rows, self.places = rows[: i + 1].copy(), np.array(places, dtype=np.int64)
                    return


def capsule_orbits(word: Word, p: Any) -> tuple[list[Orbit], str]:
    """Return the orbit of a word with a star, none or one, and why there is no other."""
    way = _Round(word, p)
    found = [_assembled(way)] if len(way.places) else []
    return [orbit for orbit in found if not _repeats(orbit)], REMARK


def capsule_sticks(word: Word, p: Any) -> Orbit:
    """Return the orbit of a word with a star.

    Raises
    ------
    OrbitNotFound
        If there is none.
    """
    found, how = capsule_orbits(word, p)
    if not found:
        raise OrbitNotFound(f"no {word} orbit at {p} ({how}); try other parameters, or the word that settle names")
    return found[0]


def _repeats(orbit: Orbit) -> bool:
    """Say whether an orbit is the repetition of one with a shorter period."""
    word = orbit.word
    for shift in word.rotations()[1:]:
        part = orbit.period * shift / len(word)
        later = np.append(orbit.t[shift:], orbit.t[:shift] + orbit.period) - part
        if np.abs(later - orbit.t).max() < _SAME * 1e3:
            return True
    return False


def _assembled(way: _Round) -> Orbit:
    word, p, c, rows = way.word, way.p, constants(way.p), way.rows
    duration = word.p * p.period
    begin = float(rows[0, col.PHASE])
    t = begin + rows[way.places, col.TIME]
    states = rows[way.places][:, [col.X1, col.V1, col.X2, col.V2]]
    jacobians = _jacobians(c, rows, way.places)
    # From the order of the round to that of the word; of its rotations that have the same letters the one that begins
    # at the least phase.
    first = way.order.index(0)
    k = min(word.rotations(), key=lambda k: (float(t[(first + k) % len(t)] % p.period), k))
    turn = (first + k) % len(t)
    t = np.concatenate([t[turn:], t[:turn] + duration])
    t = t - math.floor(t[0] / p.period) * p.period
    states, jacobians = np.roll(states, -turn, axis=0), np.roll(jacobians, -turn, axis=0)
    symmetric = p.mirrored and word.symmetric and asymmetry(word, duration, t, states) < _SAME
    spells = _spells(way, t)
    last = rows[-1]
    for array in (t, states, jacobians, spells):
        array.setflags(write=False)
    nothing = np.zeros(2, dtype=np.complex128)
    return Orbit(
        word=word,
        params=p,
        t=t,
        states=states,
        jacobians=jacobians,
        multipliers=nothing,
        half_multipliers=nothing if symmetric else None,
        symmetric=symmetric,
        admissible=True,
        min_clearance=_clearance(c, rows),
        violation_time=math.nan,
        violation_side=0,
        residual=float(max(abs(last[col.TIME] - duration), abs(last[col.V1] - rows[0, col.V1]))),
        measures=measures_from(p, window_totals(c, rows, len(rows), 0.0, float(last[col.TIME]))),
        remark=REMARK,
        spells=spells,
    )


def _jacobians(c: Any, rows: Floats, places: Numbers) -> Floats:
    """Return the tangent maps from just after each contact to just after the next."""
    twice = np.concatenate([rows, rows[1:]])
    ends = np.append(places, places[0] + len(rows) - 1)
    return np.stack([tangent_product(c, twice, a, b) for a, b in pairwise(ends.tolist())])


def _clearance(c: Any, rows: Floats) -> float:
    """Return the least distance of a turning point of a flight to the wall that it points at."""
    least = NO_TURNING
    for row, tau in zip(rows[:-1], rows[1:, col.TAU].tolist(), strict=True):
        if row[col.MODE] != 0.0 or tau <= 2 * _SHORT:
            continue
        x1, v1, x2, v2, phase = segment_state(c, row, _SHORT)
        least = min(least, float(inspect_flight(c, 1.0, 0, x1, v1, x2, v2, phase, tau - _SHORT)[0]))
    return least


def _spells(way: _Round, t: Floats) -> npt.NDArray[np.void]:
    """Return the spells of sticking in the order of the contacts of the orbit, whose times these are."""
    p, rows = way.p, way.rows
    sticks = Trajectory(p, 0.0, 0.0, float(rows[-1, col.TIME]), "complete", rows).sticks
    out = np.empty(len(sticks), dtype=SPELL)
    for name in ("side", "impacts", "phase_start", "phase_release"):
        out[name] = sticks[name]
    duration, begin = way.word.p * p.period, float(rows[0, col.PHASE])
    shift = begin - np.floor((begin + sticks["t_start"] - t[0]) / duration) * duration
    out["t_start"], out["t_release"] = sticks["t_start"] + shift, sticks["t_release"] + shift
    releases = rows[rows[:, col.KIND] == col.RELEASE]
    out["x1"], out["v1"] = releases[:, col.X1], releases[:, col.V1]
    out["slowest"] = [slowest_followed(_chatter(rows, int(i))) for i in np.flatnonzero(rows[:, col.KIND] == col.STICK)]
    # The force has no minimum before it vanishes.
    out["least_force"] = math.inf
    out["falls"] = p.B * np.abs(np.cos(releases[:, col.PHASE]))
    out = out[np.argsort(out["t_start"], kind="stable")]
    out["contact"] = np.flatnonzero(way.word.sticks)
    return out


def _chatter(rows: Floats, stick: int) -> Floats:
    """Return the impacts of the chatter that ends in a merge."""
    return rows[:stick][rows[:stick, col.KIND] == col.IMPACT][-int(rows[stick, col.RUN]) :]


class CapsuleSticking:
    """Orbits of a word with a star as the zeros of the force at the release, in its phase and one parameter.

    Parameters
    ----------
    orbit : Orbit
        Gives the word and the parameters that stay fixed.
    parameter : str
        Name of the parameter that varies.
    """

    def __init__(self, orbit: Orbit, parameter: str) -> None:
        self.word, self.parameter = orbit.word, parameter
        self._fixed = orbit.params
        # One turn more: the size of unknowns sets that of steps, and a phase of zero would have none.
        phase = float(orbit.spells[0]["phase_release"]) + 2 * math.pi
        self.start = np.array([phase, orbit.params.as_dict()[parameter]])

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the force, shape (1,), and its derivatives, shape (1, 2); nan where the word does not follow."""
        p = moved(self._fixed, {self.parameter: y[-1]})
        if p is None or not len(_Round(self.word, p).places):
            return np.full(1, math.nan), np.full((1, 2), math.nan)
        slopes = {"B": math.sin(y[0]), "G": -1.0, "r": 0.0}
        force = p.B * math.sin(y[0]) - p.G
        return np.array([force]), np.array([[p.B * math.cos(y[0]), slopes[self.parameter]]])

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        return capsule_sticks(self.word, self._fixed.replace(**{self.parameter: float(y[-1])}))
