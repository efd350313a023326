"""Basins: every start to its attractor, mirror images told apart, shares with errors, boundaries cut finer."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from vines.attractors import Attractor, Basins, basins, settle, settle_from, share_error
from vines.errors import StateError
from vines.model import Params

pytestmark = pytest.mark.long(20)

ASYMMETRIC = Params(mu=0.01, A=0.02)
GRID = (("x2", np.linspace(-0.9, 0.9, 6)), ("v2", np.linspace(-0.4, 0.4, 6)))


def test_mirror_images_are_one_attractor_and_each_start_goes_where_settle_says() -> None:
    found = basins(ASYMMETRIC, *GRID)
    assert [a.name for a in found.attractors] == ["1:1"]
    assert found.fraction(0)[0] == pytest.approx(1.0)
    assert set(found.mirrored) == {False, True}
    images = {}
    for k in range(0, len(found.x), 7):
        at = settle(ASYMMETRIC, x2=float(found.x[k]), v2=float(found.y[k])).impacts
        left = at[at["side"] > 0]
        images.setdefault(bool(found.mirrored[k]), []).append(float(left["x1"][-1]))
    for values in images.values():
        assert np.ptp(values) < 1e-6


def test_the_phase_may_be_a_coordinate() -> None:
    found = basins(ASYMMETRIC, ("v2", [0.1, 0.2, 0.3]), ("phase", np.linspace(0.0, 5.0, 6)))
    assert [a.name for a in found.attractors] == ["1:1"]
    assert not np.any(found.label < 0)
    # Half a period later the mirrored start goes the mirrored way.
    other = basins(ASYMMETRIC, ("v2", [-0.1, -0.2, -0.3]), ("phase", np.linspace(0.0, 5.0, 6) + math.pi))
    same_image = len(set((found.mirrored ^ other.mirrored).tolist()))
    assert same_image == 1


def test_starts_outside_the_cavity_are_left_out_and_weights_sum_to_one() -> None:
    found = basins(ASYMMETRIC, ("x2", np.linspace(-1.5, 1.5, 6)), ("v2", [0.1, 0.2]), refine=1)
    assert np.all(np.abs(found.x) <= 1.0)
    assert found.weight.sum() == pytest.approx(1.0)
    assert 0.0 <= found.fraction(0)[1] < 0.3


# Beyond the cascade of period doublings: a pair of chaotic attractors, mirror images; other chaos is left for these.
PAIRS = Params(mu=0.01, A=0.02157)


@pytest.fixture(scope="module")
def pairs() -> Basins:
    return basins(PAIRS, ("x2", np.linspace(-0.9, 0.9, 10)), ("v2", np.linspace(0.05, 0.5, 10)))


def test_chaos_is_told_by_its_averages_and_its_mirror_image_is_the_same_attractor(pairs: Basins) -> None:
    assert [(a.regime, a.name) for a in pairs.attractors] == [("chaotic", None)]
    assert set(pairs.mirrored[pairs.label == 0].tolist()) == {False, True}
    assert pairs.fraction(0)[0] > 0.9
    assert pairs.fraction(0)[0] + pairs.fraction(-1)[0] == pytest.approx(1.0)


def test_the_image_of_chaos_that_is_named_is_that_of_a_run_by_itself(pairs: Basins) -> None:
    def lean(attractor: Attractor) -> float:
        return attractor.measures.impact_loss_left - attractor.measures.impact_loss_right

    # The prompt ones: where chaos of the other kind comes first, rounding says to which image it leads.
    for k in np.flatnonzero((pairs.label == 0) & (pairs.periods < 400))[::12]:
        run = settle(PAIRS, x2=float(pairs.x[k]), v2=float(pairs.y[k]), settle=320, record=256)
        if run.measures.impacts_left == run.measures.impacts_right:
            assert (lean(run) * lean(pairs.attractors[0]) < 0) == pairs.mirrored[k]


def test_a_basin_holds_its_attractor(pairs: Basins) -> None:
    for attractor in pairs.attractors:
        again = settle_from(PAIRS, attractor.final, settle=0, watch=128)
        assert (again.regime, again.name) == (attractor.regime, attractor.name)


def test_chaos_that_is_soon_left_is_not_what_a_start_comes_to() -> None:
    # Chaos lasts about 900 periods here, then comes 1:1/9T (tests/attractors/test_classify_many.py, point 242).
    p = Params(mu=0.0019088, A=0.0864574, Omega=1.58272, r=0.432606)
    found = basins(p, ("x2", np.linspace(-0.9, 0.9, 6)), ("v2", np.linspace(0.05, 0.5, 6)), settle=256, patience=8000)
    assert [a.name for a in found.attractors] == ["1:1/9T"]
    assert found.fraction(0)[0] > 0.9


def test_chaos_that_is_left_in_the_end_is_told_with_how_long_it_lasts() -> None:
    """Fig. 11: what is called a second attractor is left for 1:1 after some 400,000 forcing periods."""
    p = Params(mu=0.05, A=0.1, Omega=1.17)
    on_orbit = {"x1": -0.08861228, "v1": -0.15914447, "phase": 0.0}
    found = basins(p, ("x2", np.linspace(-1.05, 0.9, 16)), ("v2", np.linspace(-1.5, 1.5, 16)), others=on_orbit)
    kinds = {a.name or a.regime: k for k, a in enumerate(found.attractors)}
    assert set(kinds) == {"1:1", "chaotic"}
    assert 0.01 < found.fraction(kinds["1:1"])[0] < 0.15
    assert math.isnan(found.lifetimes[kinds["1:1"]].periods)
    stay = found.lifetimes[kinds["chaotic"]]
    # 240 runs for 2,000 periods: one or two leave, or none.
    assert math.isnan(stay.periods) or stay.periods > 5e4


@pytest.mark.full
def test_the_lifetime_of_the_chaos_of_figure_11() -> None:
    """Against a count of its own: 2,048 random starts for 50,000 periods, 232 of 1,943 left from the 1,000th on."""
    p = Params(mu=0.05, A=0.1, Omega=1.17)
    on_orbit = {"x1": -0.08861228, "v1": -0.15914447, "phase": 0.0}
    grid = ("x2", np.linspace(-1.05, 0.9, 40)), ("v2", np.linspace(-1.5, 1.5, 40))
    found = basins(p, *grid, others=on_orbit, patience=40_000)
    chaos = next(k for k, a in enumerate(found.attractors) if a.regime == "chaotic")
    counted = 1943 * 49_000 * (1 - 0.5 * 232 / 1943) / 232
    stay = found.lifetimes[chaos]
    assert stay.periods == pytest.approx(counted, abs=4 * math.hypot(stay.error, counted / math.sqrt(232)))


def test_the_error_of_a_share_is_binomial_and_never_zero() -> None:
    assert share_error(0.3, 10_000) == pytest.approx(math.sqrt(0.3 * 0.7 / 10_000), rel=1e-3)
    assert share_error(0.0, 10) == share_error(1.0, 10) == pytest.approx(math.sqrt(11 / (12**2 * 13)))
    for hits, starts in ((0, 3), (1, 50), (49, 50), (100, 4000)):
        expected = stats.beta(hits + 1, starts - hits + 1).std()
        assert share_error(hits / starts, starts) == pytest.approx(expected)


def test_bad_coordinates_are_refused() -> None:
    with pytest.raises(StateError, match="unknown coordinate 'v3'"):
        basins(ASYMMETRIC, ("v3", [0.0, 1.0]), ("v2", [0.1, 0.2]))
    with pytest.raises(StateError, match="must be two"):
        basins(ASYMMETRIC, ("v2", [0.0, 1.0]), ("v2", [0.1, 0.2]))
    with pytest.raises(StateError, match="no start of the grid"):
        basins(ASYMMETRIC, ("x2", [2.0, 3.0]), ("v2", [0.1, 0.2]))
