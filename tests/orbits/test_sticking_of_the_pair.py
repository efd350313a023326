"""Orbits of the impact pair that stick: by the words of settling, against another solver, and their ends."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import vines
from vines.dynamics import simulate
from vines.errors import OrbitNotFound, ParameterError
from vines.orbits import all_orbits, continue_orbit, find_orbit, mirror_image
from vines.systems import ImpactPair, Parallel

pytestmark = pytest.mark.long(20)


def attractors(count, seed):
    """Yield random attractors that stick."""
    rng = np.random.default_rng(seed)
    while count:
        tilt = float(rng.choice([0.0, rng.uniform(-0.5, 0.5), rng.uniform(-3.0, 3.0)]))
        p = ImpactPair(B=float(10 ** rng.uniform(-1, 1)), G=tilt, r=float(rng.uniform(0.05, 0.6)))
        found = vines.settle(p, w_dot=float(rng.uniform(-3, 3)), settle=100, patience=0, errors=False)
        if found.regime == "periodic" and found.settled and "*" in found.word:
            count -= 1
            yield found


def compare(found):
    orbit = find_orbit(found.word, found.params)
    assert (str(orbit.word), orbit.stable, orbit.admissible) == (found.word, True, True)
    hits = found.impacts
    for phase, speed in zip(orbit.phase, orbit.w_dot, strict=True):
        away = np.abs((hits["phase"] - phase + math.pi) % (2 * math.pi) - math.pi)
        assert np.min(np.maximum(away, np.abs(hits["w_dot"] - speed))) < 5e-9  # 3.3e-9 was met
    # 1.5e-8 was met, of L*/22T, over 22 or 352 periods: the simulator merges before the chatter is over.
    assert orbit.measures.kinetic_ratio == pytest.approx(found.measures.kinetic_ratio, rel=3e-8)
    assert abs(orbit.energy_imbalance) < 1e-10
    assert orbit.residual < 1e-10
    assert np.all(orbit.multipliers == 0)
    assert np.abs(found.multipliers).max() < 1e-6
    return orbit


def test_random_attractors_that_stick_are_found_by_their_words():
    for found in attractors(12, 18):
        compare(found)


@pytest.mark.full
def test_two_hundred_of_them():
    for found in attractors(200, 19):
        compare(found)


def flown(p, side, contacts):
    """Return phases and relative velocities of the first impacts after a release: hop by hop, by bracketed roots."""
    theta = math.asin(p.G / p.B) if side > 0 else math.pi - math.asin(p.G / p.B)
    w, speed, met = float(side), 0.0, []
    for _ in range(contacts):

        def gap(h, w=w, u=speed, at=theta):
            return w + u * h + p.G * h * h / 2 + p.B * (math.sin(at + h) - math.sin(at) - h * math.cos(at))

        times = np.linspace(1e-4, 7.0, 7000)
        values = np.abs([gap(h) for h in times])
        k = int(np.flatnonzero(values > 1)[0])
        wall = 1.0 if gap(times[k]) > 0 else -1.0
        h = brentq(lambda h, wall=wall: gap(h) - wall, times[k - 1], times[k], xtol=1e-15, rtol=1e-15)
        before = speed + p.G * h + p.B * (math.cos(theta + h) - math.cos(theta))
        met.append((theta + h, before))
        theta, w, speed = theta + h, wall, -p.r * before
    return met


@pytest.mark.parametrize(("word", "G", "contacts"), [("L*R*", 0.0, 4), ("L*", 0.6, 2)])
def test_impacts_after_the_release_are_those_of_another_solver(word, G, contacts):
    p = ImpactPair(B=3.0 if not G else 1.0, G=G, r=0.3)
    orbit = find_orbit(word, p)
    spell = orbit.spells[0]
    start = {"w": float(spell["side"]), "w_dot": 0.0, "phi": float(spell["phase_release"])}
    met = flown(p, spell["side"], contacts)
    # The first of them is the contact after the one that the release belongs to.
    after = orbit.t[(int(spell["contact"]) + 1) % len(orbit.t)]
    assert math.remainder(met[0][0] - after, 2 * math.pi) == pytest.approx(0.0, abs=1e-10)
    assert orbit.w_dot[(int(spell["contact"]) + 1) % len(orbit.t)] == pytest.approx(met[0][1], abs=1e-10)
    hits = simulate(p, **start, periods=1).impacts
    for k, (theta, speed) in enumerate(met):
        assert hits["t"][k] + start["phi"] - theta == pytest.approx(0.0, abs=1e-9)
        assert hits["w_dot"][k] == pytest.approx(speed, abs=1e-9)


def test_a_disturbance_is_gone_after_a_stick():
    p = ImpactPair(B=3.0, G=0.1, r=0.3)
    orbit = find_orbit("L*R*", p)
    at = orbit.start()
    runs = []
    for off in (0.0, 1e-3, -1e-3):
        run = simulate(p, w=at["w"], w_dot=at["w_dot"] + off * np.sign(at["w_dot"]), t=at["t"], periods=3)
        runs.append(run.final)
    assert runs[0] == pytest.approx(runs[1], abs=1e-10)
    assert runs[0] == pytest.approx(runs[2], abs=1e-10)


def test_level_orbits_are_symmetric_and_others_have_mirror_images():
    p = ImpactPair(B=3.0, G=0.0, r=0.3)
    orbit = find_orbit("L*R*", p)
    assert orbit.symmetric
    assert orbit.params.mirrored
    image = mirror_image(orbit)
    assert np.allclose(image.w_dot, orbit.w_dot, atol=1e-12)
    tilted = find_orbit("L*R*", p.replace(G=0.05))
    assert not tilted.symmetric
    with pytest.raises(ParameterError, match="its mirror image is no motion unless G = 0"):
        mirror_image(tilted)


@pytest.mark.parametrize(
    ("word", "parameter", "stop", "p"),
    [
        ("L*R*", "B", 0.3, ImpactPair(B=3.0, r=0.3)),
        ("L*R*", "r", 0.9, ImpactPair(B=3.0, r=0.3)),
        ("L*R*", "G", 2.9, ImpactPair(B=3.0, r=0.3)),
        ("L*", "G", 0.3, ImpactPair(B=1.0, G=0.6, r=0.3)),
    ],
)
def test_a_family_ends_where_its_chatter_is_no_longer_complete(word, parameter, stop, p):
    branch = continue_orbit(find_orbit(word, p), parameter, stop)
    assert branch.ends[1] == "incomplete_chatter"
    (end,) = branch.bifurcations
    inside, outside = branch.values[len(branch.values) // 2], stop
    for _ in range(40):
        middle = (inside + outside) / 2
        if all_orbits(word, p.replace(**{parameter: middle})):
            inside = middle
        else:
            outside = middle
    assert end.value == pytest.approx(inside, abs=2e-7)


def test_what_there_is_not_is_said():
    p = ImpactPair(B=3.0, G=0.0, r=0.3)
    found = all_orbits("L*RRR", p)
    assert not found
    assert found.complete
    with pytest.raises(OrbitNotFound, match="fixes all that follows: there is no other"):
        find_orbit("L*RRR", p)
    with pytest.raises(OrbitNotFound, match=r"no L\*R\* orbit at B = 0.1"):
        find_orbit("L*R*", p.replace(B=0.1))
    # Where gravity always holds the ball it is never let go.
    assert not all_orbits("L*", ImpactPair(B=0.5, G=0.6, r=0.3))
    # Half a repetition is no orbit of two periods.
    assert not all_orbits("L*R*L*R*/2T", p)
    with pytest.raises(OrbitNotFound, match="follow an orbit of this word to there"):
        find_orbit("L1*R1*L2R2", Parallel(mu=(0.01, 0.01), A=0.9))
