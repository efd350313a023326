"""Orbits that stick, of one word, by sections of runs: Newton's method from simulations and a grid of releases."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import Trajectory, simulate
from vines.dynamics.kernels import room_of
from vines.dynamics.kernels import rows as col
from vines.dynamics.runs import IN_TURN, TOGETHER
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Word
from vines.orbits._general import check_word, same
from vines.orbits._newton_of_balls import solve_round
from vines.orbits._orbit import Orbit
from vines.orbits._own_word import own_word
from vines.orbits._release_of_balls import Moment, Release, Section, releases_among, run_on, run_round
from vines.orbits._release_of_one import release_on, rides_alone
from vines.orbits._seeds import starts_of
from vines.orbits._sticking_of_balls import Begun, balls_orbit, mirrored_balls
from vines.orbits._sticking_search import repeats

__all__ = ["refine_balls", "search_balls", "sections_of"]

Floats = npt.NDArray[np.float64]

_PERIODS = 200
"""Forcing periods of each simulation, beside ten of those of the orbit."""

_DRAWN = 5
"""Simulations from starts that are drawn, beside those that begin in the middle."""

_DRAWN_BESIDE = 25
"""The same where more than ball and frame moves, and no grid of releases is tried."""

_LATE = 12
"""Sections of each simulation that are tried, the last ones."""

_QUICK = 40
"""Rounds that Newton's method may take from a section of a simulation or of a grid."""

_ROUNDS = 400
"""The same from a guess."""

_GRID = 32
"""Phases, and velocities, of releases of all balls at once that are tried."""

_BEST = 40
"""Releases of the grid that Newton's method begins with: those that come back nearest among their neighbours."""

_MARGIN = 1.5
"""By how much releases of the grid may be faster than any seen in the simulations."""

_ALIKE = 1e-7
"""Difference of coordinates of sections that lead to one orbit."""


def search_balls(word: Word, p: Any) -> tuple[list[Orbit], str]:
    """Return the different orbits of a word with a star that are found, each once, and how they were searched for."""
    also = " and from a grid of releases of all balls" if any(_all_ride(word, p, IN_TURN)) else ""
    how = f"Newton's method from simulations{also}: there may be more"
    found = _searched(word, p, IN_TURN)
    if not found and len(set(getattr(p, "beta", (1.0,)))) < getattr(p, "balls", 1):
        # Equal cavities: what arrives together after a common release may also be struck at once.
        found = _searched(word, p, TOGETHER)
        how += "; balls that arrive together are struck at once"
    return found, how


def _searched(word: Word, p: Any, ties: str) -> list[Orbit]:
    found: list[Orbit] = []
    tried: list[tuple[Section, Floats]] = []
    runs = [
        simulate(p, **start, periods=_PERIODS + 10 * word.p, max_impacts_per_period=2000, ties=ties)
        for start in _starts(p)
    ]
    for run in runs:
        for section, z in sections_of(run, ties, 2 * word.p):
            _add(found, tried, word, p, section, z)
            if p.mirrored and own_word(word.mirror, p) != word:
                _add(found, tried, word, p, section.mirrored, section.image(z))
    for section in _all_ride(word, p, ties):
        # Over half a period more releases lead to the contacts of a symmetric orbit.
        for mirrored in (True, False) if p.mirrored and word.symmetric else (False,):
            for z in _of_grid(word, p, section, _fastest(runs, p), mirrored):
                _add(found, tried, word, p, section, z, mirrored)
    if p.mirrored and own_word(word.mirror, p) == word:
        for orbit in [orbit for orbit in found if not orbit.symmetric]:
            image = mirrored_balls(orbit)
            if not any(same(known, image.t, image.states) for known in found):
                found.append(image)
    return found


def _starts(p: Any) -> Iterator[dict[str, Any]]:
    """Yield starts: balls in the middle at several speeds, and some that are drawn."""
    yield from starts_of(p)
    rng = np.random.default_rng(_DRAWN)
    for _ in range(_DRAWN_BESIDE if _moves_beside(p) else _DRAWN):
        yield room_of(p).draw(p, rng)


def sections_of(run: Trajectory, ties: str, periods: float) -> Iterator[tuple[Section, Floats]]:
    """Yield sections at the end of a run, the last first: releases, or where there is none the middle of a flight.

    Parameters
    ----------
    run : ParallelRun
    ties : str
        How it was run.
    periods : float
        Forcing periods before its end in which a release has to come.
    """
    p, rows = run.params, run.rows
    late = rows[:, col.TIME] > run.t_end - periods * p.period
    met = [(i, section) for i, section in _releases(p, rows, ties) if late[i]]
    for i, section in met[: -_LATE - 1 : -1]:
        yield section, section.read(rows[i])
    # A ball alone that comes to ride is let go, or rides on for ever.
    if met or rides_alone(p) or not (rows[late, col.KIND] == col.STICK).any():
        return
    lasts = np.append(rows[1:, col.TAU], 0.0) * late * (rows[:, col.MODE] == 0.0)
    row, half = rows[int(np.argmax(lasts))], 0.5 * float(lasts.max())
    moment = Moment(float(row[col.PHASE]), ties)
    flown_to = run_on(p, moment, moment.read(row), half)
    if flown_to is not None:
        moment = Moment(float(flown_to[-1, col.PHASE]), ties)
        yield moment, moment.read(flown_to[-1])


def _releases(p: Any, rows: Floats, ties: str) -> Sequence[tuple[int, Release]]:
    """Return the rows of releases, each with its section."""
    return release_on(p, 1).among(rows) if rides_alone(p) else releases_among(rows, p.balls, ties)


