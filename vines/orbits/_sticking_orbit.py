"""An orbit that sticks, from one of its releases."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.dynamics import Trajectory
from vines.dynamics.kernels import constants, window_totals
from vines.dynamics.kernels import rows as col
from vines.dynamics.runs import measures_from
from vines.errors import OrbitNotFound
from vines.kernels import entry_njit
from vines.model import Params, Word
from vines.orbits._assemble import asymmetry
from vines.orbits._floquet import sorted_multipliers, squared
from vines.orbits._orbit import SPELL, Orbit
from vines.orbits._sticking_map import CHATTER, ROOM, newton_round, round_kernel
from vines.orbits._sticking_survey import FALLS, LEAST_FORCE, SLOWEST, survey_sticking

__all__ = ["Release", "Round", "mirrored_sticking", "orbit_of_rows", "release_of", "sticking_orbit"]

Floats = npt.NDArray[np.float64]

_SAME = 1e-9
"""Largest difference, in any component, of an orbit to its mirror image that counts as symmetric."""

_ROUNDS = 400
"""Rounds that Newton's method may take from a guess."""

_ALMOST = 1e-5
"""The same before the symmetric solution is computed as such."""


@dataclass(frozen=True, slots=True)
class Release:
    """A release: phase of the forcing [rad] and the velocity of ball and oscillator."""

    phase: float
    v1: float


