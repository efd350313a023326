"""An orbit that sticks, of balls in parallel or of another system than the VI-NES, from a section of it.

docs/sticking.md, "Balls in parallel" and "A coil, friction or a spring".
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants, room_of, tangent_product, window_totals
from vines.dynamics.kernels import rows as col
from vines.dynamics.parallel import ParallelConstants
from vines.dynamics.parallel.kernels import BALL, R_X2
from vines.dynamics.runs import measures_from
from vines.errors import OrbitNotFound
from vines.model import STOPS, Word
from vines.orbits._assemble import asymmetry, begun_first
from vines.orbits._contacts import completes, contacts, mark, slowest_followed
from vines.orbits._floquet import sorted_multipliers, squared
from vines.orbits._newton_of_balls import solve_round
from vines.orbits._orbit import SPELL, Orbit
from vines.orbits._own_word import own_word
from vines.orbits._release_of_balls import Ran, Section, run_on, run_round
from vines.orbits._release_of_one import LetGo, rides_alone
from vines.orbits._riding_alone import clearance_of_one, fall_of_one, least_of_one
from vines.orbits._riding_of_balls import clearance_of_balls, fall_of_balls, least_of_balls

__all__ = ["Begun", "balls_orbit", "by_sections", "mirrored_balls"]

Floats = npt.NDArray[np.float64]

_SAME = 1e-9
"""Largest difference, in any component, of an orbit to its mirror image that counts as symmetric."""

_ALMOST = 1e-5
"""The same before the symmetric solution is computed as such; also within which a contact is found again."""

_LETTERS = {1: "L", -1: "R", 0: STOPS}


class Begun(NamedTuple):
    """A section of an orbit, and the coordinates there."""

    section: Section
    z: Floats


class _Contacts(NamedTuple):
    """Contacts of a round in the order of the word: their rows, and how far the first one is turned on."""

    places: list[int]
    t: Floats
    states: Floats


def by_sections(p: Any) -> bool:
    """Say whether orbits of a system that stick are found by its sections: all but the VI-NES and the impact pair."""
    return rides_alone(p) or isinstance(constants(p), ParallelConstants)


def balls_orbit(word: Word, p: Any, release: Begun, remark: str = "") -> Orbit:
    """Return the orbit of a release that comes back.

    Where the orbit is all but its own mirror image the symmetric one is computed as such.

    Raises
    ------
    OrbitNotFound
        If from there other contacts come.
    """
    section, z = release
    ran, met = _whole(word, p, section, z)
    half = None
    duration = word.p * p.period
    if p.mirrored and asymmetry(word, duration, met.t, met.states) < _ALMOST:
        found, left = solve_round(p, section, duration / 2, z, mirrored=True, most=40)
        again = run_round(p, section, duration / 2, found, section.mirrored) if math.isfinite(left) else None
        if again is not None and np.abs(found - z)[1:].max() < 10 * _ALMOST:
            z = found
            ran, met = _whole(word, p, section, z)
            half = section.mirror(z) @ again.slopes
    return _assembled(word, p, Begun(section, z), ran, met, half, remark)


def _whole(word: Word, p: Any, section: Section, z: Floats) -> tuple[Ran, _Contacts]:
    """Return the round of a release and its contacts.

    Raises
    ------
    OrbitNotFound
        If they are not those of the word.
    """
    ran = run_round(p, section, word.p * p.period, z, section)
    met = None if ran is None else _ordered(word, p, section, z, ran)
    if ran is None or met is None:
        raise OrbitNotFound(f"no {word} orbit at {p}: from there other contacts come; give a nearer guess")
    return ran, met


def _ordered(word: Word, p: Any, section: Section, z: Floats, ran: Ran) -> _Contacts | None:
    """Return the contacts of a round in the order of the word, None if they are others."""
    marks, places = _read(p, section, z, ran)
    if len(marks) != len(word):
        return None
    several = getattr(p, "balls", 1) > 1
    text = "".join(f"{_LETTERS[side]}{ball if several else ''}{'*' * star}" for side, ball, star in marks)
    if own_word(f"{text}/{word.p}T", p) != word:
        return None
    names = Word(f"{text}/{word.p}T").relabelled(p.alike)[1] if several else {}
    own = [(side, names.get(ball, ball) if several else 0, star) for side, ball, star in marks]
    wanted = list(zip(word.sides, word.balls, word.sticks, strict=True))
    t = section.phase(z) / p.Omega + ran.rows[places, col.TIME]
    starts = [k for k in range(len(own)) if own[k:] + own[:k] == wanted]
    k, t = begun_first(starts, word, p, t)
    room = room_of(p)
    width = room.layout(p).width
    kept = [col.X1, col.V1, col.X2, col.V2, *range(width - len(room.beside), width)]
    states = ran.rows[places][:, kept]
    return _Contacts([*places[k:], *places[:k]], t, np.concatenate([states[k:], states[:k]]))


def _read(p: Any, section: Section, z: Floats, ran: Ran) -> tuple[list[tuple[int, int, bool]], list[int]]:
    """Return wall, ball and star of each contact of a round, and its row."""
    own, span = ran.rows, ran.lasts
    if not section.flyers:
        places = contacts(own, len(own), 0.0).tolist()
        return [_mark(own, i) for i in places], places
    # The contact of a ball that flies may have begun before, or end after the round: a round later all are whole.
    rows = run_on(p, section, z, 3.2 * span)
    if rows is None:
        return [], []
    late = [i for i in contacts(rows, len(rows), span).tolist() if rows[i, col.TIME] <= 2.0 * span]
    hits = np.flatnonzero(own[:, col.KIND] == col.IMPACT)
    found: list[tuple[int, tuple[int, int, bool]]] = []
    for i in late:
        same = hits[(own[hits, BALL] == rows[i, BALL]) & (own[hits, col.SIDE] == rows[i, col.SIDE])]
        if len(same) == 0:
            return [], []
        place = int(same[np.argmin(np.abs(own[same, col.TIME] + span - rows[i, col.TIME]))])
        if abs(own[place, col.TIME] + span - rows[i, col.TIME]) > _ALMOST:
            return [], []
        found.append((place, _mark(rows, i)))
    found.sort()
    return [each for _, each in found], [place for place, _ in found]


def _mark(rows: Floats, i: int) -> tuple[int, int, bool]:
    number = int(mark(rows, i))
    return (number > 0) - (number < 0), abs(number), number != 0 and bool(completes(rows, len(rows), i))


def _assembled(word: Word, p: Any, release: Begun, ran: Ran, met: _Contacts, half: Floats | None, remark: str) -> Orbit:
    section, z = release
    c, rows = constants(p), ran.rows
    duration = word.p * p.period
    twice = np.concatenate([rows, rows[1:]])
    turn_at = met.places.index(min(met.places))
    in_time = np.array([*met.places[turn_at:], *met.places[:turn_at]])
    ends = np.append(in_time, in_time[0] + len(rows) - 1)
    jacobians = np.stack([tangent_product(c, twice, a, b) for a, b in pairwise(ends.tolist())])
    jacobians = np.roll(jacobians, turn_at, axis=0)
    symmetric = half is not None and asymmetry(word, duration, met.t, met.states) < _SAME
    nothing = np.zeros(jacobians.shape[1] - len(z), dtype=np.complex128)
    half_multipliers = None
    if symmetric and half is not None:
        half_multipliers = np.concatenate([sorted_multipliers(half), nothing])
        multipliers = squared(half_multipliers)
    else:
        multipliers = np.concatenate([sorted_multipliers(ran.slopes), nothing])
    spells = _spells(word, p, twice, met)
    instant = struck = None
    if not rides_alone(p):
        instant, struck = _instant(rows, met.places[0]), rows[met.places][:, [col.A_V1, col.A_V2]]
    elif isinstance(section, LetGo) and rows.shape[1] > col.ROW:
        first = rows[met.places[0]]
        instant = np.append(first[[col.X1, col.A_V1, col.X2, col.A_V2]], section.beside(first))
    for array in (met.t, met.states, jacobians, spells, instant, struck):
        if array is not None:
            array.setflags(write=False)
    return Orbit(
        word=word,
        params=p,
        t=met.t,
        states=met.states,
        jacobians=jacobians,
        multipliers=multipliers,
        half_multipliers=half_multipliers,
        symmetric=symmetric,
        admissible=True,
        min_clearance=(clearance_of_one if rides_alone(p) else clearance_of_balls)(p, rows),
        violation_time=math.nan,
        violation_side=0,
        residual=float(np.abs(section.closing(p, ran, duration, z, 1.0)[0]).max()),
        measures=measures_from(p, window_totals(c, rows, len(rows), 0.0, float(rows[-1, col.TIME]))),
        remark=remark,
        spells=spells,
        instant=instant,
        struck=struck,
        release=release,
    )


def _instant(rows: Floats, place: int) -> Floats:
    """Return x1, v1, and x2, v2 of each ball, after all that happens at the time of a contact."""
    last = place
    while last + 1 < len(rows) and rows[last + 1, col.TAU] == 0.0:
        last += 1
    return np.append(rows[last, [col.X1, col.A_V1]], rows[last, R_X2:])


def _spells(word: Word, p: Any, twice: Floats, met: _Contacts) -> npt.NDArray[np.void]:
    """Return the spells of sticking in the order of the contacts: of each the last, at whose end the ball leaves."""
    least, fall = (least_of_one, fall_of_one) if rides_alone(p) else (least_of_balls, fall_of_balls)
    starred = [k for k, sticks in enumerate(word.sticks) if sticks]
    out = np.empty(len(starred), dtype=SPELL)
    for spell, k in zip(out, starred, strict=True):
        place = met.places[k]
        own = [i for i in range(place, len(twice)) if _whose(twice[i]) == _whose(twice[place])]
        until = next((i for i in own[1:] if _leaves(twice, i, twice[place, col.SIDE])), own[-1])
        merges = [i for i in own if i < until and twice[i, col.KIND] == col.STICK]
        stick = merges[-1]
        ends = next(i for i in own if i > stick)
        hits = [i for i in own if i < merges[0] and twice[i, col.KIND] == col.IMPACT]
        begin, end = twice[stick], twice[ends]
        natural = end[col.KIND] == col.RELEASE and end[col.V1] == end[col.V2]
        spell["contact"], spell["side"], spell["impacts"] = k, begin[col.SIDE], len(hits)
        lap = (0.0, float(twice[len(twice) // 2, col.TIME]))
        shift = met.t[k] - float(twice[place, col.TIME])
        spell["t_start"] = shift + begin[col.TIME] + lap[stick > len(twice) // 2]
        spell["t_release"] = shift + end[col.TIME] + lap[ends > len(twice) // 2]
        spell["phase_start"], spell["phase_release"] = begin[col.PHASE], end[col.PHASE]
        spell["x1"], spell["v1"] = end[col.X1], end[col.V1]
        spell["slowest"] = slowest_followed(twice[hits])
        spell["falls"] = fall(p, end) if natural else math.inf
        rides = [(twice[i], float(twice[i + 1, col.TAU])) for i in range(stick, ends)]
        spell["least_force"] = min(least(p, row, tau) for row, tau in rides)
    return out


def _whose(row: Floats) -> float:
    """Return the number of the ball of an event, where there is one alone 0; -1 where a flight is begun afresh."""
    if row[col.KIND] not in (col.IMPACT, col.STICK, col.RELEASE, col.STOP):
        return -1.0
    return float(row[BALL]) if len(row) > col.ROW else 0.0


def _leaves(rows: Floats, i: int, side: float) -> bool:
    """Say whether a ball is let go at a row, or hits the other wall."""
    row = rows[i]
    if row[col.KIND] == col.RELEASE:
        return bool(row[col.V1] == row[col.V2])
    return bool(row[col.KIND] == col.IMPACT and row[col.SIDE] != side)


def mirrored_balls(orbit: Orbit) -> Orbit:
    """Return the mirror image of an orbit that sticks.

    Raises
    ------
    OrbitNotFound
        If its release leads elsewhere.
    """
    section, z = orbit.release
    word = own_word(orbit.word.mirror, orbit.params)
    return balls_orbit(word, orbit.params, Begun(section.mirrored, section.image(z)), orbit.remark)
