"""Orbits of any word: the closing equations, Newton's method, the search, and families that are not explicit."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vines.dynamics import simulate
from vines.dynamics._room import constants
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params, Word
from vines.orbits import continue_orbit, find_orbit, symmetric_orbits
from vines.orbits._equations import closing_kernel
from vines.orbits._general import search
from vines.orbits._values import essentials_of

P = Params(mu=0.01, A=0.023)


@pytest.fixture(scope="module")
def asymmetric():
    found, _ = search(Word("LR"), P.replace(A=0.0195))
    return next(orbit for orbit in found if not orbit.symmetric and orbit.admissible)


words = st.tuples(st.text(alphabet="LR", min_size=2, max_size=7), st.integers(1, 3)).map(
    lambda pair: Word(f"{pair[0]}/{pair[1]}T")
)


@given(words, st.integers(0, 10**6))
@settings(max_examples=40, deadline=None)
def test_the_derivatives_of_the_closing_equations_agree_with_differences(word, seed):
    rng = np.random.default_rng(seed)
    p = Params(mu=10 ** rng.uniform(-2, 0), A=rng.uniform(0.01, 1), Omega=rng.uniform(0.6, 1.6), lam=0.1)
    c, duration, side = constants(p), word.p * p.period, np.array(word.sides)
    # Flight times of a tenth of the mean or more: the derivatives grow with their inverse squares.
    flights = 0.1 + 0.9 * rng.dirichlet(np.ones(len(word))) * len(word)
    t = rng.uniform(0, p.period) + np.cumsum(flights / flights.sum()) * duration
    regular, _, slope, _ = closing_kernel(essentials_of(c), duration, side, t)
    assert regular
    for k in range(len(word)):
        h = 1e-6 * np.eye(len(word))[k]
        up, down = (closing_kernel(essentials_of(c), duration, side, t + s * h)[1] for s in (1, -1))
        np.testing.assert_allclose((up - down) / 2e-6, slope[:, k], rtol=1e-5, atol=1e-7 * (1 + np.abs(slope).max()))


@pytest.mark.parametrize("period", [1, 3])
def test_the_general_solver_finds_the_closed_form(period):
    p = Params(mu=0.05, A=0.4, Omega=1.1 * period, lam=0.05)
    for exact in symmetric_orbits(p, period):
        nudged = exact.t + np.array([0.01, -0.02])
        found = find_orbit(exact.word, p, guess=nudged)
        assert found.orbit_id == exact.orbit_id
        np.testing.assert_allclose(found.states, exact.states, rtol=0, atol=1e-12)
        np.testing.assert_allclose(found.multipliers, exact.multipliers, rtol=1e-9)
        assert find_orbit(exact.word, p, guess=exact).orbit_id == exact.orbit_id


@pytest.mark.parametrize(("word", "A"), [("LLR", 0.023), ("LRLR/2T", 0.021), ("LLRR", 0.05), ("LLRLR/2T", 0.05)])
def test_found_orbits_close_and_balance(word, A, independent):
    orbit = find_orbit(word, P.replace(A=A))
    assert orbit.word == Word(word)
    assert orbit.admissible
    assert orbit.residual < 5e-14
    assert abs(orbit.energy_imbalance) < 1e-12
    for j, tau in enumerate(orbit.flight_times):
        end = independent.fly(orbit.params, orbit.states[j], orbit.phase[j], tau)
        np.testing.assert_allclose(end, orbit.states[(j + 1) % len(orbit.t)], rtol=0, atol=1e-13)


@pytest.mark.parametrize(("word", "A"), [("LLR", 0.023), ("LRLR/2T", 0.021), ("LLRR", 0.05)])
def test_the_simulator_stays_on_a_stable_orbit(word, A):
    orbit = find_orbit(word, P.replace(A=A))
    assert orbit.stable
    run = simulate(orbit.params, **orbit.start(), periods=300)
    N = len(orbit.t)
    np.testing.assert_allclose(np.sort(run.impacts["w_dot"][-N:]), np.sort(orbit.w_dot), rtol=0, atol=1e-11)
    assert "".join("L" if side > 0 else "R" for side in run.impacts["side"][-N:]) in orbit.word.letters * 2


def test_multipliers_of_2_1_agree_with_differences_in_high_precision(independent):
    orbit = find_orbit("LLR", P)
    sides = orbit.side.tolist()
    with mp.workdps(40):

        def around(*y):
            for j in range(3):
                y = independent.map_to(P, sides[j], sides[(j + 1) % 3], y, mp.mpf(orbit.flight_times[j]))
            return y

        start = [mp.mpf(v) for v in (orbit.states[0, 1], orbit.states[0, 3], orbit.states[0, 2], orbit.t[0])]
        M = mp.matrix(4, 4)
        step = mp.mpf(10) ** -13
        for k in range(4):
            up, down = list(start), list(start)
            up[k] += step
            down[k] -= step
            for i, (a, b) in enumerate(zip(around(*up), around(*down), strict=True)):
                M[i, k] = (a - b) / (2 * step)
        exact = [complex(v) for v in mp.eig(M)[0]]
    np.testing.assert_allclose(np.sort_complex(orbit.multipliers), np.sort_complex(exact), rtol=0, atol=1e-10)


def test_an_orbit_run_twice_is_no_orbit_of_the_doubled_word():
    once = find_orbit("LR", P.replace(A=0.017))
    with pytest.raises(OrbitNotFound, match="shorter period"):
        find_orbit("LRLR/2T", once.params, guess=np.append(once.t, once.t + once.period))


def test_the_search_says_how_near_it_came():
    with pytest.raises(OrbitNotFound, match="left a defect of") as caught:
        find_orbit("LLR", P.replace(A=0.001))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("guess", "said"),
    [([0.0, 1.0], "3 increasing times"), ([0.0, 2.0, 1.0], "3 increasing times"), ([0.0, 1.0, 9.0], "3 increasing")],
)
def test_a_guess_has_to_fit_the_word(guess, said):
    with pytest.raises(ParameterError, match=said):
        find_orbit("LLR", P, guess=guess)
    with pytest.raises(ParameterError, match="not of LLR"):
        find_orbit("LLR", P, guess=find_orbit("LR", P))


def test_the_asymmetric_pair_comes_out_of_the_symmetry_breaking(asymmetric):
    down = continue_orbit(asymmetric, "A", 0.017)
    assert down.ends == ("range", "symmetry_breaking")
    mother = continue_orbit(find_orbit("LR", P.replace(A=0.017)), "A", 0.019).bifurcations[0]
    assert down.bifurcations[-1].value == pytest.approx(mother.value, abs=1e-10)


def test_the_doubled_orbit_comes_out_of_the_period_doubling_that_the_paper_gives(asymmetric):
    [doubling] = continue_orbit(asymmetric, "A", 0.021).bifurcations
    assert doubling.type == "period_doubling"
    assert doubling.value == pytest.approx(0.0205, abs=5e-5)
    assert doubling.multiplier == pytest.approx(-1, abs=1e-11)
    down = continue_orbit(find_orbit("LRLR/2T", P.replace(A=0.021)), "A", 0.0195)
    assert down.ends == ("range", "period_doubling")
    assert down.bifurcations[-1].value == pytest.approx(doubling.value, abs=1e-10)


def test_2_1_goes_through_its_fold_and_back():
    branch = continue_orbit(find_orbit("LLR", P), "A", 0.018)
    assert [b.type for b in branch.bifurcations] == ["neimark_sacker", "fold"]
    assert max(orbit.residual for orbit in branch.orbits) < 1e-12
    assert branch.orbits[0].stable
    assert not branch.orbits[-1].stable
    assert branch.values[-1] == branch.values[0]


def test_a_symmetric_2_2_orbit_stays_symmetric_beyond_its_symmetry_breaking():
    branch = continue_orbit(find_orbit("LLRR", P.replace(A=0.05)), "A", 0.07)
    assert all(orbit.symmetric for orbit in branch.orbits)
    [breaking] = branch.bifurcations
    assert breaking.type == "symmetry_breaking"
    assert breaking.half_multiplier == pytest.approx(-1, abs=1e-10)
    assert breaking.multiplier == pytest.approx(1, abs=1e-10)


@pytest.mark.parametrize(("parameter", "stop"), [("Omega", 1.1), ("mu", 0.02), ("r", 1.0), ("lam", 0.05)])
def test_2_1_can_be_followed_in_every_parameter(parameter, stop):
    branch = continue_orbit(find_orbit("LLR", P), parameter, stop)
    assert max(orbit.residual for orbit in branch.orbits) < 1e-12
    assert branch.ends[1] == "range"
