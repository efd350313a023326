"""Attractors that stick at random parameters, each found as an orbit by its word.

Run as ``python -m benchmarks.sticking [points] [seed]``. mu is drawn log-uniformly from .005 to 1, lam from .005 to .4,
A from .01 to 1, Omega from .6 to 1.6 and r from .3 to .9. What `settle` finds from its default start counts if it is
periodic and sticks; of ``L*R*`` no more than six in ten. Each orbit is compared with the simulator in time and state of
every contact and release, and its multipliers with differences in 70 digits by a code of its own.
"""

from __future__ import annotations

import sys
import time
from collections import Counter

import numpy as np

from benchmarks.sticking_in_digits import multipliers_in_digits
from vines.attractors import Attractor, settle
from vines.dynamics import Trajectory, simulate
from vines.errors import OrbitNotFound
from vines.model import STATE_NAMES, Params
from vines.orbits import Orbit, all_orbits, find_orbit

TOLERANCE = 1e-9
MOST_ALIKE = 0.6
RELEASE = 3


def draw(rng: np.random.Generator) -> Params:
    """Return random parameters."""
    return Params(
        mu=10 ** rng.uniform(np.log10(0.005), 0),
        A=rng.uniform(0.01, 1),
        Omega=rng.uniform(0.6, 1.6),
        r=rng.uniform(0.3, 0.9),
        lam=10 ** rng.uniform(np.log10(0.005), np.log10(0.4)),
    )


def followed(attractor: Attractor) -> Trajectory:
    """Return a run over a period of an attractor and a forcing period more."""
    at = {name: attractor.final[name] for name in STATE_NAMES}
    return simulate(attractor.params, **at, phi=attractor.final["phase"], periods=(attractor.p or 1) + 1)


def distance(orbit: Orbit, run: Trajectory) -> float:
    """Return the largest difference of a contact or a release of an orbit to the nearest in time of a run."""
    p, spells, events = orbit.params, orbit.spells, run.events
    at_release = [spells["x1"], spells["v1"], spells["x1"] - spells["side"], spells["v1"]]
    parts = (
        (run.impacts, orbit.t, orbit.states),
        (events[events["kind"] == RELEASE], spells["t_release"], np.column_stack(at_release)),
    )
    least = np.inf
    for shift in range(orbit.word.p):
        worst = 0.0
        for met, times, states in parts:
            for t, state in zip(times, states, strict=True):
                late = met["t"] + run.phi / p.Omega - t - shift * p.period
                late = (late + orbit.period / 2) % orbit.period - orbit.period / 2
                k = int(np.argmin(np.abs(late)))
                there = np.array([met[name][k] for name in STATE_NAMES])
                worst = max(worst, abs(float(late[k])), float(np.abs(there - state).max()))
        least = min(least, worst)
    return float(least)


def orbit_of(attractor: Attractor, run: Trajectory) -> tuple[str, Orbit | None, float]:
    """Return how the orbit of an attractor is found, the orbit, and its distance."""
    p, word = attractor.params, str(attractor.word)
    best: tuple[float, Orbit | None] = (np.inf, None)
    try:
        orbit = find_orbit(word, p)
        best = (distance(orbit, run), orbit)
        if best[0] < TOLERANCE:
            return "find_orbit", orbit, best[0]
        for orbit in all_orbits(word, p):
            best = min(best, (distance(orbit, run), orbit), key=lambda each: each[0])
        if best[0] < TOLERANCE:
            return "another of all_orbits", best[1], best[0]
    except OrbitNotFound:
        pass
    events = run.events
    for event in events[events["kind"] == RELEASE]:
        try:
            orbit = find_orbit(word, p, guess=[event["phase"] / p.Omega, event["v1"]])
        except OrbitNotFound:
            continue
        best = min(best, (distance(orbit, run), orbit), key=lambda each: each[0])
    return ("find_orbit with a release as guess" if best[0] < TOLERANCE else "missed"), best[1], best[0]


def study(points: int, seed: int) -> None:
    """Print what is found at random points, until so many attractors stick."""
    rng = np.random.default_rng(seed)
    how: Counter[str] = Counter()
    words: Counter[str] = Counter()
    left: Counter[str] = Counter()
    apart, wrong, open_, times = 0.0, 0.0, 0.0, []
    while sum(how.values()) < points:
        attractor = settle(draw(rng), lyapunov=False, tolerance=1e-11, watch=64, max_impacts_per_period=3000)
        if attractor.regime != "periodic" or not attractor.recurrent_sticking:
            left["periodic without sticking" if attractor.regime == "periodic" else attractor.regime] += 1
            continue
        word = str(attractor.word)
        if word == "L*R*" and words[word] >= MOST_ALIKE * points:
            left["L*R* beyond their share"] += 1
            continue
        run = followed(attractor)
        began = time.process_time()
        where, orbit, miss = orbit_of(attractor, run)
        times.append(time.process_time() - began)
        how[where] += 1
        words[word] += 1
        if orbit is None or where == "missed":
            print(f"missed: {word} at {attractor.params}, nearest {miss:.2g}", flush=True)
            continue
        defect, exact = multipliers_in_digits(orbit)
        # Coefficients of the polynomial: multipliers that meet are right to half the digits only.
        error = float(np.abs(np.poly(exact) - np.poly(orbit.multipliers[:2])).max())
        if error > TOLERANCE:
            print(
                f"multipliers: {word} at {attractor.params}, {error:.2g}, largest {orbit.max_multiplier:.3g}",
                flush=True,
            )
        apart, wrong, open_ = max(apart, miss), max(wrong, error), max(open_, defect)
    for title, counts in (("found", how), ("words", words), ("left out", left)):
        print(f"{title}: {', '.join(f'{count} {name}' for name, count in counts.most_common())}")
    print(f"largest distance from the simulator: {apart:.2g}")
    print(f"largest error of the multipliers' polynomial: {wrong:.2g}; of closing, in 70 digits: {open_:.2g}")
    print(f"processor seconds a search: median {np.median(times):.2f}, largest {max(times):.1f}")


if __name__ == "__main__":
    study(*(int(word) for word in (sys.argv[1:] + ["200", "18"][len(sys.argv) - 1 :])))
