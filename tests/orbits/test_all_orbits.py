"""All orbits of a word: complete for two and three impacts, honest about the rest."""

import mpmath as mp
import numpy as np
import pytest

from vines.dynamics._room import constants
from vines.errors import OrbitNotFound
from vines.model import Params, Word
from vines.orbits import all_orbits, find_orbit, symmetric_orbits
from vines.orbits._boxes import NODES
from vines.orbits._equations import newton_kernel
from vines.orbits._flights import linear_kernel, sample_kernel, start_kernel
from vines.orbits._general import ITERATIONS, proper, same
from vines.orbits._shortest import shortest_crossing
from vines.orbits._tails import tails

pytestmark = pytest.mark.long(14)

P = Params(mu=0.01, A=0.02)
SHORT = ("LR", "LLR", "LRR", "LR/2T", "LR/3T", "LLR/2T")


def random_params(rng):
    return Params(
        mu=10 ** rng.uniform(np.log10(0.005), 0),
        A=10 ** rng.uniform(-2, 0),
        Omega=rng.uniform(0.6, 1.6),
        r=rng.uniform(0.3, 0.9),
    )


def multistart(word, p, starts):
    """The different solutions that Newton's method finds from random starts: brute force."""
    rng = np.random.default_rng(7)
    c, duration, side, found = constants(p), word.p * p.period, np.array(word.sides), []
    for _ in range(starts):
        flights = rng.dirichlet(np.ones(len(word))) * duration
        t = rng.uniform(0, p.period) + np.concatenate([[0.0], np.cumsum(flights[:-1])])
        converged, t, _, states = newton_kernel(c, duration, side, t, ITERATIONS)
        if converged and proper(word, duration, t, states):
            found.append((t, states))
    return found


def counts(points, starts):
    """Check that brute force finds what all_orbits lists, no more and no less; return how many orbits that were."""
    rng = np.random.default_rng(20)
    total = 0
    for k in range(points):
        word, p = Word(SHORT[k % len(SHORT)]), random_params(rng)
        orbits = all_orbits(word, p)
        assert orbits.complete
        hits = multistart(word, p, starts)
        assert all(any(same(orbit, *hit) for orbit in orbits) for hit in hits), (word, p)
        assert all(any(same(orbit, *hit) for hit in hits) for orbit in orbits), (word, p)
        total += len(orbits)
    return total


def test_the_count_is_that_of_a_brute_force_multistart():
    assert counts(18, 400) >= 10


@pytest.mark.full
def test_the_count_is_that_of_a_brute_force_multistart_in_full():
    assert counts(180, 1000) >= 150


@pytest.mark.parametrize("word", ["LR", "LLR", "LR/2T"])
def test_every_orbit_listed_closes_and_balances(word):
    rng = np.random.default_rng(5)
    for _ in range(6):
        p = random_params(rng)
        for orbit in all_orbits(word, p):
            assert orbit.word == Word(word)
            assert orbit.residual < 1e-11 * max(1, np.abs(orbit.states).max())
            assert abs(orbit.energy_imbalance) < 1e-10


def test_the_diagram_of_fig_4_and_5():
    """Fold, symmetric alone, the asymmetric pair, 2:1: what the paper shows at mu = .01 (Figs 4, 5)."""
    table = ((0.007, 0, 0, 0), (0.009, 2, 0, 0), (0.015, 1, 0, 0), (0.019, 1, 2, 0), (0.023, 1, 2, 2))
    for A, symmetric, asymmetric, two_one in table:
        orbits = [orbit for orbit in all_orbits("LR", P.replace(A=A)) if orbit.admissible]
        assert sum(orbit.symmetric for orbit in orbits) == symmetric
        assert sum(not orbit.symmetric for orbit in orbits) == asymmetric
        assert sum(orbit.admissible for orbit in all_orbits("LLR", P.replace(A=A))) == two_one


