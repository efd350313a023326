"""All words up to a length, and all families of a word over a range."""

import itertools

import numpy as np
import pytest

from vines.errors import ParameterError
from vines.model import Params, Word
from vines.orbits import all_orbits, continue_orbit, find_orbit, follow_families, words_up_to

P = Params(mu=0.01, A=0.015)


def test_words_are_those_of_brute_force():
    found = words_up_to(6, period=2)
    every = {
        Word(f"{''.join(letters)}/{p}T")
        for p in (1, 2)
        for n in range(2, 7)
        for letters in itertools.product("LR", repeat=n)
        if len(set(letters)) == 2
    }
    assert len(found) == len(set(found))
    assert {word for one in found for word in (one, one.mirror)} == every
    assert all(word == word.mirror or word.mirror not in found for word in found)
    assert all(word.n >= word.m for word in found)


@pytest.mark.parametrize(("length", "period"), [(1, 1), (13, 1), (3, 0)])
def test_what_cannot_be_is_refused(length, period):
    with pytest.raises(ParameterError, match=r"allowed|give an integer"):
        words_up_to(length, period)


@pytest.fixture(scope="module")
def families():
    return follow_families("LR", P, "A", (0.008, 0.022), seeds=[0.01, 0.019, 0.021], depth=1, at=[0.015])


def test_every_family_is_followed_once_from_end_to_end(families):
    # Two sheets joined by a fold below the range, and the asymmetric pair as one child.
    assert [branch.symmetric for branch in families] == [True, False, True]
    main, child, small = families
    assert (main.values[0], main.values[-1]) == (0.008, 0.022)
    assert [b.type for b in main.bifurcations] == ["neimark_sacker", "symmetry_breaking"]
    assert families.complete
    assert families.loose == []
    assert child.parent == main.branch_id
    assert small.ends == ("range", "grazing")


def test_every_orbit_of_a_search_lies_on_a_branch(families):
    for A in (0.01, 0.015, 0.019, 0.021):
        here = [o for branch in families for o in branch.orbits if o.params.A == A]
        for orbit in all_orbits("LR", P.replace(A=A)):
            states = [np.sort(abs(o.w_dot)) for o in here]
            assert min(abs(s - np.sort(abs(orbit.w_dot))).max() for s in states) < 1e-9


def test_a_branch_that_is_only_met_from_the_family_it_left_knows_its_parent(families):
    found = follow_families("LR", P, "A", (0.0175, 0.022), seeds=[0.0176, 0.0195], depth=0)
    assert [branch.symmetric for branch in found] == [True, False]
    pair = found[1]
    assert "symmetry_breaking" in pair.ends
    assert pair.parent == found[0].branch_id
    # The branching point is listed once, on the family it belongs to.
    assert [b.type for branch in found for b in branch.bifurcations].count("symmetry_breaking") == 1


def test_both_ways_give_the_bifurcations_of_one_way():
    (family,) = follow_families("LLR", P, "A", (0.0205, 0.0225), seeds=[0.022])
    once = continue_orbit(find_orbit("LLR", P.replace(A=0.0225)), "A", 0.0205)
    ours, theirs = (sorted(b.value for b in branch.bifurcations) for branch in (family, once))
    assert ours == pytest.approx(theirs, abs=1e-10)
    assert ours == pytest.approx([0.0209753593572, 0.0212400310486], abs=1e-9)
    steps = np.diff([orbit.t for orbit in family.orbits], axis=0)
    assert np.abs(steps).max() < 0.3
