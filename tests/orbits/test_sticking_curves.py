"""Curves of orbits that stick, against a code of its own in 70 digits, the simulator, and closed forms."""

import math

import numpy as np
import pytest

from benchmarks.sticking_in_digits import end_in_digits, multipliers_in_digits
from vines.attractors import settle
from vines.model import Params
from vines.orbits import continue_orbit, curve_rows, find_orbit, follow_curve

P = Params(mu=0.0256654, A=0.965717, Omega=1.02946, r=0.347164, lam=0.0959532)
DOUBLES = Params(mu=0.0784564, A=0.171193, Omega=1.33447, r=0.302436, lam=0.0900701)
BREAKS = Params(mu=0.06394, A=0.04478, Omega=0.6422, r=0.3992, lam=0.1077)
FULL = pytest.mark.full
PRESSED = Params(mu=6.38, A=0.344, Omega=0.563, r=0.109, lam=0.0166)


def bifurcation(word, p, parameter, stop, kind):
    branch = continue_orbit(find_orbit(word, p), parameter, stop)
    return next(found for found in branch.bifurcations if found.type == kind)


@pytest.fixture(scope="module")
def bound():
    end = bifurcation("L*R*", P, "A", 0.4, "incomplete_chatter")
    return follow_curve(end, ("A", "mu"), box={"A": (0.4, 0.6), "mu": (0.01, 0.06)}, step=0.1)