def test_mirror_images_are_listed_apart_where_the_word_is_its_own_mirror():
    one, other = (orbit for orbit in all_orbits("LR", P) if not orbit.symmetric)
    np.testing.assert_allclose(one.flight_times, other.flight_times[::-1], atol=1e-12)
    np.testing.assert_allclose(one.states, -other.states[::-1], atol=1e-12)
    p = P.replace(A=0.021)
    doubled = [orbit for orbit in all_orbits("LRLR/2T", p) if orbit.admissible]
    assert len(doubled) == 2
    left, right = all_orbits("LLR", p), all_orbits("LRR", p)
    assert [o.max_multiplier for o in left] == pytest.approx([o.max_multiplier for o in right], rel=1e-9)


def test_symmetric_orbits_of_four_impacts_are_found_among_all():
    orbits = all_orbits("LLRR", P.replace(A=0.05))
    assert not orbits.complete
    assert "of symmetric orbits none is missing" in orbits.remark
    assert any(orbit.symmetric and orbit.stable and orbit.admissible for orbit in orbits)


def test_words_on_one_wall_have_no_orbits():
    assert all_orbits("LL", P) == []
    assert all_orbits("LL", P).complete
    with pytest.raises(OrbitNotFound, match="pushes the ball the same way"):
        find_orbit("LLL", P)


def test_the_remark_of_find_orbit_counts_the_asymmetric_pair():
    orbit = find_orbit("LR", P.replace(A=0.019))
    assert orbit.symmetric
    assert orbit.remark.startswith("2 other solutions of this word, of which 2 admissible, 0 symmetric, 2 stable")
    assert "all flight times searched" in orbit.remark


def test_where_a_run_sticks_the_word_without_a_star_says_that_it_is_of_no_run():
    p = Params(mu=0.0256654, A=0.965717, Omega=1.02946, r=0.347164, lam=0.0959532)
    orbit = find_orbit("LR", p)
    assert not orbit.admissible
    assert "orbits that stick have other words" in orbit.remark
    assert orbit.remark.endswith("vines.settle says what one settles to, and its word")
    assert "none is admissible" not in find_orbit("LR", P).remark


def test_given_its_flight_times_an_orbit_is_linear(independent):
    """The rows of the linear problem vanish on an orbit, and its phase comes out; also for half a symmetric one."""
    for word, half in (("LLR", False), ("LR", False), ("LLRR", True)):
        orbit = next(o for o in all_orbits(word, P.replace(A=0.05)) if o.symmetric or not half)
        N = len(orbit.t) // (2 if half else 1)
        tau, side = orbit.flight_times[:N], orbit.side[:N].astype(np.int64)
        c, flip = constants(orbit.params), -1 if half else 1
        R = np.empty((N, 3))
        assert linear_kernel(c, tau.sum(), flip, side, tau, R) != 0
        assert np.linalg.svd(R)[1][-1] < 1e-12 or N == 2
        if not (word == "LR" and orbit.symmetric):
            start = start_kernel(c, tau.sum(), flip, side, tau)
            assert start == pytest.approx(orbit.t[0] % orbit.params.period, abs=1e-9)


def test_the_limit_of_asymmetric_orbits_is_the_symmetry_breaking():
    """A(theta) -> the amplitude at which the symmetric orbit loses its symmetry (facts: (4 A(.4995) - A(.499))/3)."""

    def amplitude(theta):
        p = P.replace(A=1.0)
        R = np.empty((2, 3))
        linear_kernel(constants(p), p.period, 1, np.array([1, -1]), p.period * np.array([theta, 1 - theta]), R)
        a, b = np.linalg.solve(R[:, :2], -R[:, 2])
        return np.hypot(a, b) / abs(complex(constants(p).free.qr, constants(p).free.qi))

    assert (4 * amplitude(0.4995) - amplitude(0.499)) / 3 == pytest.approx(0.01800761, abs=2e-8)


def test_near_the_symmetry_breaking_the_pair_is_still_found():
    for above in (1e-5, 1e-7):
        orbits = all_orbits("LR", P.replace(A=0.01800761 + above))
        assert sum(not orbit.symmetric for orbit in orbits) == 2
    assert len(all_orbits("LR", P.replace(A=0.0179))) == len(symmetric_orbits(P.replace(A=0.0179)))


