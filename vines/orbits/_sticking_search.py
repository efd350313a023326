"""Orbits that stick, of one word: Newton's method from a grid of releases and from releases of simulations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import Trajectory, simulate
from vines.dynamics.kernels import constants, room_of
from vines.dynamics.kernels import rows as col
from vines.errors import OrbitNotFound, ParameterError
from vines.model import STATE_NAMES, Params, Word
from vines.orbits._general import check_word, same
from vines.orbits._orbit import Orbit
from vines.orbits._seeds import STARTS
from vines.orbits._sticking_map import ROOM, search_rounds
from vines.orbits._sticking_orbit import Release, Round, mirrored_sticking, release_of, sticking_orbit

__all__ = ["no_sticking_orbit", "refine_sticking", "repeats", "search_sticking"]

Floats = npt.NDArray[np.float64]

_GRIDS = (48, 96, 192)
"""Releases tried in either direction: a finer grid where too few of one lead to the contacts of the word, the finest
only where nothing is found."""

_ENOUGH = 100

_PERIODS = 200
"""Forcing periods of each simulation, beside twenty of those of the orbit."""

_LATE = 16
"""Releases of each simulation that are tried: the last ones, and two periods of the orbit in all."""

_MARGIN = 1.5
"""By how much releases of the grid may be faster than any seen in the simulations."""

_MOST = 256

_SHORTER = 1e-6
"""Difference to its own repetition below which an orbit has a shorter period."""


def search_sticking(word: Word, p: Params) -> tuple[list[Orbit], str]:
    """Return the different orbits of a word with a star that are found, each once, and how they were searched for.

    Parameters
    ----------
    word : Word
    p : Params
    """
    way = Round(word)
    found: list[Orbit] = []
    if word.n == 0 or word.m == 0:
        return found, "every contact on one wall pushes the ball the same way, and nothing brings it back"
    starts: list[dict[str, Any]] = [dict(zip(STATE_NAMES, start, strict=True)) for start in STARTS]
    runs = [simulate(p, **start, periods=_PERIODS + 20 * word.p, max_impacts_per_period=2000) for start in starts]
    for release in _of_runs(way, p, runs):
        _add(found, word, p, release)
    fastest = _fastest(runs, p)
    # Over half a period more releases lead to the contacts of a symmetric orbit.
    for each in (Round(word, half=True), way) if word.symmetric else (way,):
        for size in _GRIDS:
            releases, met = _of_grid(each, p, fastest, size)
            for release in releases:
                _add(found, word, p, release)
            if met >= _ENOUGH or (found and size > _GRIDS[0]):
                break
    if word.mirror == word:
        for orbit in [orbit for orbit in found if not orbit.symmetric]:
            image = mirrored_sticking(orbit)
            if not any(same(known, image.t, image.states) for known in found):
                found.append(image)
    return found, (
        "Newton's method from a grid of phases and velocities of the release and from simulations: there may be more"
    )


def _add(found: list[Orbit], word: Word, p: Params, release: Release) -> None:
    """Add the orbit of a release unless it is there, or its period is shorter."""
    try:
        orbit = sticking_orbit(word, p, release)
    except OrbitNotFound:
        return
    if not repeats(orbit) and not any(same(known, orbit.t, orbit.states) for known in found):
        found.append(orbit)


def repeats(orbit: Orbit) -> bool:
    """Say whether an orbit is the repetition of one with a shorter period."""
    word = orbit.word
    for shift in word.rotations()[1:]:
        if word.p * shift % len(word):
            continue
        part = orbit.period * shift / len(word)
        later = np.append(orbit.t[shift:], orbit.t[:shift] + orbit.period) - part
        if max(np.abs(later - orbit.t).max(), np.abs(np.roll(orbit.states, -shift, 0) - orbit.states).max()) < _SHORTER:
            return True
    return False


def _of_runs(way: Round, p: Params, runs: list[Trajectory]) -> Iterator[Release]:
    """Yield what Newton's method finds from the last releases of simulations."""
    for run in runs:
        rows = run.rows
        late = rows[(rows[:, col.KIND] == col.RELEASE) & (rows[:, col.SIDE] == way.side)]
        for row in late[-(_LATE + 2 * sum(way.word.sticks)) :]:
            release, _ = way.solve(p, Release(float(row[col.PHASE]), float(row[col.V1])))
            if release is not None:
                yield release


def _of_grid(way: Round, p: Params, fastest: float, size: int) -> tuple[list[Release], int]:
    """Return what it finds from a grid of releases, and from how many of these the contacts of the word come.

    Half of the grid's velocities lie in the lowest quarter of their range.
    """
    places = (np.arange(size) + 0.5) / size
    found = np.empty((_MOST, 2))
    count, met = search_rounds(
        constants(p),
        way.side,
        way.wanted,
        way.span(p.period),
        way.sign,
        2 * math.pi * places,
        fastest * places**2,
        np.empty((ROOM, col.ROW)),
        found,
    )
    return [Release(phase, v1) for phase, v1 in found[:count].tolist()], met


def _fastest(runs: list[Trajectory], p: Params) -> float:
    """Return up to which velocity, beyond that at which the contact force would not fall, releases are looked for."""
    seen = max(float(np.abs(run.rows[:, [col.V1, col.A_V1]]).max()) for run in runs)
    return _MARGIN * seen + p.A * p.Omega * math.hypot(1.0, p.lam * p.Omega)


def refine_sticking(word: Word, p: Params, guess: Orbit | npt.ArrayLike) -> Orbit:
    """Return the orbit that Newton's method finds from an orbit of the word, or from time and velocity of a release.

    Raises
    ------
    OrbitNotFound
        If it does not converge to an orbit of this word.
    ParameterError
        If the guess does not fit the word.
    """
    if isinstance(guess, Orbit):
        check_word(guess, word)
        begin = release_of(guess)
    else:
        given = np.asarray(guess, dtype=np.float64)
        if given.shape != (2,) or not np.isfinite(given).all():
            raise ParameterError(
                f"the guess for {word}, which sticks, has to be an orbit or time and v1 of the release after its first "
                f"star, two numbers; it is {np.array2string(given, precision=4, threshold=8)}"
            )
        begin = Release(float(given[0] * p.Omega) % (2 * math.pi), float(given[1]))
    found, defect = Round(word).solve(p, begin)
    if found is None:
        left = "other contacts come" if math.isinf(defect) else f"Newton's method stopped at a defect of {defect:.2g}"
        raise OrbitNotFound(f"no {word} orbit from this guess at {p}: {left}; give a nearer guess")
    orbit = sticking_orbit(word, p, found)
    if repeats(orbit):
        raise OrbitNotFound(f"no {word} orbit from this guess at {p}: it has a shorter period; give another guess")
    return orbit


def no_sticking_orbit(word: Word, p: Params, how: str) -> OrbitNotFound:
    """Return the exception for a word with a star of which none was found."""
    guess = "simulate there and give time and v1 of the release after its first star as guess"
    if any(word.balls) or room_of(p).alongside(p):
        guess = "follow an orbit of this word to there, or settle there and take its word"
    return OrbitNotFound(f"no {word} orbit at {p} ({how}); try other parameters, or {guess}")
