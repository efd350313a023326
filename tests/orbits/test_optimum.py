"""The best stable orbit against dense scans, its margins against branches, and the surface it is sought on."""

import numpy as np
import pytest

from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params
from vines.orbits import find_orbit, optimise, symmetric_fold, symmetric_orbits
from vines.orbits._box import Box
from vines.orbits._chart import Chart

pytestmark = pytest.mark.long(14)

P = Params(mu=0.01, A=0.015)


def scan(points, cost):
    """Return the least cost of the stable admissible symmetric 1:1 orbits at some points."""
    return min(cost(orbit) for p in points for orbit in symmetric_orbits(p)[:1] if orbit.stable and orbit.admissible)


def twice(low, high, count, least_at):
    """Return the least value on a grid, and on one as dense between the neighbours of where that was."""
    coarse = np.linspace(low, high, count)
    at = int(np.argmin([least_at(value) for value in coarse]))
    return min(least_at(value) for value in np.linspace(coarse[max(at - 1, 0)], coarse[min(at + 1, count - 1)], count))


@pytest.fixture(scope="module")
def cavity():
    return optimise("LR", "max_abs_x1", P, {"b": (0.5, 3.0)})


def test_length_of_the_cavity_at_a_fixed_amplitude_of_the_base(cavity):
    def least_at(b):
        found = (o for o in symmetric_orbits(P.replace(A=P.A / b))[:1] if o.stable and o.admissible)
        return min((b * o.measures.max_abs_x1 for o in found), default=np.inf)

    least = twice(0.5, 3.0, 101, least_at)
    assert cavity.value <= least
    assert cavity.value == pytest.approx(least, rel=1e-4)
    assert cavity.active == ()
    assert cavity.orbit.stable
    assert cavity.value == pytest.approx(cavity.b * cavity.orbit.measures.max_abs_x1, rel=1e-12)
    assert cavity.orbit.params.A * cavity.b == pytest.approx(P.A, rel=1e-12)


def test_margins_are_the_first_bifurcations(cavity):
    margin = cavity.margins["A"]
    assert (margin.below_type, margin.above_type) == ("neimark_sacker", "symmetry_breaking")
    assert margin.below == pytest.approx(0.00947963, abs=1e-8)
    assert margin.above == pytest.approx(0.01800761, abs=1e-8)
    assert cavity.margins["b"].above == pytest.approx(P.A / margin.below, rel=1e-12)
    distance, name, _ = cavity.nearest
    assert distance == min(m.nearest[0] for m in cavity.margins.values())
    assert name in cavity.margins


def test_two_parameters_and_a_fold_that_holds_the_optimum():
    over = {"mu": (0.008, 0.03), "Omega": (0.98, 1.02)}
    best = optimise("LR", "max_abs_x1", P, over)
    grid = [P.replace(mu=m, Omega=w) for m in np.linspace(*over["mu"], 45) for w in np.linspace(*over["Omega"], 45)]
    least = scan(grid, lambda o: o.measures.max_abs_x1)
    assert best.value < least < 1.05 * best.value
    assert best.active == ("fold",)
    assert best.orbit.stable
    assert best.orbit.admissible
    # It lies on the curve of folds: a little less forcing and there is no orbit.
    assert abs(symmetric_fold(best.orbit.params).A / P.A - 1) < 1e-9
    assert best.nearest[0] < 1e-9


def test_ends_of_ranges_are_met_exactly():
    best = optimise("LR", "kinetic_ratio", P, {"A": (0.012, 0.02)})
    assert best.active == ("least A",)
    assert best.orbit.params.A == 0.012
    assert best.value == symmetric_orbits(P.replace(A=0.012))[0].measures.kinetic_ratio


def test_a_limit_on_the_multipliers_is_kept():
    best = optimise("LR", "max_abs_x1", P, {"A": (0.009, 0.017)}, largest_multiplier=0.87)

    def least_at(A):
        kept = (o for o in symmetric_orbits(P.replace(A=A)) if o.max_multiplier < 0.87)
        return min((o.measures.max_abs_x1 for o in kept), default=np.inf)

    least = twice(0.009, 0.017, 101, least_at)
    assert best.orbit.max_multiplier < 0.87
    assert best.value <= least * (1 + 1e-6)
    assert best.value == pytest.approx(least, rel=1e-3)


def test_a_word_without_closed_form_against_a_scan_along_its_branch():
    p = Params(mu=0.01, A=0.023)
    best = optimise("LLR", "max_abs_x1", p, {"A": (0.02, 0.026)})
    orbit, seen = find_orbit("LLR", p), []
    for A in (*np.linspace(0.023, 0.0211, 60), *np.linspace(0.0211, 0.0255, 300)):
        orbit = find_orbit("LLR", p.replace(A=A), guess=orbit)
        if orbit.stable and orbit.admissible:
            seen.append(orbit.measures.max_abs_x1)
    assert best.value <= min(seen)
    assert best.value == pytest.approx(min(seen), rel=2e-3)
    assert best.active == ("neimark_sacker",)
    assert abs(best.orbit.params.A - 0.02124003) < 1e-7


def test_the_surface_is_smooth_through_a_fold():
    p = symmetric_fold(P)
    orbit = symmetric_orbits(p.replace(A=p.A * (1 + 1e-9)))[0]
    chart = Chart(orbit, Box(p, {"A": (0.005, 0.02)}))
    sheets = [chart.orbit(np.array([step])) for step in (-0.05, 0.05)]
    speeds = sorted(-o.states[0, 3] for o in sheets)
    assert speeds[0] < -orbit.states[0, 3] < speeds[1]
    assert all(o.params.A > p.A and o.residual < 1e-12 for o in sheets)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"objective": "max_x1"}, "did you mean 'max_abs_x1'"),
        ({"over": {}}, "at least one parameter"),
        ({"over": {"a": (0.01, 0.02)}}, "unknown parameter 'a'"),
        ({"over": {"A": (0.02, 0.01)}}, "lower end first"),
        ({"over": {"A": (0.01, 0.02), "b": (0.5, 2)}}, "must not be free"),
        ({"over": {"r": (0.5, 1.2)}}, "0 <= r <= 1"),
        ({"largest_multiplier": 0.0}, "0 < largest_multiplier <= 1"),
    ],
)
def test_mistakes_are_told_in_one_line(change, message):
    asked = {"objective": "max_abs_x1", "over": {"A": (0.01, 0.02)}, **change}
    with pytest.raises(ParameterError, match=message):
        optimise("LR", p=P, **asked)


def test_no_stable_orbit_says_where_it_looked():
    with pytest.raises(OrbitNotFound, match=r"no stable admissible LR orbit was met over A = 0.001 … 0.002"):
        optimise("LR", "max_abs_x1", P, {"A": (0.001, 0.002)})
