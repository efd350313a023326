"""Branch switching for other systems: what comes out is flown by the simulator, and what runs settle to beyond."""

import numpy as np
import pytest

import vines
from vines.orbits import mirror_image, switch_branch
from vines.systems import ImpactPair, Parallel

TWO = Parallel(mu=(0.01, 0.01), beta=(1.0, 1.4), A=0.032)


def flown(orbit):
    """Return by how much the simulator, from just after the first impact on, misses the other impacts."""
    run = vines.simulate(orbit.params, **orbit.start(), periods=orbit.word.p * (1 + 1e-9))
    assert len(run.impacts) == len(orbit.t)
    return np.abs(run.impacts["w_dot"] - np.roll(orbit.w_dot, -1)).max()


@pytest.mark.parametrize(
    ("word", "p", "parameter", "stop", "kind"),
    [
        ("LR", ImpactPair(B=0.75, G=0.0, r=0.5), "B", 0.8, "symmetry_breaking"),
        ("LR", ImpactPair(B=0.95, G=0.05, r=0.5), "B", 1.0, "period_doubling"),
        ("L1R1", Parallel(mu=(0.01,), A=0.0175), "A", 0.0185, "symmetry_breaking"),
        ("L1L2R1R2", TWO, "A", 0.034, "symmetry_breaking"),
    ],
)
def test_the_family_that_comes_out_is_one_of_orbits(word, p, parameter, stop, kind):
    branch = vines.continue_orbit(vines.find_orbit(word, p), parameter, stop)
    at = branch.bifurcations[0]
    assert at.type == kind
    found = switch_branch(at)
    assert all(flown(orbit) < 1e-9 * max(1, orbit.max_multiplier) for orbit in found)
    if kind == "period_doubling":
        (orbit,) = found
        assert orbit.word.p == 2
        assert len(orbit.t) == 2 * len(at.orbit.t)
    else:
        orbit, image = found
        assert not orbit.symmetric
        back = mirror_image(image)
        assert back.word == orbit.word
        assert back.t - back.t[0] == pytest.approx(orbit.t - orbit.t[0], abs=1e-10)
        assert back.w_dot == pytest.approx(orbit.w_dot, abs=1e-10)
    # From the new family back to where it joins.
    far = vines.continue_orbit(orbit, parameter, stop)
    last = far.orbits[-1]
    if last.stable and last.admissible:
        settled = vines.settle(last.params, **last.start(), lyapunov=False)
        assert str(settled.word) == str(last.word)
        assert settled.measures.impacts_per_period == pytest.approx(len(last.t) / last.word.p)
    assert not last.symmetric


def test_a_branch_ends_where_two_balls_hit_together():
    """The asymmetric family comes to where balls 1 and 2 hit L at once: beyond, the order is another word's."""
    branch = vines.continue_orbit(vines.find_orbit("L1L2R1R2", TWO), "A", 0.034)
    far = vines.continue_orbit(switch_branch(branch.bifurcations[0])[0], "A", 0.034)
    assert far.ends[1] == "tie"
    assert far.bifurcations[-1].type == "tie"
    assert 0 < far.orbits[-1].flight_times.min() < 1e-9
    assert all(orbit.admissible for orbit in far.orbits)
    near = far.orbits[-2]
    run = vines.simulate(near.params, **near.start(), periods=1 + 1e-9)
    assert run.impacts["ball"].tolist() == [2, 1, 2, 1]
    beyond = vines.continue_orbit(near, "A", 0.0335, beyond_grazing=True)
    assert not beyond.orbits[-1].admissible


def test_the_pair_at_the_end_of_its_doubled_family_leads_back():
    orbit = vines.find_orbit("LR", ImpactPair(B=0.95, G=0.05, r=0.5))
    at = vines.continue_orbit(orbit, "B", 0.97).bifurcations[0]
    back = vines.continue_orbit(switch_branch(at)[0], "B", 0.95, within=(0.95, 0.97), step=1e-3)
    assert back.ends[1] == "period_doubling"
    assert back.bifurcations[-1].value == pytest.approx(0.96031987596, abs=1e-8)
    (left,) = switch_branch(back.bifurcations[-1])
    assert str(left.word) == "LR"


def doubled(p, word, parameter, *stops):
    """Return the period doubling at the end of a family and an orbit of the doubled one; stops lead to it."""
    branch = vines.continue_orbit(vines.find_orbit(word, p), parameter, stops[0])
    for stop in stops[1:]:
        branch = vines.continue_orbit(switch_branch(branch.bifurcations[0])[0], parameter, stop)
    at = next(each for each in branch.bifurcations if each.type == "period_doubling")
    return at, switch_branch(at)[0]


@pytest.mark.parametrize(
    ("word", "p", "stops", "back"),
    [
        ("LR", ImpactPair(B=0.95, G=0.05, r=0.5), (0.97,), (0.95, 0.9)),
        ("LR", vines.Params(mu=0.01, A=0.0175), (0.0185, 0.021), (0.0204, 0.019)),
        ("L1R1", Parallel(mu=(0.01,), A=0.0175), (0.0185, 0.021), (0.0204, 0.019)),
    ],
    ids=["pair", "vi-nes", "parallel"],
)
@pytest.mark.parametrize("step", [0.02, pytest.param(0.1, marks=pytest.mark.full)])
def test_a_doubled_family_ends_at_its_joint_whatever_the_step(word, p, stops, back, step):
    """Beyond it the old orbits, gone through twice, solve the same equations: a long step may come down on them."""
    parameter = "B" if isinstance(p, ImpactPair) else "A"
    at, orbit = doubled(p, word, parameter, *stops)
    for stop in back:
        ends = vines.continue_orbit(orbit, parameter, stop, step=step)
        assert ends.ends == ("range", "period_doubling")
        (joint,) = ends.bifurcations
        assert joint.value == pytest.approx(at.value, rel=1e-7)
        assert all(flown(each) < 1e-9 * max(1, each.max_multiplier) for each in ends.orbits[:-1])


def test_a_family_that_broke_its_symmetry_ends_where_it_did():
    p = vines.Params(mu=0.01, A=0.0175)
    at = vines.continue_orbit(vines.find_orbit("LR", p), "A", 0.0185).bifurcations[0]
    for step in (0.02, 0.1):
        ends = vines.continue_orbit(switch_branch(at)[0], "A", 0.01, step=step)
        assert ends.ends[1] == "symmetry_breaking"
        assert ends.bifurcations[-1].value == pytest.approx(at.value, rel=1e-7)