def _add(
    found: list[Orbit],
    tried: list[tuple[Section, Floats]],
    word: Word,
    p: Any,
    section: Section,
    z: Floats,
    mirrored: bool = False,
) -> None:
    """Add the orbit that Newton's method finds from a section unless it is there, or its period is shorter."""
    if _known(tried, section, z):
        return
    span = word.p * p.period / (2 if mirrored else 1)
    solved, left = solve_round(p, section, span, z, mirrored, _QUICK)
    again = _known(tried, section, solved)
    tried.extend([(section, z), (section, solved)])
    if again or not math.isfinite(left):
        return
    try:
        orbit = balls_orbit(word, p, Begun(section, solved))
    except OrbitNotFound:
        return
    if not repeats(orbit) and not any(same(known, orbit.t, orbit.states) for known in found):
        found.append(orbit)


def _known(tried: list[tuple[Section, Floats]], section: Section, z: Floats) -> bool:
    return any(known == section and np.abs(z - at).max() < _ALIKE for known, at in tried)


def _all_ride(word: Word, p: Any, ties: str) -> Iterator[Release]:
    """Yield the releases of all balls at once that a word allows: each has a contact there that sticks.

    None where more than ball and frame moves, for which a grid of releases would have too many numbers.
    """
    if _moves_beside(p):
        return
    for side in (1, -1):
        marks = zip(word.sides, word.balls, word.sticks, strict=True)
        riders = {ball for wall, ball, sticks in marks if sticks and wall == side}
        if riders and rides_alone(p):
            yield release_on(p, side)
        elif len(riders) == getattr(p, "balls", 1):
            yield Release(side, tuple(range(p.balls)), p.balls, ties)


def _moves_beside(p: Any) -> bool:
    """Say whether more moves than a frame with one coordinate, and what is between its walls."""
    return rides_alone(p) and room_of(p).layout(p).width > col.ROW


def _fastest(runs: list[Trajectory], p: Any) -> float:
    """Return up to which velocity, beyond that at which the contact force would not fall, releases are looked for."""
    seen = max(float(np.abs(run.rows[:, [col.V1, col.A_V1]]).max()) for run in runs)
    room = room_of(p)
    rates = [
        room.slopes(p, 0.0, 0.0, phase, np.zeros(len(room.alongside(p)))).by_time for phase in (0.0, 0.5 * math.pi)
    ]
    return _MARGIN * seen + math.hypot(*rates)


def _of_grid(word: Word, p: Any, section: Release, fastest: float, mirrored: bool) -> list[Floats]:
    """Return the releases of a grid that come back nearest among their neighbours, the nearest first.

    Half of the grid's velocities lie in the lowest quarter of their range.
    """
    places = (np.arange(_GRID) + 0.5) / _GRID
    span = word.p * p.period / (2 if mirrored else 1)
    target, sign = (section.mirrored, -1.0) if mirrored else (section, 1.0)
    misses = np.full((_GRID, _GRID), math.inf)
    releases = np.empty((_GRID, _GRID, 2))
    for i, phase in enumerate((2.0 * math.pi * places).tolist()):
        for j, speed in enumerate((fastest * places**2).tolist()):
            z = releases[i, j] = (phase, section.still(p, phase) + section.side * speed)
            ran = run_round(p, section, span, np.array(z), target)
            if ran is not None:
                misses[i, j] = np.abs(section.closing(p, ran, span, np.array(z), sign)[0]).max()
    around = np.full((_GRID + 2, _GRID + 2), math.inf)
    around[1:-1, 1:-1] = misses
    around[0, 1:-1], around[-1, 1:-1] = misses[-1], misses[0]
    shifts = [(a, b) for a in (0, 1, 2) for b in (0, 1, 2) if (a, b) != (1, 1)]
    least = np.min([around[a : a + _GRID, b : b + _GRID] for a, b in shifts], axis=0)
    kept = np.argwhere(np.isfinite(misses) & (misses <= least))
    order = np.argsort(misses[kept[:, 0], kept[:, 1]], kind="stable")[:_BEST]
    return [releases[i, j].copy() for i, j in kept[order].tolist()]


def refine_balls(word: Word, p: Any, guess: Orbit | npt.ArrayLike) -> Orbit:
    """Return the orbit that Newton's method finds from an orbit, or of one ball from time and velocity of a release.

    Raises
    ------
    OrbitNotFound
        If it does not converge to an orbit of this word.
    ParameterError
        If the guess does not fit the word.
    """
    if isinstance(guess, Orbit):
        check_word(guess, word)
        section, z = guess.release
    else:
        given = np.asarray(guess, dtype=np.float64)
        one = getattr(p, "balls", 1) == 1 and not room_of(p).alongside(p)
        if not one or given.shape != (2,) or not np.isfinite(given).all():
            numbers = ", or time and v1 of the release after its first star, two numbers" if one else ""
            raise ParameterError(
                f"the guess for {word}, which sticks, has to be an orbit{numbers}; it is "
                f"{np.array2string(given, precision=4, threshold=8)}"
            )
        side = word.sides[word.sticks.index(True)]
        section = release_on(p, side) if rides_alone(p) else Release(side, (0,), 1)
        z = np.array([float(given[0] * p.Omega) % (2 * math.pi), given[1]])
    solved, left = solve_round(p, section, word.p * p.period, z, mirrored=False, most=_ROUNDS)
    if not math.isfinite(left):
        raise OrbitNotFound(f"no {word} orbit from this guess at {p}: Newton's method fails; give a nearer guess")
    orbit = balls_orbit(word, p, Begun(section, solved))
    if repeats(orbit):
        raise OrbitNotFound(f"no {word} orbit from this guess at {p}: it has a shorter period; give another guess")
    return orbit
