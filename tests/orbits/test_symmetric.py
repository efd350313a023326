"""The closed form of the symmetric 1:1/pT orbits against flights, high precision and the simulator."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vines.dynamics import jacobian, simulate
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params
from vines.orbits import find_orbit, symmetric_fold, symmetric_orbits


def random_params(rng):
    return Params(
        mu=10 ** rng.uniform(-2.5, 0),
        A=10 ** rng.uniform(-2, 0.3),
        Omega=rng.uniform(0.5, 2),
        r=rng.uniform(0.2, 0.95),
        lam=rng.uniform(0.005, 0.3),
    )


def random_orbits(seed, count):
    rng = np.random.default_rng(seed)
    found = []
    while len(found) < count:
        found += symmetric_orbits(random_params(rng), int(rng.choice([1, 1, 1, 3, 5])))
    return found[:count]


parameters = st.builds(
    Params,
    mu=st.floats(0.002, 2),
    A=st.floats(0.005, 2),
    Omega=st.floats(0.4, 2.5),
    r=st.floats(0.05, 1),
    lam=st.floats(0.001, 1),
)


@given(parameters, st.sampled_from([1, 3, 5]))
@settings(max_examples=150, deadline=None)
def test_every_orbit_closes_balances_and_has_the_right_determinant(p, period):
    for orbit in symmetric_orbits(p, period):
        size = 1 + np.abs(orbit.states).max()
        assert orbit.residual < 1e-11 * size
        assert orbit.symmetric
        assert orbit.word.p == period
        assert np.all(orbit.side * orbit.w_dot > 0)
        # Far from admissible orbits have large energies that cancel; the scale is their sum.
        assert abs(orbit.energy_imbalance) < 1e-10
        assert 0 <= orbit.t[0] < p.period
        assert orbit.measures.impacts_left == orbit.measures.impacts_right == 1
        # The product of the multipliers, whose spread limits its relative accuracy.
        product, exact = np.prod(orbit.multipliers), p.r**4 * math.exp(-p.lam * orbit.period)
        assert abs(product - exact) < 1e-9 * max(orbit.max_multiplier, 1) ** 3


def test_random_orbits_close_when_flown_independently(independent):
    for orbit in random_orbits(1, 150):
        for j in (0, 1):
            end = independent.fly(orbit.params, orbit.states[j], orbit.phase[j], orbit.flight_times[j])
            np.testing.assert_allclose(end, orbit.states[1 - j], rtol=0, atol=3e-12 * (1 + np.abs(end).max()))


@pytest.mark.parametrize(
    ("p", "period"),
    [
        (Params(mu=0.01, A=0.017), 1),
        (Params(mu=0.05, A=0.1, Omega=1.17), 1),
        (Params(mu=0.3, A=0.9, Omega=0.8, r=0.4, lam=0.1), 1),
        (Params(mu=0.02, A=0.9, Omega=2.4, r=0.8, lam=0.05), 3),
    ],
)
def test_orbit_and_multipliers_agree_with_a_fixed_point_in_high_precision(p, period, independent):
    orbit = symmetric_orbits(p, period)[0]
    with mp.workdps(40):

        def once_around(*y):
            first = independent.map_to(p, 1, -1, y, mp.mpf(orbit.flight_times[0]))
            return independent.map_to(p, -1, 1, first, mp.mpf(orbit.flight_times[1]))

        def differences(y, step):
            columns = []
            for k in range(4):
                up, down = list(y), list(y)
                up[k] += step
                down[k] -= step
                columns.append(
                    [(a - b) / (2 * step) for a, b in zip(once_around(*up), once_around(*down), strict=True)]
                )
            return mp.matrix(columns).T

        y = [mp.mpf(v) for v in (orbit.states[0, 1], orbit.states[0, 3], orbit.states[0, 2], orbit.t[0])]
        T = 2 * mp.pi * period / mp.mpf(p.Omega)
        for _ in range(4):
            M = differences(y, mp.mpf(10) ** -13)
            image = once_around(*y)
            defect = mp.matrix([a - b for a, b in zip(image, y, strict=True)])
            defect[3] -= T
            step = mp.lu_solve(M - mp.eye(4), defect)
            y = [a - b for a, b in zip(y, step, strict=True)]
        assert mp.norm(defect) < mp.mpf(10) ** -22
        ours = [orbit.states[0, 1], orbit.states[0, 3], orbit.states[0, 2], orbit.t[0]]
        assert max(abs(a - b) for a, b in zip(y, ours, strict=True)) < 1e-13
        exact = sorted((complex(v) for v in mp.eig(M)[0]), key=lambda v: (-abs(v), -v.imag))
    np.testing.assert_allclose(np.sort_complex(orbit.multipliers), np.sort_complex(exact), rtol=0, atol=1e-11)


def test_multipliers_are_those_of_the_product_of_the_public_jacobians():
    for orbit in random_orbits(2, 60):
        if orbit.max_multiplier > 1e3:
            continue
        product = np.eye(4)
        for j in (0, 1):
            product = (
                jacobian(
                    orbit.params,
                    int(orbit.side[j]),
                    int(orbit.side[1 - j]),
                    orbit.states[j],
                    orbit.phase[j],
                    orbit.flight_times[j],
                )
                @ product
            )
        # Compared through the characteristic polynomial, which is smooth where multipliers meet.
        np.testing.assert_allclose(
            np.poly(orbit.multipliers), np.poly(product), rtol=0, atol=1e-9 * max(1, orbit.max_multiplier) ** 2
        )


def test_half_multipliers_square_to_the_multipliers():
    for orbit in random_orbits(3, 30):
        np.testing.assert_allclose(
            np.sort(np.abs(orbit.half_multipliers) ** 2), np.sort(np.abs(orbit.multipliers)), rtol=1e-12
        )


@pytest.mark.parametrize("A", [0.0145, 0.016, 0.0172, 0.0178])
def test_a_stable_orbit_is_where_the_simulator_goes(A):
    orbit = find_orbit("LR", Params(mu=0.01, A=A))
    assert orbit.stable
    assert orbit.admissible
    near = simulate(orbit.params, **orbit.start(), periods=200)
    assert np.abs(near.impacts["w_dot"]) == pytest.approx(abs(orbit.w_dot[0]), abs=1e-11)
    far = simulate(orbit.params, x1=0, v1=0, x2=0, v2=0.1, periods=3000)
    for impact in far.impacts[-2:]:
        j = 0 if impact["side"] > 0 else 1
        ours = orbit.impacts[j]
        for name in ("x1", "v1", "x2", "v2", "w_dot", "v1_after", "v2_after"):
            assert impact[name] == pytest.approx(ours[name], abs=1e-10)
        turned = (impact["phase"] - ours["phase"] + np.pi) % (2 * np.pi) - np.pi
        assert abs(turned) < 1e-9


def test_measures_are_those_of_the_simulator():
    orbit = find_orbit("LR", Params(mu=0.01, A=0.017))
    run = simulate(orbit.params, **orbit.start(), periods=40)
    theirs, ours = run.measures(last=1), orbit.measures
    for name in ("kinetic_ratio", "max_abs_x1", "rms_x1", "base_work", "damper_loss", "impact_loss"):
        assert getattr(theirs, name) == pytest.approx(getattr(ours, name), rel=1e-11)


def test_energy_budget_closes_to_rounding_on_admissible_orbits():
    worst = max(abs(orbit.energy_imbalance) for orbit in random_orbits(5, 300) if orbit.admissible)
    assert worst < 1e-12


def test_the_fold_is_where_two_orbits_become_none():
    p = Params(mu=0.01, A=0.02)
    fold = symmetric_fold(p)
    assert len(symmetric_orbits(fold.replace(A=fold.A * (1 + 1e-12)))) == 2
    assert symmetric_orbits(fold.replace(A=fold.A * (1 - 1e-12))) == []


def test_no_orbit_says_how_much_is_missing():
    with pytest.raises(OrbitNotFound, match=r"none below A = 0\.00755329"):
        find_orbit("LR", Params(mu=0.01, A=0.007))


@pytest.mark.parametrize("period", [0, 2, -1, 1.0, True])
def test_symmetric_orbits_have_odd_periods(period):
    with pytest.raises(ParameterError, match=r"odd period|period is .*; give an integer >= 1"):
        symmetric_orbits(Params(mu=0.01, A=0.02), period)


def test_the_resonance_without_damping_is_refused():
    with pytest.raises(ParameterError, match="resonate"):
        symmetric_orbits(Params(mu=0.1, A=0.5, Omega=3.0, lam=0.0), 3)


def test_of_two_orbits_the_stable_one_is_shown_and_the_other_counted():
    orbit = find_orbit("RL", Params(mu=0.01, A=0.0115))
    assert orbit.stable
    assert orbit.remark.startswith("1 other solution of this word, of which 1 admissible, 1 symmetric, 0 stable")


def test_orbits_name_themselves_the_same_every_time():
    p = Params(mu=0.01, A=0.017)
    one, two = find_orbit("LR", p), find_orbit("RL", p)
    assert one.orbit_id == two.orbit_id
    assert one.orbit_id != find_orbit("LR", p.replace(A=0.0171)).orbit_id
    assert "stable" in repr(one)
