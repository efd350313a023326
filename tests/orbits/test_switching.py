"""From one family to the next: branch switching, cascades, and the question of the paper's section 5.1."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from vines.dynamics import simulate
from vines.dynamics._room import constants
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params
from vines.orbits import (
    branch_row,
    continue_orbit,
    find_orbit,
    follow_cascade,
    mirror_image,
    switch_branch,
)
from vines.orbits._criticality import branching_curvature
from vines.orbits._defining import turnings_kernel
from vines.orbits._general import refine
from vines.orbits._joined import is_joint, unfolded

P = Params(mu=0.01, A=0.015)


@pytest.fixture(scope="module")
def cascade():
    return follow_cascade(find_orbit("LR", P), "A", 0.024, depth=3)


@pytest.fixture(scope="module")
def two_to_one():
    return continue_orbit(find_orbit("LLR", P.replace(A=0.023)), "A", 0.0205, within=(0.0205, 0.1), step=0.005)


def test_a_broken_symmetry_gives_a_pair_of_mirror_images(cascade):
    one, other = switch_branch(cascade[0].bifurcations[0])
    assert (one.word, one.symmetric, one.stable, other.stable) == (other.word, False, True, True)
    assert max(one.residual, other.residual) < 1e-13
    back = mirror_image(other)
    np.testing.assert_allclose(back.states, one.states, atol=1e-14)
    np.testing.assert_allclose(back.phase, one.phase, atol=1e-13)
    assert abs(one.flight_times - other.flight_times).max() > 1e-3


def test_the_image_that_comes_first_does_not_depend_on_rounding(cascade):
    bifurcation = cascade[0].bifurcations[0]
    one, other = switch_branch(bifurcation)
    assert one.states[:, 0].mean() > 0 > other.states[:, 0].mean()
    # The orbit there half a period later is its own mirror image with rounding errors of its own.
    for moved in (mirror_image(bifurcation.orbit), mirror_image(mirror_image(bifurcation.orbit))):
        again, _ = switch_branch(replace(bifurcation, orbit=moved))
        np.testing.assert_allclose(again.states, one.states, atol=1e-7)
    assert all(orbit.states[:, 0].mean() > 0 for branch in cascade[1:] for orbit in branch.orbits[1:])


def test_next_to_a_branching_at_resonance_newton_ends_whatever_the_rounding():
    """Without the ball x1 is 42 there: the equations are sums of such parts, and their defect is no smaller."""
    branch = continue_orbit(find_orbit("LR", Params(mu=0.72, A=0.5)), "mu", 0.73)
    [breaking] = branch.bifurcations
    assert breaking.value == pytest.approx(0.726793320568, abs=1e-9)
    rng = np.random.default_rng(1)
    for orbit in switch_branch(breaking):
        for _ in range(20):
            guess = orbit.t + 1e-8 * rng.standard_normal(2)
            np.testing.assert_allclose(refine(orbit.word, orbit.params, guess).states, orbit.states, atol=1e-8)


def test_a_family_that_is_not_reached_is_told_and_the_others_are_there(monkeypatch, cascade):
    def fails(bifurcation):
        if bifurcation.type == "period_doubling":
            raise OrbitNotFound("it was lost")
        return switch_branch(bifurcation)

    monkeypatch.setattr("vines.orbits._cascade.switch_branch", fails)
    first, second = follow_cascade(cascade[0].orbits[0], "A", 0.024, depth=2)
    assert (first.remark, second.parent) == ("", first.branch_id)
    assert second.remark == "out of the period_doubling at 0.0204743801: it was lost"
    assert branch_row(second)["remark"] == second.remark


def test_a_doubling_gives_the_doubled_word_and_a_simulation_stays_on_it(cascade):
    [orbit] = switch_branch(cascade[1].bifurcations[0])
    assert str(orbit.word) == "LRLR/2T"
    assert orbit.stable
    assert orbit.residual < 1e-13
    run = simulate(orbit.params, **orbit.start(), periods=200.25)
    late = run.impacts[-4:]
    again = np.sort(late["w_dot"])
    np.testing.assert_allclose(again, np.sort(orbit.w_dot), atol=1e-9)


def test_where_a_family_ends_the_switch_leads_back_to_the_one_it_came_out_of(cascade):
    for parent, child in itertools.pairwise(cascade[:3]):
        branch = continue_orbit(child.orbits[1], "A", 0.015)
        joint = branch.bifurcations[-1]
        assert branch.ends[1] == joint.type == parent.bifurcations[0].type
        assert is_joint(joint)
        assert not is_joint(parent.bifurcations[0])
        assert joint.value == pytest.approx(parent.bifurcations[0].value, abs=1e-10)
        [left] = switch_branch(joint)
        assert left.word == parent.word
        assert left.symmetric == parent.symmetric


def test_the_cascade_is_linked_and_its_doublings_close_up(cascade):
    assert [str(branch.word) for branch in cascade] == ["LR", "LR", "LRLR/2T", "LRLRLRLR/4T"]
    for parent, child in itertools.pairwise(cascade):
        assert child.parent == parent.branch_id == branch_row(child)["parent"]
        assert child.ends[0] == parent.bifurcations[0].type
        assert child.values[0] == pytest.approx(parent.bifurcations[0].value, abs=1e-4)
    assert cascade[0].parent is None
    doublings = [branch.bifurcations[0].value for branch in cascade[1:]]
    assert doublings == pytest.approx([0.0204743800565, 0.0212800016929, 0.0214513934997], abs=1e-9)
    # Feigenbaum's ratio from three doublings.
    assert (doublings[1] - doublings[0]) / (doublings[2] - doublings[1]) == pytest.approx(4.669, rel=0.02)


def test_multipliers_that_are_mere_rounding_make_no_bifurcations():
    branches = follow_cascade(find_orbit("LLR", P.replace(A=0.022)), "A", 0.035, depth=2)
    assert [[b.type for b in branch.bifurcations] for branch in branches] == [["period_doubling"]] * 3


@pytest.mark.parametrize("generation", [0, 1, 2])
def test_the_curvature_of_a_branching_is_that_of_the_family(cascade, generation):
    bifurcation = cascade[generation].bifurcations[0]
    start = unfolded(bifurcation.type, bifurcation.orbit)
    c = branching_curvature(bifurcation.type, bifurcation.orbit, ("A", "mu"), np.array([0.01, 0.0])) * 0.01
    orbit = switch_branch(bifurcation)[0]
    away = orbit.params.Omega * orbit.t - start.params.Omega * start.t
    assert orbit.params.A - bifurcation.value == pytest.approx(c * (away @ away), rel=5e-3)


def test_other_bifurcations_lead_nowhere(cascade):
    with pytest.raises(OrbitNotFound, match="symmetry_breaking or period_doubling"):
        switch_branch(cascade[1].bifurcations[-1])
    with pytest.raises(ParameterError, match="depth is -1; give an integer >= 0"):
        follow_cascade(cascade[0].orbits[0], "A", 0.02, depth=-1)
    with pytest.raises(ParameterError, match="it has to hold"):
        continue_orbit(cascade[0].orbits[0], "A", 0.02, within=(0.016, 0.02))


def test_grazing_is_met_whatever_the_step(cascade):
    grazing = cascade[2].bifurcations[-1]
    assert grazing.type == "grazing"
    assert grazing.value == pytest.approx(0.0216679118, abs=1e-9)
    assert 0 < grazing.orbit.min_clearance < 1e-12
    for step in (0.003, 0.02, 0.1):
        branch = continue_orbit(cascade[2].orbits[3], "A", 0.024, step=step)
        assert branch.bifurcations[-1].value == pytest.approx(grazing.value, abs=1e-12)


# Section 5.1 of the paper at mu = .01, Omega = 1: how 2:2/2T (the paper's 1:1/2T) gives way to 2:1.


def test_both_sheets_of_2_to_1_from_its_fold(two_to_one):
    torus, fold, grazing = two_to_one.bifurcations
    assert [b.type for b in two_to_one.bifurcations] == ["neimark_sacker", "fold", "grazing"]
    assert fold.value == pytest.approx(0.0209753593572, abs=1e-11)
    assert torus.value == pytest.approx(0.0212400310486, abs=1e-11)
    assert grazing.value == pytest.approx(0.0233192119434, abs=1e-11)
    lower = two_to_one.orbits[[o is fold.orbit for o in two_to_one.orbits].index(True) + 1 :]
    assert all(o.admissible and not o.stable for o in lower)


def test_the_unstable_2_to_1_ends_where_the_asymmetric_1_to_1_does(cascade, two_to_one):
    ours, theirs = two_to_one.bifurcations[-1], cascade[1].bifurcations[-1]
    assert theirs.type == "grazing"
    assert ours.value == pytest.approx(theirs.value, abs=1e-11)
    # They are one orbit there: 2:1 has an impact without speed where 1:1 has a turning point on the wall.
    faint = np.argmin(ours.orbit.side * ours.orbit.w_dot)
    rest = np.delete(ours.orbit.states, faint, axis=0)
    # The one of larger mean x1 is followed; it grazes on R, its mirror image on L.
    np.testing.assert_allclose(mirror_image(theirs.orbit).states, rest, atol=1e-8)
    # Both exist below only: a non-smooth fold.
    assert max(cascade[1].values) == theirs.value
    assert max(two_to_one.values) == ours.value


def test_2_to_2_over_2t_ends_in_a_non_smooth_fold_with_an_unstable_3_to_2_over_2t(cascade):
    grazing = cascade[2].bifurcations[-1]
    # The cascade's one grazes on R; take its mirror image, which grazes on L.
    orbit = mirror_image(grazing.orbit)
    turnings = turnings_kernel(constants(orbit.params), orbit.period, orbit.t, orbit.states)
    flight, tau, wall = turnings[np.argmin(turnings[:, 3]), :3]
    assert wall == 1
    times = np.sort(np.append(orbit.t, orbit.t[int(flight)] + tau))
    below = orbit.params.replace(A=grazing.value - 1e-5)
    letters = _letters(orbit, times)
    first = next(k for k in range(5) if letters[k:] + letters[:k] == "LLRLR")
    other = find_orbit("LLRLR/2T", below, guess=np.concatenate([times[first:], times[:first] + orbit.period]))
    assert other.admissible
    assert not other.stable
    family = continue_orbit(other, "A", 0.024, within=(0.0205, 0.024), step=0.005)
    assert family.ends[1] == "grazing"
    assert family.bifurcations[-1].value == pytest.approx(grazing.value, abs=1e-11)
    down = continue_orbit(other, "A", 0.0205, within=(0.0205, 0.024), step=0.005)
    [fold] = [b for b in down.bifurcations if b.type == "fold"]
    assert fold.value == pytest.approx(0.0215607916441, abs=1e-11)
    assert down.bifurcations[-1].value == pytest.approx(0.0233192119434, abs=1e-10)
    assert not any(o.stable for o in down.orbits)


def _letters(orbit, times):
    known = dict(zip(orbit.t.tolist(), orbit.word.letters, strict=True))
    return "".join(known.get(t, "L") for t in times.tolist())


@pytest.mark.parametrize(
    ("A", "grazes", "stays"),
    [(0.02157, False, True), (0.021575, True, True), (0.02159, True, False)],
)
def test_the_chaos_of_the_cascade_grazes_and_then_loses_itself_to_2_to_1(cascade, A, grazes, stays):
    p = P.replace(A=A)
    orbit = find_orbit("LRLR/2T", p, guess=cascade[2].orbits[-2])
    start = orbit.start()
    run = simulate(p, **{**start, "v1": start["v1"] + 1e-7}, periods=20_000)
    word = "".join("L" if side > 0 else "R" for side in run.impacts["side"])
    # The cascade's one grazes on R.
    assert ("RR" in word) == grazes
    assert "LL" not in word
    assert ("LRL" in word[-60:]) == stays
    assert find_orbit("LLR", p).stable