def test_the_bound_is_where_70_digits_put_it(bound):
    assert (bound.type, bound.ends) == ("incomplete_chatter", ("box", "box"))
    orbit = bound.orbits[len(bound.orbits) // 2]
    assert pytest.approx(end_in_digits(orbit, "A"), abs=1e-11) == orbit.params.A


def test_along_the_bound_the_stick_has_no_length_and_beside_it_there_is_one(bound):
    for orbit in bound.orbits:
        assert orbit.spells["t_release"] - orbit.spells["t_start"] == pytest.approx(np.zeros(2), abs=1e-15)
        assert (orbit.symmetric, orbit.admissible, orbit.residual < 1e-11) == (True, True, True)
    at = bound.orbits[len(bound.orbits) // 2].params
    inside = find_orbit("L*R*", at.replace(A=at.A + 1e-6))
    # What multiplies disturbances does not notice the end.
    assert inside.multipliers == pytest.approx(bound.orbits[len(bound.orbits) // 2].multipliers, abs=1e-4)
    assert continue_orbit(inside, "A", at.A - 1e-3).bifurcations[-1].value == pytest.approx(at.A, abs=1e-10)
    assert settle(at.replace(A=at.A + 3e-5), lyapunov=False).word == "L*R*"
    assert settle(at.replace(A=at.A - 3e-5), lyapunov=False).word != "L*R*"


def test_rows_of_a_bound_are_those_of_other_curves(bound):
    rows = curve_rows(bound)
    assert {row["type"] for row in rows} == {"incomplete_chatter"}
    assert rows[0]["word"] == "L*R*"
    assert [row["A"] for row in rows] == bound.values[:, 0].tolist()


@FULL
def test_a_doubling_is_followed_until_the_chatter_is_not_complete():
    found = bifurcation("LR*/3T", DOUBLES, "A", 0.34, "period_doubling")
    curve = follow_curve(found, ("A", "mu"), box={"A": (0.05, 0.5), "mu": (0.02, 0.5)}, step=0.1)
    assert curve.ends == ("incomplete_chatter", "incomplete_chatter")
    # -1 is a multiplier of the round by differences in 70 digits as well.
    orbit = curve.orbits[len(curve.orbits) // 2]
    _, exact = multipliers_in_digits(orbit)
    assert np.abs(exact + 1).min() < 1e-10


@pytest.mark.parametrize(
    ("word", "kind", "stop", "p"),
    [
        ("LR*/3T", "fold", 5.5, Params(2.717, 2.756, 3.969, 0.1153, 0.02585)),
        pytest.param("LR*/3T", "neimark_sacker", 1.4, Params(2.717, 2.756, 3.969, 0.1153, 0.02585), marks=FULL),
        pytest.param("L*R*/9T", "symmetry_breaking", 0.0224, BREAKS, marks=FULL),
    ],
)
def test_multipliers_along_a_curve_are_critical_by_differences_in_many_digits(word, kind, stop, p):
    found = bifurcation(word, p, "A", stop, kind)
    box = {"A": (0.95 * found.value, 1.05 * found.value), "mu": (0.95 * p.mu, 1.05 * p.mu)}
    curve = follow_curve(found, box=box, step=0.4)
    assert curve.ends == ("box", "box")
    assert curve.residuals.max() < 1e-11
    for orbit in (curve.orbits[0], curve.orbits[-1]):
        _, (first, second) = multipliers_in_digits(orbit)
        if kind == "neimark_sacker":
            assert first * second == pytest.approx(1, abs=1e-9)
            assert abs(first.imag) > 1e-3
        else:
            assert min(abs(first - 1), abs(second - 1)) < 1e-7


def test_a_grazing_touches_all_along():
    p = Params(0.05869, 0.1309, 1.35, 0.4412, 0.02095)
    found = bifurcation("L*R*/5T", p, "A", 0.26, "grazing")
    curve = follow_curve(found, box={"A": (0.9 * found.value, 1.1 * found.value), "mu": (0.05, 0.07)}, step=0.3)
    assert curve.ends == ("box", "box")
    for orbit in curve.orbits:
        assert abs(orbit.min_clearance) < 1e-9
        assert orbit.residual < 1e-11
    # Inside, what is left to the wall is proportional to the distance from the curve.
    at = curve.orbits[len(curve.orbits) // 2]
    spell = at.spells[0]
    near, far = (
        find_orbit(at.word, at.params.replace(A=at.params.A - distance), guess=[spell["t_release"], spell["v1"]])
        for distance in (1e-6, 2e-6)
    )
    assert far.min_clearance / near.min_clearance == pytest.approx(2, abs=1e-2)


def test_a_release_tangency_is_met_and_followed():
    found = bifurcation("L*R*/3T", PRESSED, "A", 0.5, "release_tangency")
    assert found.value == pytest.approx(0.405394142, abs=1e-8)
    curve = follow_curve(found, box={"A": (0.38, 0.43), "mu": (6.0, 7.0)}, step=0.3)
    assert curve.ends == ("box", "box")
    for orbit in (curve.orbits[0], curve.orbits[-1]):
        p, spell = orbit.params, orbit.spells[0]
        # The contact force, from the loaded oscillator in its own closed form, touches zero within the spell.
        t = np.linspace(spell["t_start"] + 0.05, spell["t_release"] - 0.05, 20001)
        force = loaded_acceleration(p, spell, t)
        assert abs(force.min()) < 1e-7
        assert 0 < int(np.argmin(force)) < len(t) - 1


def loaded_acceleration(p, spell, t):
    """Return x1'' towards the wall while the ball is stuck, backwards from the release."""
    m = 1 + p.mu
    q = p.A * (p.lam * p.Omega - 1j) / (1 - m * p.Omega**2 + 1j * p.lam * p.Omega)
    s = -p.lam / (2 * m) + 1j * math.sqrt(1 / m - (p.lam / (2 * m)) ** 2)
    steady = q * np.exp(1j * p.Omega * spell["t_release"])
    x, v = spell["x1"] - steady.real, spell["v1"] - (1j * p.Omega * steady).real
    z = x - 1j * (v - s.real * x) / s.imag
    free = (s**2 * z * np.exp(s * (t - spell["t_release"]))).real
    return spell["side"] * (free - p.Omega**2 * (q * np.exp(1j * p.Omega * t)).real)
