"""Basins of the systems beside the VI-NES: limits that are the VI-NES, symmetries, balls that rest, settling alone."""

from __future__ import annotations

import numpy as np
import pytest

from vines.attractors import basins, settle_from
from vines.errors import StateError
from vines.model import Params
from vines.systems import ImpactPair, Parallel

pytestmark = pytest.mark.long(20)

GRID = (np.linspace(-0.9, 0.9, 6), np.linspace(-0.4, 0.4, 6))
VI_NES = Params(mu=0.01, A=0.02)


def over(p, x, y, values=GRID, **options):
    return basins(p, (x, values[0]), (y, values[1]), **options)


def test_one_ball_and_a_massless_one_beside_it_come_where_the_vi_nes_comes():
    wanted = over(VI_NES, "x2", "v2")
    one = over(Parallel(mu=(0.01,), A=0.02), "x2_1", "v2_1")
    assert np.array_equal(one.label, wanted.label)
    # The first attractor of either is what the sample shows first, the mirror images may be called the other way round.
    assert set((one.mirrored ^ wanted.mirrored).tolist()) in ({True}, {False})
    assert one.attractors[0].measures.max_abs_x1 == pytest.approx(wanted.attractors[0].measures.max_abs_x1, abs=1e-10)
    beside = over(Parallel(mu=(0.01, 0.0), beta=(1.0, 1.2), A=0.02), "x2_1", "v2_1", others={"v2_2": 0.1})
    assert {a.name.partition("|")[0].partition("/")[0] for a in beside.attractors} == {"1:1"}
    for found in beside.attractors:
        assert found.measures.balls[0].kinetic_ratio == pytest.approx(wanted.attractors[0].measures.kinetic_ratio)
    assert np.all(beside.label >= 0)


@pytest.mark.parametrize("G", [0.0, 0.05])
def test_starts_of_the_pair_go_where_settling_alone_says(G):
    p = ImpactPair(B=1.0, G=G, r=0.5)
    found = over(p, "w", "w_dot", (GRID[0], np.linspace(-2.0, 2.0, 6)), others={"phase": 0.3})
    assert len(found.attractors) > 1 - (G == 0)
    # Without a tilt the mirror image of a motion is one of the same attractor.
    assert bool(found.mirrored.any()) == (G == 0)
    for k in range(0, len(found.x), 5):
        alone = settle_from(p, {"w": found.x[k], "w_dot": found.y[k], "phase": 0.3})
        reached = found.attractors[found.label[k]]
        assert (alone.name, alone.measures.kinetic_ratio) == (
            reached.name,
            pytest.approx(reached.measures.kinetic_ratio, rel=1e-8),
        )


def test_equal_balls_that_change_places_come_to_one_attractor():
    p = Parallel(mu=(0.01, 0.01), A=0.03)
    one = over(p, "x2_1", "v2_1", others={"x2_2": 0.3, "v2_2": -0.2, "v1": 0.8})
    other = over(p, "x2_2", "v2_2", others={"x2_1": 0.3, "v2_1": -0.2, "v1": 0.8})
    called = [np.array([a.measures.max_abs_x1 for a in each.attractors])[each.label] for each in (one, other)]
    assert len(one.attractors) == len(other.attractors) == 2
    assert called[0] == pytest.approx(called[1], abs=1e-9)


def test_a_ball_that_rests_anywhere_is_one_attractor():
    p = Parallel(mu=(0.012, 0.008), beta=(1.0, 1.3), A=0.02)
    found = over(p, "x2_2", "x1", (np.linspace(-0.9, 0.9, 5), np.linspace(-0.1, 0.1, 5)), others={"v2_1": 0.1})
    names = [a.name for a in found.attractors]
    assert names.count("1:1|0:0") == 1
    assert len(names) == len({(a.name, round(a.measures.max_abs_x1, 9)) for a in found.attractors})
    rests = found.label == names.index("1:1|0:0")
    reach = found.attractors[names.index("1:1|0:0")].measures.max_abs_x1
    # Where the oscillator reaches the end of its cavity it cannot rest.
    assert rests.any()
    assert np.all(np.abs(found.x[rests]) <= 1.3 - reach)


def test_starts_outside_a_cavity_and_names_of_other_systems_are_refused():
    p = Parallel(mu=(0.01, 0.01), beta=(1.0, 1.4), A=0.03)
    found = over(p, "x2_2", "v2_2", (np.linspace(-1.5, 1.5, 4), GRID[1][:2]))
    assert np.all(np.abs(found.x) <= 1.4)
    with pytest.raises(StateError, match="unknown coordinate 'w'"):
        over(p, "w", "v2_1")
    with pytest.raises(StateError, match="no start of the grid has every ball in its cavity"):
        over(p, "x2_1", "x2_2", (np.array([2.0, 3.0]), np.array([2.0, 3.0])))