def test_one_orbit_in_forty_digits(independent):
    orbit = next(o for o in all_orbits("LR", P) if not o.symmetric)
    with mp.workdps(40):
        y = [mp.mpf(v) for v in (orbit.states[0, 1], orbit.states[0, 3], orbit.states[0, 2], orbit.t[0])]
        start = list(y)
        for j in range(2):
            side = orbit.side.tolist()
            y = independent.map_to(P, side[j], side[1 - j], y, mp.mpf(orbit.flight_times[j]))
        assert max(abs(a - b) for a, b in zip(y[:3], start[:3], strict=True)) < 1e-13
        assert abs(y[3] - start[3] - 2 * mp.pi) < 1e-13


@pytest.mark.parametrize(("text", "halves"), [("LR", False), ("LLR", False), ("LLR/2T", False), ("LLRR", True)])
def test_no_interpolant_is_farther_from_its_function_than_its_bound(text, halves):
    word, rng = Word(text), np.random.default_rng(4)
    flip, N = (-1, len(word) // 2) if halves else (1, len(word))
    side = np.array(word.sides[1:] + word.sides[:1] if text == "LLRR" else word.sides, dtype=np.int64)[:N]
    half, dimension = N == 2 and not halves, N - 1
    worst = 0.0
    for width in (1 / 12, 1 / 48, 1 / 384):
        p = random_params(rng)
        c, span = constants(p), word.p * p.period * N / len(word)
        low = rng.uniform(0, 1 - width, (40, dimension))
        bound = tails(c, span, flip, side, half, low, width, len(NODES))
        places = rng.uniform(0.05, 0.95, 6)
        values = [np.empty((40, len(at) ** dimension, 1 if N == 2 else 4)) for at in (NODES, places)]
        for at, out in zip((NODES, places), values, strict=True):
            sample_kernel(c, span, flip, side, half, low, width, at, out)
        nodal, true = (v.reshape(40, *[len(at)] * dimension, -1) for v, at in zip(values, (NODES, places), strict=True))
        lagrange = np.array([[np.prod([(x - m) / (n - m) for m in NODES if m != n]) for n in NODES] for x in places])
        ours = (
            np.einsum("ai,mif->maf", lagrange, nodal)
            if dimension == 1
            else np.einsum("ai,bj,mijf->mabf", lagrange, lagrange, nodal)
        )
        wrong = np.abs(ours - true).reshape(40, -1, true.shape[-1]).max(axis=1)
        rounding = 1e-12 * np.abs(nodal).reshape(40, -1, true.shape[-1]).max(axis=1)
        assert np.all(wrong <= bound + rounding)
        worst = max(worst, float((wrong / bound).max()))
    assert worst > 1e-12


def test_no_orbit_crosses_the_cavity_faster_than_the_balance_of_energy_allows():
    rng = np.random.default_rng(8)
    met = 0
    for k in range(24):
        word, p = Word(SHORT[k % len(SHORT)]), random_params(rng)
        least = shortest_crossing(p, len(word), word.p * p.period)
        assert 0 < least < word.p * p.period
        for orbit in all_orbits(word, p):
            crosses = orbit.side != np.roll(orbit.side, -1)
            assert np.all(orbit.flight_times[crosses] > least)
            met += 1
    assert met > 10
    assert shortest_crossing(Params(mu=0.01, A=0.02, Omega=1.1, lam=0.0), 2, 6.0) == 0.0


@pytest.mark.parametrize("text", ["LR", "LLR"])
def test_a_search_by_bounds_finds_the_same(text):
    p = Params(mu=0.01, A=0.022)
    estimated, proved = all_orbits(text, p), all_orbits(text, p, proof=True)
    assert proved.complete
    assert "bounds" in proved.remark
    assert "bounds" not in estimated.remark
    assert [orbit.t.tolist() for orbit in proved] == [pytest.approx(orbit.t.tolist(), abs=1e-10) for orbit in estimated]
