"""Whatever periodic attractor the simulator settles to, the orbit of its word is the same, at random parameters.

The full study (`-m full`) prints how many orbits `find_orbit` returns without a guess; see docs/orbits.md, "Against the
simulator".
"""

from collections import Counter
from dataclasses import dataclass

import numpy as np
import pytest

from vines.attractors import settle
from vines.errors import OrbitNotFound
from vines.model import Params, Word
from vines.orbits import all_orbits, find_orbit, mirror_image

SEED = 2026
MOST_IMPACTS = 12
TOLERANCE = 1e-10
MOST_ONE_TO_ONE = 0.6
"""Share of 1:1 at most, so that other types are seen; more of them are rejected."""


@dataclass
class Study:
    """Counts of a run of the study: where orbits were found, and why points were rejected."""

    found: Counter
    rejected: Counter
    names: Counter
    worst: float = 0.0

    @property
    def points(self):
        return sum(self.found.values())

    @property
    def not_one_to_one(self):
        return 1 - self.names["1:1"] / self.points


def random_params(rng):
    return Params(
        mu=10 ** rng.uniform(np.log10(0.005), 0),
        A=rng.uniform(0.01, 1),
        Omega=rng.uniform(0.6, 1.6),
        r=rng.uniform(0.3, 0.9),
    )


def rejection(attractor):
    """Return why a point has no attractor of the kind that the study is about, None if it has one."""
    if attractor.regime != "periodic" or not attractor.settled:
        return attractor.regime
    if attractor.sticks > 0:
        return "sticks"
    if attractor.n + attractor.m > MOST_IMPACTS:
        return f"more than {MOST_IMPACTS} impacts"
    return None


def attractor_times(attractor, word):
    """Return impact times of one period of an attractor in the order of its word, for a forcing of phase zero at 0."""
    hits, p = attractor.impacts, attractor.params
    letters = "".join("L" if side > 0 else "R" for side in hits["side"])
    last = letters.rindex(word.letters)
    flights = hits["t"][last : last + len(word)] - hits["t"][last]
    return hits["phase"][last] / p.Omega + flights


def distance(orbit, attractor):
    """Return the largest difference, in any state, phase or flight time, of an orbit to an attractor."""
    hits, N = attractor.impacts, len(orbit.t)
    states = np.column_stack([hits[name] for name in ("x1", "v1", "x2", "v2")])
    least = np.inf
    for last in range(len(hits) - N - 1, len(hits) - 2 * N - 1, -1):
        if last < 0 or not np.array_equal(hits["side"][last : last + N], orbit.side):
            continue
        phases = hits["phase"][last : last + N] - orbit.phase
        flights = np.diff(hits["t"][last : last + N + 1]) - orbit.flight_times
        least = min(
            least,
            max(
                np.abs(states[last : last + N] - orbit.states).max(),
                np.abs((phases + np.pi) % (2 * np.pi) - np.pi).max(),
                np.abs(flights).max(),
            ),
        )
    return float(least)


def how_found(attractor):
    """Return how the orbit of an attractor is found, and the distance between the two."""
    word, p = Word(attractor.word), attractor.params
    try:
        orbit = find_orbit(word, p)
    except OrbitNotFound:
        orbit = None
    if orbit is not None:
        miss = distance(orbit, attractor)
        if miss < TOLERANCE:
            return "find_orbit", miss
        if word.mirror == word and distance(mirror_image(orbit), attractor) < TOLERANCE:
            return "find_orbit, mirror image", distance(mirror_image(orbit), attractor)
        miss = min(distance(other, attractor) for other in all_orbits(word, p))
        if miss < TOLERANCE:
            return "another of all_orbits", miss
    orbit = find_orbit(word, p, guess=attractor_times(attractor, word))
    return "find_orbit with the attractor as guess", distance(orbit, attractor)


def study(points):
    """Compare simulator and orbits at `points` random points that settle to a periodic attractor."""
    rng = np.random.default_rng(SEED)
    done = Study(Counter(), Counter(), Counter())
    while done.points < points:
        # Tighter than the comparison: the distance to the attractor must not be what is compared.
        attractor = settle(random_params(rng), lyapunov=False, tolerance=1e-11, max_impacts_per_period=500)
        why = rejection(attractor)
        if why is None and attractor.name == "1:1" and done.names["1:1"] >= MOST_ONE_TO_ONE * points:
            why = f"1:1 beyond {MOST_ONE_TO_ONE:.0%}"
        if why is not None:
            done.rejected[why] += 1
            continue
        how, miss = how_found(attractor)
        assert miss < TOLERANCE, (attractor.params, attractor.word, how, miss)
        done.found[how] += 1
        done.names[attractor.name] += 1
        done.worst = max(done.worst, miss)
    return done


def test_every_attractor_is_an_orbit_of_its_word():
    done = study(16)
    assert done.found["find_orbit with the attractor as guess"] <= 1
    assert done.not_one_to_one >= 0.4


@pytest.mark.full
def test_every_attractor_is_an_orbit_of_its_word_in_full():
    done = study(200)
    print(f"\n{done.points} points, {done.not_one_to_one:.0%} not 1:1, largest difference {done.worst:.1e}")
    for title, counts in (("found by", done.found), ("rejected", done.rejected), ("types", done.names)):
        print(f"{title}: " + ", ".join(f"{name} {count}" for name, count in counts.most_common()))
    assert done.found["find_orbit with the attractor as guess"] <= 4
    assert done.not_one_to_one >= 0.4