class Round:
    """The map from release to release of a word, after the first of its contacts that sticks.

    Parameters
    ----------
    word : Word
        One with a star.
    half : bool
        Whether to go half the way only, to the mirror image of the release; the word has to be symmetric.
    first : int, optional
        Another contact that sticks, after whose release to begin.
    """

    def __init__(self, word: Word, half: bool = False, first: int | None = None) -> None:
        marks = [side * (CHATTER if sticks else 1) for side, sticks in zip(word.sides, word.sticks, strict=True)]
        first = word.sticks.index(True) if first is None else first
        self.word, self.half = word, half
        self.side = word.sides[first]
        self.sign = -1.0 if half else 1.0
        self.order = [(first + 1 + k) % len(marks) for k in range(len(marks))]
        wanted = [marks[k] for k in self.order]
        self.wanted = np.array(wanted[: len(wanted) // 2] if half else wanted, dtype=np.int64)

    def span(self, period: float) -> float:
        """Return the time of the map on an orbit, from the forcing period."""
        return self.word.p * period / (2 if self.half else 1)

    def solve(self, p: Params, guess: Release) -> tuple[Release | None, float]:
        """Return the release that Newton's method finds, None if none, and what is left of the defect."""
        count, phase, v1, defect = newton_round(
            constants(p),
            self.side,
            self.wanted,
            self.span(p.period),
            self.sign,
            guess.phase,
            guess.v1,
            _ROUNDS,
            _rows(),
            _out(),
        )
        return (Release(phase % (2 * math.pi), v1) if count else None), defect

    def run(self, p: Params, release: Release) -> tuple[Floats, Floats] | None:
        """Return the events from a release to the last of the round, and where it comes with its slopes, or None."""
        rows, out = _rows(), _out()
        count = round_kernel(
            constants(p), self.side, self.wanted, self.span(p.period), release.phase, release.v1, rows, out
        )
        return (rows[:count].copy(), out) if count else None


_ROWS = np.empty((ROOM, col.ROW))


def _rows() -> Floats:
    """Return room for the events of a round; the kernels fill it, and what is kept is copied."""
    return _ROWS


def _out() -> Floats:
    return np.zeros(6)


@entry_njit
def _totals(c, rows):
    """Return the totals of a whole run."""
    return window_totals(c, rows, rows.shape[0], rows[0, col.TIME], rows[rows.shape[0] - 1, col.TIME])


def sticking_orbit(word: Word, p: Params, release: Release, remark: str = "") -> Orbit:
    """Return the orbit of a release that comes back.

    Where the orbit is all but its own mirror image the symmetric one is computed as such.

    Raises
    ------
    OrbitNotFound
        If from there other contacts come.
    """
    way = Round(word)
    met = way.run(p, release)
    if met is None:
        raise OrbitNotFound(f"no {word} orbit at {p}: from its release other contacts come; give a nearer guess")
    rows, out = met
    half = None
    if word.symmetric and _skew(way, p, release, rows) < _ALMOST:
        half_way = Round(word, half=True)
        found, _ = half_way.solve(p, release)
        again = half_way.run(p, found) if found is not None else None
        if found is not None and again is not None and abs(found.v1 - release.v1) < 10 * _ALMOST:
            whole = way.run(p, found)
            if whole is not None:
                release, (rows, out) = found, whole
                half = np.diag([1.0, -1.0]) @ again[1][2:].reshape(2, 2)
    return orbit_of_rows(way, p, release, rows, out, half, remark)


def _skew(way: Round, p: Params, release: Release, rows: Floats) -> float:
    t, states, _, _ = _contacts(way, p, release, rows)
    return asymmetry(way.word, way.word.p * p.period, t, states)


def _contacts(
    way: Round, p: Params, release: Release, rows: Floats
) -> tuple[Floats, Floats, npt.NDArray[np.int64], float]:
    """Return times and states of the contacts in canonical order, their rows in the order of the round, and its start.

    The start is that of the clock of the round in the time of the orbit, up to its period.
    """
    places = _places(way, rows)
    t = release.phase / p.Omega + rows[places, col.TIME]
    states = rows[places][:, [col.X1, col.V1, col.X2, col.V2]]
    first = way.order.index(0)
    duration = way.word.p * p.period
    t = np.concatenate([t[first:], t[:first] + duration])
    states = np.concatenate([states[first:], states[:first]])
    starts = way.word.rotations()
    k = min(starts, key=lambda k: (float(t[k] % p.period), k))
    t = np.concatenate([t[k:], t[:k] + duration])
    early = math.floor(t[0] / p.period) * p.period
    return t - early, np.concatenate([states[k:], states[:k]]), places, release.phase / p.Omega - early


def _places(way: Round, rows: Floats) -> npt.NDArray[np.int64]:
    """Return the rows of the contacts of a round: each impact, but of a complete chatter only the first."""
    places: list[int] = []
    going = False
    for i, kind in enumerate(rows[:, col.KIND].tolist()):
        if kind == col.IMPACT:
            if not going:
                places.append(i)
            going = abs(way.wanted[len(places) - 1]) == CHATTER
        elif kind == col.RELEASE:
            going = False
    return np.array(places, dtype=np.int64)


def orbit_of_rows(
    way: Round, p: Params, release: Release, rows: Floats, out: Floats, half: Floats | None, remark: str = ""
) -> Orbit:
    """Return the orbit of a round that closes.

    Parameters
    ----------
    way : Round
        The whole way.
    p : Params
    release : Release
        From which it begins.
    rows : (M, ROW) float array
        Its events.
    out : (6,) float array
        Where it comes, with the slopes, as `round_kernel` gives it.
    half : (2, 2) float array or None
        The slopes of half the way, of an orbit that is its own mirror image.
    remark : str
    """
    word, c = way.word, constants(p)
    t, states, places, start = _contacts(way, p, release, rows)
    twice = np.concatenate([rows, rows[1:]])
    run = Trajectory(p, 0.0, 0.0, float(rows[-1, col.TIME]), "complete", rows)
    margins = np.empty((len(run.sticks), 3))
    ends = np.append(places, places[0] + len(rows) - 1)
    jacobians, clearance = survey_sticking(c, twice, ends, margins)
    # From the order of the round to that of the orbit, whose first contact is the canonical one.
    shift = int(np.argmin(np.abs(states[0] - rows[places][:, [col.X1, col.V1, col.X2, col.V2]]).max(axis=1)))
    jacobians = np.roll(jacobians, -shift, axis=0)
    symmetric = half is not None and asymmetry(word, word.p * p.period, t, states) < _SAME
    half_multipliers = None
    if symmetric and half is not None:
        half_multipliers = _with_zeros(sorted_multipliers(half))
        multipliers = squared(half_multipliers)
    else:
        multipliers = _with_zeros(sorted_multipliers(out[2:].reshape(2, 2)))
    last = rows[-1]
    residual = max(
        abs(last[col.TIME] - word.p * p.period),
        abs(last[col.V1] - rows[0, col.V1]),
        abs(last[col.X1] - rows[0, col.X1]),
    )
    spells = _spells(way, run, margins, start, float(t[0]))
    for array in (t, states, jacobians, spells):
        array.setflags(write=False)
    return Orbit(
        word=word,
        params=p,
        t=t,
        states=states,
        jacobians=jacobians,
        multipliers=multipliers,
        half_multipliers=half_multipliers,
        symmetric=symmetric,
        admissible=True,
        min_clearance=float(clearance),
        violation_time=math.nan,
        violation_side=0,
        residual=float(residual),
        measures=measures_from(p, _totals(c, rows)),
        remark=remark,
        spells=spells,
    )


def _with_zeros(pair: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """Return the multipliers of an orbit that sticks: sticking leaves nothing of the two directions of w and w'."""
    return np.concatenate([pair, np.zeros(2, dtype=np.complex128)])


def _spells(way: Round, run: Trajectory, margins: Floats, start: float, begin: float) -> npt.NDArray[np.void]:
    """Return the spells of sticking of an orbit whose first contact is at `begin`, in the order of its contacts."""
    sticks, p = run.sticks, run.params
    releases = run.rows[run.rows[:, col.KIND] == col.RELEASE]
    out = np.empty(len(sticks), dtype=SPELL)
    for name in ("side", "impacts", "phase_start", "phase_release"):
        out[name] = sticks[name]
    duration = way.word.p * p.period
    shift = start - np.floor((start + sticks["t_start"] - begin) / duration) * duration
    out["t_start"], out["t_release"] = sticks["t_start"] + shift, sticks["t_release"] + shift
    out["x1"], out["v1"] = releases[:, col.X1], releases[:, col.V1]
    out["slowest"], out["least_force"], out["falls"] = (margins[:, k] for k in (SLOWEST, LEAST_FORCE, FALLS))
    out = out[np.argsort(out["t_start"], kind="stable")]
    out["contact"] = np.flatnonzero(way.word.sticks)
    return out


def release_of(orbit: Orbit, number: int = 0) -> Release:
    """Return the release after the first contact of the canonical word that sticks, or after another one of them."""
    spell = orbit.spells[number]
    return Release(float(spell["phase_release"]), float(spell["v1"]))


def mirrored_sticking(orbit: Orbit) -> Orbit:
    """Return the mirror image of an orbit that sticks."""
    word = orbit.word.mirror
    way = Round(word)
    for spell in orbit.spells:
        image = Release((float(spell["phase_release"]) + math.pi) % (2 * math.pi), -float(spell["v1"]))
        met = way.run(orbit.params, image) if spell["side"] == -way.side else None
        if met is not None and abs(met[0][-1, col.TIME] - way.span(orbit.params.period)) < _ALMOST:
            return sticking_orbit(word, orbit.params, image, orbit.remark)
    raise OrbitNotFound(f"the mirror image of {orbit.word} at {orbit.params} is lost: its releases lead elsewhere")
