"""Orbits that stick: by their words, against the simulator, and against differences in 70 digits by another code."""

import numpy as np
import pytest

from benchmarks.sticking import distance, followed
from benchmarks.sticking_in_digits import multipliers_in_digits
from vines.attractors import settle
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params, Word
from vines.orbits import (
    all_orbits,
    bifurcation_row,
    continue_orbit,
    find_orbit,
    mirror_image,
    optimise,
    orbit_row,
    switch_branch,
)
from vines.orbits._floquet import monodromy
from vines.orbits._sticking_ends import chatter_exponent
from vines.systems import Parallel

# The case of the issue: settle gives a stable 1:1 that sticks, the orbit LR is inadmissible.
P = Params(mu=0.0256654, A=0.965717, Omega=1.02946, r=0.347164, lam=0.0959532)


@pytest.fixture(scope="module")
def symmetric():
    return find_orbit("L*R*", P)


def test_the_word_of_an_attractor_that_sticks_leads_to_its_orbit(symmetric):
    attractor = settle(P, lyapunov=False)
    assert (attractor.word, attractor.name) == ("L*R*", "1:1")
    assert distance(symmetric, followed(attractor)) < 1e-10
    assert (symmetric.name, symmetric.symmetric, symmetric.stable, symmetric.admissible) == ("1:1", True, True, True)
    # A pair of them, in one order or the other.
    by_size = sorted(attractor.multipliers, key=lambda m: (-round(abs(m), 6), -m.imag))
    assert symmetric.multipliers == pytest.approx(by_size, abs=1e-9)
    assert symmetric.measures.kinetic_ratio == pytest.approx(attractor.measures.kinetic_ratio, rel=1e-10)
    assert symmetric.measures.max_abs_x1 == pytest.approx(attractor.measures.max_abs_x1, rel=1e-10)


def test_a_word_without_a_star_is_an_orbit_that_never_sticks():
    orbit = find_orbit("LR", P)
    assert not orbit.admissible
    assert orbit.max_multiplier == pytest.approx(10.0342, abs=1e-4)
    assert len(orbit.spells) == 0


@pytest.mark.parametrize(
    ("word", "values"),
    [
        ("LR*/3T", (0.094932, 0.278737, 1.479651, 0.338529, 0.097824)),
        ("L*RLR*LR/7T", (0.019384, 0.063625, 0.853112, 0.439535, 0.029383)),
    ],
)
def test_multipliers_agree_with_differences_in_many_digits(word, values):
    orbit = find_orbit(word, Params(*values))
    defect, exact = multipliers_in_digits(orbit)
    assert defect < 1e-11
    assert np.poly(orbit.multipliers[:2]) == pytest.approx(np.poly(exact), abs=1e-11)
    assert not np.any(orbit.multipliers[2:])
    assert abs(orbit.energy_imbalance) < 1e-12
    # From contact to contact the Jacobians say the same.
    assert np.poly(monodromy(orbit.jacobians)) == pytest.approx(np.poly(orbit.multipliers), abs=1e-9)


def test_spells_lie_between_their_contact_and_the_next(symmetric):
    spells = symmetric.spells
    assert spells["contact"].tolist() == [0, 1]
    assert spells["side"].tolist() == [1, -1]
    following = np.append(symmetric.t[1:], symmetric.t[0] + symmetric.period)
    assert np.all((symmetric.t < spells["t_start"]) & (spells["t_start"] < spells["t_release"]))
    assert np.all(spells["t_release"] < following)
    force = P.A * np.sin(spells["phase_release"]) + P.lam * P.Omega * P.A * np.cos(spells["phase_release"])
    assert force - P.lam * spells["v1"] - spells["x1"] == pytest.approx(np.zeros(2), abs=1e-12)


def test_the_mirror_image_sticks_on_the_other_wall():
    orbit = find_orbit("LR*/3T", Params(0.094932, 0.278737, 1.479651, 0.338529, 0.097824))
    image = mirror_image(orbit)
    assert image.word == Word("L*R/3T")
    assert image.spells["side"].tolist() == [1]
    assert image.multipliers == pytest.approx(orbit.multipliers, abs=1e-10)
    assert mirror_image(image).t == pytest.approx(orbit.t, abs=1e-9)


def test_a_family_ends_where_the_chatter_no_longer_completes(symmetric):
    branch = continue_orbit(symmetric, "A", 0.4)
    assert branch.ends == ("range", "incomplete_chatter")
    end = branch.bifurcations[-1]
    assert end.value == pytest.approx(0.44865640, abs=1e-7)
    finer = continue_orbit(symmetric, "A", 0.4, step=0.007).bifurcations[-1]
    assert finer.value == pytest.approx(end.value, abs=5e-9)
    # What the simulator settles to on either side, as near as its transients allow.
    assert settle(P.replace(A=end.value + 2e-5), lyapunov=False).word == "L*R*"
    assert settle(P.replace(A=end.value - 2e-5), lyapunov=False).word != "L*R*"
    assert bifurcation_row(end)["type"] == "incomplete_chatter"
    assert orbit_row(branch.orbits[-1])["word"] == "L*R*"


def test_the_stick_vanishes_with_the_power_that_self_similar_chatter_has(symmetric):
    end = continue_orbit(symmetric, "A", 0.4).bifurcations[-1].value
    lengths = []
    for distance_to_end in (1e-3, 1e-5):
        orbit = find_orbit("L*R*", P.replace(A=end + distance_to_end))
        lengths.append(float(orbit.spells["t_release"][0] - orbit.spells["t_start"][0]))
    slope = np.log(lengths[0] / lengths[1]) / np.log(1e2)
    assert slope == pytest.approx(chatter_exponent(P.r), abs=0.02)


def test_a_doubling_of_an_orbit_that_sticks_is_located_and_switched_to():
    p = Params(0.8927069718817235, 0.229, 1.5476949944225313, 0.3075722116385005, 0.011377788790321171)
    branch = continue_orbit(find_orbit("LLR*/5T", p), "A", 0.26)
    assert [each.type for each in branch.bifurcations] == ["period_doubling", "grazing"]
    assert branch.bifurcations[0].multiplier == pytest.approx(-1, abs=1e-9)
    (doubled,) = switch_branch(branch.bifurcations[0])
    assert (str(doubled.word), doubled.stable) == ("LLR*LLR*/10T", True)
    assert branch.bifurcations[-1].orbit.min_clearance < 1e-5 or np.min(branch.bifurcations[-1].orbit.w_dot) < 1e-3


def test_a_guess_is_an_orbit_or_a_release(symmetric):
    near = P.replace(A=0.96)
    from_orbit = find_orbit("L*R*", near, guess=symmetric)
    spell = symmetric.spells[0]
    from_release = find_orbit("L*R*", near, guess=[spell["t_release"], spell["v1"]])
    assert from_release.t == pytest.approx(from_orbit.t, abs=1e-10)
    with pytest.raises(ParameterError, match="two numbers"):
        find_orbit("L*R*", P, guess=[0.1, 0.2, 0.3])


def test_what_is_not_there_is_said():
    with pytest.raises(OrbitNotFound, match="there may be more"):
        find_orbit("L*RR", P)
    with pytest.raises(OrbitNotFound, match="time and v1 of the release after its first star"):
        find_orbit("L*R", Parallel(mu=(0.01,), A=0.5, G=0.01))
    assert all_orbits("L*L*", P).complete
    with pytest.raises(ParameterError, match="sticks, for which this is not made"):
        optimise("L*R*", "max_abs_x1", P, {"A": (0.5, 1.0)})
