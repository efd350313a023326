"""Bifurcations of every system in two parameters, against closed forms and against orbits flown in mpmath."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest

from tests.orbits.in_digits import Flown
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params
from vines.orbits import continue_orbit, find_orbit, follow_curve
from vines.systems import ImpactPair, Parallel

LEVEL = ImpactPair(B=0.6, r=0.5)
BOX = {"B": (0.1, 1.5), "G": (-0.3, 0.3)}


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(30):
        yield


def met(orbit, parameter, stop, kind, **options):
    found = continue_orbit(orbit, parameter, stop, **options).bifurcations
    return next(each for each in found if each.type == kind)


def check(curve, points=2):
    """Hold some points of a curve to its equations, in digits and by a code of their own."""
    assert curve.residuals.max() < 1e-12
    for orbit in [curve.orbits[k] for k in np.linspace(1, len(curve.orbits) - 2, points).astype(int)]:
        flown = Flown(orbit, half=curve.symmetric)
        if curve.type == "grazing":
            off, value = flown.closing(orbit), flown.touch(orbit)
        else:
            off, value = flown.condition(curve.type)
        assert off < 1e-11
        assert abs(value) < 1e-11


@pytest.fixture(scope="module")
def level():
    return find_orbit("LR", LEVEL)


@pytest.fixture(scope="module")
def tilted():
    return find_orbit("LR", LEVEL.replace(G=0.05))


def test_fold_of_the_level_pair_is_the_closed_form(level):
    fold = met(level, "B", 0.2, "fold", within=(0.2, 0.7))
    curve = follow_curve(fold, ("B", "r"), box={"B": (0.02, 1.5), "r": (0.01, 0.95)})
    assert curve.symmetric
    assert curve.ends == ("box", "box")
    B, r = curve.values.T
    assert pytest.approx((1 - r) / np.hypot(1 - r, math.pi * (1 + r) / 2), abs=1e-13) == B
    check(curve)


def test_symmetry_breaking_of_the_level_pair_is_the_closed_form(level):
    breaking = met(level, "B", 0.8, "symmetry_breaking")
    curve = follow_curve(breaking, ("B", "r"), box={"B": (0.02, 1.5), "r": (0.15, 0.95)})
    B, r = curve.values.T
    # det(I + H) = 0 with the map of systems.md gives U, and the quadratic of the symmetric 1:1 then B
    U = 4 * math.pi / ((1 + r) * (math.pi**2 - 4))
    assert pytest.approx(np.hypot((1 - r) * U, 2 - math.pi * (1 + r) * U / 2) / 2, abs=1e-12) == B
    # the check values of systems.md are on it
    for at, value in ((0.5, 0.7692409694848), (0.65, 0.71831086)):
        assert np.interp(at, r[np.argsort(r)], B[np.argsort(r)]) == pytest.approx(value, abs=1e-4)
    check(curve)


def test_bounces_on_the_lower_end_have_straight_curves():
    # one impact a period: U = 2 pi G/(1 + r), B cos(theta) = pi k G, and det(I + M) = 0 gives B sin(theta) = (1 + k²) G
    orbit = find_orbit("L", LEVEL.replace(B=0.3, G=0.25))
    k = (1 - LEVEL.r) / (1 + LEVEL.r)
    for kind, stop, slope in (("fold", 0.2, math.pi * k), ("period_doubling", 0.5, math.hypot(math.pi * k, 1 + k**2))):
        found = met(orbit, "B", stop, kind, within=(0.2, 0.5))
        curve = follow_curve(found, ("B", "G"), box={"B": (0.1, 1.0), "G": (0.1, 0.4)})
        assert curve.values[:, 0] / curve.values[:, 1] == pytest.approx(slope, abs=1e-12)
        check(curve, points=1)


def test_a_curve_of_multipliers_ends_where_an_impact_loses_its_speed(level):
    fold = met(level, "B", 0.2, "fold", within=(0.2, 0.7))
    curve = follow_curve(fold, ("B", "G"), box={"B": (0.2, 0.5), "G": (0.0, 0.4)})
    assert set(curve.ends) == {"box", "grazing"}  # it begins on the border of the box
    [end] = curve.special
    assert end.orbit.admissible
    assert min(end.orbit.side * end.orbit.w_dot) == pytest.approx(1e-3, rel=1e-3)


@pytest.mark.parametrize(("kind", "stop"), [("fold", 0.15), ("period_doubling", 1.2), ("grazing", 1.2)])
def test_curves_of_the_tilted_pair_satisfy_their_equations(tilted, kind, stop):
    found = met(tilted, "B", stop, kind, within=(0.15, 1.2))
    curve = follow_curve(found, ("B", "G"), box=BOX)
    assert len(curve.orbits) > 40
    assert not curve.symmetric
    check(curve)


def test_the_doubling_of_the_check_values_lies_on_the_curve_of_another_tilt(tilted):
    # systems.md: .9603 at G = .05, .3627 at G = .15
    found = met(tilted, "B", 1.2, "period_doubling")
    curve = follow_curve(found, ("B", "G"), box={"B": (0.3, 1.2), "G": (0.0, 0.16)})
    B, G = curve.values.T
    assert np.interp(0.15, G[np.argsort(G)], B[np.argsort(G)]) == pytest.approx(0.3627, abs=2e-3)


def test_where_the_symmetry_breaks_folds_of_the_tilted_pair_have_a_cusp(level):
    breaking = met(level, "B", 0.8, "symmetry_breaking")
    # beyond it the level pair has three orbits; with a little tilt two of them end in a fold
    beyond = find_orbit("LR", LEVEL.replace(B=0.78))
    fold = met(beyond, "G", 0.05, "fold", within=(-0.05, 0.05))
    curve = follow_curve(fold, ("B", "G"), box={"B": (0.7, 0.85), "G": (-0.02, 0.02)}, step=0.01)
    [cusp] = [point for point in curve.special if point.type == "cusp"]
    assert cusp.values == pytest.approx((breaking.value, 0.0), abs=1e-6)
    check(curve)


def test_a_symmetric_orbit_that_is_tilted_is_no_longer_kept_symmetric(level):
    branch = continue_orbit(level, "G", 0.05)
    assert max(orbit.residual for orbit in branch.orbits) < 1e-12
    assert branch.orbits[-1].w_dot == pytest.approx(find_orbit("LR", LEVEL.replace(G=0.05)).w_dot, abs=1e-9)


@pytest.mark.parametrize("stop", [0.0, 1.0])
def test_a_branch_goes_to_the_border_of_what_a_parameter_may_be(stop):
    branch = continue_orbit(find_orbit("LR", LEVEL.replace(G=0.01, B=0.56)), "r", stop)
    assert branch.ends == ("range", "range")
    assert branch.values[-1] == stop


@pytest.mark.parametrize(("names", "box"), [(("A", "G"), (-0.01, 0.01)), (("A", "beta_1"), (0.9, 1.1))])
@pytest.mark.parametrize(("kind", "stop"), [("period_doubling", 0.022), ("neimark_sacker", 0.009)])
def test_curves_of_the_tilted_sink_satisfy_their_equations(kind, stop, names, box):
    orbit = find_orbit("LR", Parallel(mu=(0.01,), A=0.0185, G=0.002))
    found = met(orbit, "A", stop, kind)
    check(follow_curve(found, names, box={"A": (0.004, 0.03), names[1]: box}), points=1)


def test_the_sink_without_tilt_has_the_curves_of_the_vi_nes():
    box = {"A": (0.015, 0.02), "r": (0.6, 0.7)}
    one = follow_curve(
        met(find_orbit("LR", Params(mu=0.01, A=0.017)), "A", 0.02, "symmetry_breaking"), ("A", "r"), box=box
    )
    orbit = find_orbit("LR", Parallel(mu=(0.01,), A=0.017))
    other = follow_curve(met(orbit, "A", 0.02, "symmetry_breaking"), ("A", "r_1"), box={"A": box["A"], "r_1": box["r"]})
    assert other.values[[0, -1]] == pytest.approx(one.values[[0, -1]], abs=1e-11)


@pytest.mark.full
@pytest.mark.parametrize(
    ("kind", "stop"), [("symmetry_breaking", 0.08), ("neimark_sacker", 0.01), ("fold", 0.01), ("grazing", 0.01)]
)
def test_curves_of_two_balls_satisfy_their_equations(kind, stop):
    orbit = find_orbit("L1L2R1R2", Parallel(mu=(0.01, 0.01), beta=(1.0, 1.4), A=0.03))
    curve = follow_curve(met(orbit, "A", stop, kind), ("A", "mu_2"), box={"A": (0.004, 0.1), "mu_2": (0.001, 0.02)})
    check(curve)


@pytest.mark.full
def test_a_curve_of_two_balls_ends_where_they_hit_together():
    orbit = find_orbit("L1L2R1R2", Parallel(mu=(0.01, 0.01), beta=(1.0, 1.4), A=0.03))
    curve = follow_curve(
        met(orbit, "A", 0.08, "symmetry_breaking"), ("A", "r_2"), box={"A": (0.004, 0.2), "r_2": (0.2, 1)}
    )
    assert set(curve.ends) == {"box", "tie"}
    [tie] = curve.special
    assert abs(tie.orbit.flight_times).min() < 1e-12
    assert Flown(tie.orbit, half=True).closing(tie.orbit) < 1e-12


def test_what_has_no_curve_is_refused_in_one_line(level, tilted):
    breaking = met(level, "B", 0.8, "symmetry_breaking")
    doubling = met(tilted, "B", 1.0, "period_doubling")
    for bifurcation, names, box, error, said in (
        (breaking, ("B", "G"), BOX, ParameterError, "no symmetry to break unless G = 0"),
        (doubling, ("B", "mu"), {"B": (0.1, 1.2), "mu": (0.1, 1)}, ParameterError, "unknown parameter 'mu'"),
        (doubling, ("B", "r"), {"B": (0.1, 1.2), "r": (0.1, 1.5)}, ParameterError, "r is 1.5, allowed is 0 <= r <= 1"),
    ):
        with pytest.raises(error, match=said) as caught:
            follow_curve(bifurcation, names, box=box)
        assert "\n" not in str(caught.value)
    # the ball that is carried along without impact knows neither mass nor restitution
    end = met(find_orbit("LR", Params(mu=0.01, A=0.017)), "A", 0.006, "grazing")
    with pytest.raises(OrbitNotFound, match="at all values of mu and r around"):
        follow_curve(end, ("mu", "r"), box={"mu": (0.001, 0.2), "r": (0.1, 0.9)})
