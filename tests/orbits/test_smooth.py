"""Orbits without impacts against closed forms, harmonic balance of many harmonics, and DOP853."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import minimize_scalar, root

import vines
from vines import systems
from vines.attractors import orbit_of
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params, Word
from vines.orbits import all_orbits, continue_orbit, find_orbit, follow_curve, mirror_image, switch_branch

C8 = systems.CubicBarriers(mu=0.05, A=0.05, k3=3.0, l2=0.2, walls=False)
SOFT = systems.CubicBarriers(mu=0.05, A=0.02, k3=3.0, l2=0.05, lam=0.01, walls=False)
DETUNED = SOFT.replace(A=0.01, Omega=0.9)


def rates(p):
    """Return the equations of flight in (x1, v1, x2, v2), and of disturbances behind them."""

    def f(t, y):
        x1, v1, x2, v2 = y[:4]
        w, u = x1 - x2, v1 - v2
        spring = p.k1 * w + p.k3 * w**3 + p.l2 * u
        force = p.A * (math.sin(p.Omega * t) + p.lam * p.Omega * math.cos(p.Omega * t))
        a = np.array([p.k1 + 3 * p.k3 * w * w, p.l2, -p.k1 - 3 * p.k3 * w * w, -p.l2])
        J = np.array([[0, 1, 0, 0], [-1, -p.lam, 0, 0] - p.mu * a, [0, 0, 0, 1], a])
        return [v1, force - p.lam * v1 - x1 - p.mu * spring, v2, spring, *(J @ y[4:].reshape(4, 4)).ravel()]

    return f


def flown(p, start, span):
    """Return the state after a time from phase 0 and the tangent map, by DOP853."""
    found = solve_ivp(rates(p), (0, span), [*start, *np.eye(4).ravel()], "DOP853", rtol=1e-12, atol=1e-14)
    return found.y[:4, -1], found.y[4:, -1].reshape(4, 4)


def half_map(p, start):
    """Return the symmetric orbit near a state, and its half map, both by DOP853 and Newton's method."""
    for _ in range(2):
        end, Y = flown(p, start, p.period / 2)
        start = start - np.linalg.solve(-Y - np.eye(4), -end - start)
    return start, -flown(p, start, p.period / 2)[1]


def same_roots(a, b):
    return np.sort_complex(np.round(a, 9)) == pytest.approx(np.sort_complex(np.round(b, 9)), abs=1e-8)


class Balance:
    """Harmonic balance of w and x1 in odd harmonics: independent of every flight."""

    def __init__(self, p, harmonics=12):
        self.p, self.k = p, np.arange(1, 2 * harmonics, 2)
        self.theta = 2 * np.pi * np.arange(8 * harmonics) / (8 * harmonics)
        self.e = np.exp(1j * np.outer(self.theta, self.k))
        own = 1 - (self.k * p.Omega) ** 2 + 1j * p.lam * self.k * p.Omega
        self.own, self.force = own, np.zeros(len(self.k), complex)

    def spring(self, W):
        p = self.p
        w = (self.e @ W).imag
        f = np.fft.fft(p.k3 * w**3)[self.k] * 2 / len(w)
        return 1j * f + (p.k1 + 1j * p.l2 * self.k * p.Omega) * W

    def defect(self, W, A):
        p, S = self.p, self.spring(W)
        force = self.force.copy()
        force[0] = A * (1 + 1j * p.lam * p.Omega)
        X = W - S / (self.k * p.Omega) ** 2
        return self.own * X + p.mu * S - force

    def amplitude(self, size, guess):
        """Return the A at which the first harmonic of w has a size, and the harmonics of w."""
        n = len(self.k)

        def f(z):
            W = z[:n] + 1j * z[n : 2 * n]
            d = self.defect(W, z[-1])
            return np.concatenate([d.real, d.imag, [abs(W[0]) - size]])

        found = root(f, guess, tol=1e-13)
        return found.x

    def start(self, z):
        """Return x1, v1, x2, v2 at phase 0."""
        n, rate = len(self.k), 1j * self.k * self.p.Omega
        W = z[:n] + 1j * z[n : 2 * n]
        X = W - self.spring(W) / (self.k * self.p.Omega) ** 2
        return [X.sum().imag, (rate * X).sum().imag, (X - W).sum().imag, (rate * (X - W)).sum().imag]


def test_the_check_value_with_barriers_and_without():
    for p in (C8, C8.replace(walls=1.0)):
        orbit = find_orbit("-", p, guess=[-0.13, -0.24, -0.08, -0.84])
        assert (str(orbit.word), orbit.name, orbit.alias) == ("-", "0:0", "0:0")
        assert orbit.measures.kinetic_ratio == pytest.approx(0.652355764370, abs=1e-12)
        assert orbit.measures.max_abs_x1 == pytest.approx(0.271962210333, abs=1e-12)
        assert (orbit.symmetric, orbit.stable, orbit.admissible) == (True, True, True)
        assert abs(orbit.energy_imbalance) < 1e-13
        assert orbit.residual < 1e-14
        assert (math.isnan(orbit.min_clearance)) == (not p.walls)
    settled = vines.settle(C8)
    orbit = find_orbit("0:0", C8)
    assert orbit_of(settled).states == pytest.approx(orbit.states, abs=1e-11)
    assert same_roots(settled.multipliers, orbit.multipliers)


def test_a_linear_absorber_has_its_closed_form():
    p = systems.CubicBarriers(mu=0.05, A=0.05, Omega=0.97, k1=0.9, l2=0.03, walls=False)
    [orbit] = all_orbits("-", p)
    kappa = p.k1 + 1j * p.l2 * p.Omega
    # x2'' = kappa w and x1'' + lam x1' + x1 + mu kappa w = F of the phasors
    M = np.array([[1 - p.Omega**2 + 1j * p.lam * p.Omega + p.mu * kappa, -p.mu * kappa], [-kappa, kappa - p.Omega**2]])
    X = np.linalg.solve(M, [p.A * (1 + 1j * p.lam * p.Omega), 0])
    rate = 1j * p.Omega
    assert orbit.states[0] == pytest.approx([*np.ravel([[x.imag, (rate * x).imag] for x in X])], abs=1e-13)
    assert orbit.measures.max_abs_x1 == pytest.approx(abs(X[0]), rel=1e-13)
    J = np.array([[0, 1, 0, 0], [-1 - p.mu * p.k1, -p.lam - p.mu * p.l2, p.mu * p.k1, p.mu * p.l2],
                  [0, 0, 0, 1], [p.k1, p.l2, -p.k1, -p.l2]])  # fmt: skip
    assert same_roots(orbit.multipliers, np.linalg.eigvals(expm(J * p.period)))


def test_three_sheets_and_their_folds_against_harmonic_balance():
    found = all_orbits("-", DETUNED)
    assert sorted((o.symmetric, o.stable) for o in found) == [(True, False), (True, True), (True, True)]
    balance = Balance(DETUNED)
    sheets = []
    for orbit in found:
        # Fourier coefficients of its w, from which the balance goes on
        samples = vines.simulate(DETUNED, **orbit_start(orbit), periods=1).sample(times=balance.theta / DETUNED.Omega)
        W = 1j * np.fft.fft(samples["w"])[balance.k] * 2 / len(balance.theta)
        solved = balance.amplitude(abs(W[0]), [*W.real, *W.imag, DETUNED.A])
        assert solved[-1] == pytest.approx(DETUNED.A, abs=1e-12)
        assert balance.start(solved) == pytest.approx(orbit.states[0], abs=1e-10)
        sheets.append((abs(W[0]), solved))
    lowest = min(found, key=lambda o: o.measures.max_abs_x1)
    branch = continue_orbit(lowest, "A", 0.06, within=(0.005, 0.06), step=0.2)
    folds = sorted(each.value for each in branch.bifurcations if each.type == "fold")
    assert len(folds) == 2
    small, middle, large = sorted(sheets, key=lambda each: each[0])
    for (low, guess), (high, _), sign, fold in ((small, middle, -1, folds[1]), (middle, large, 1, folds[0])):
        at = minimize_scalar(
            lambda size: sign * balance.amplitude(size, guess)[-1], bounds=(low, high), method="bounded",  # noqa: B023
            options={"xatol": 1e-6},
        )  # fmt: skip
        assert sign * at.fun == pytest.approx(fold, abs=1e-10)


def orbit_start(orbit) -> dict[str, Any]:
    return dict(zip(("x1", "v1", "x2", "v2"), orbit.states[0].tolist(), strict=True))


def test_beside_a_neimark_sacker_point_runs_settle_to_a_torus():
    p = systems.CubicBarriers(mu=0.05, A=0.018, k3=1.0, l2=0.2, lam=0.012, walls=False)
    torus, chaos = vines.settle(p, errors=False), vines.settle(SOFT, errors=False)
    assert (torus.regime, torus.settled, torus.name) == ("quasiperiodic", True, None)
    assert abs(torus.lyapunov) < 3 * torus.lyapunov_error < 1e-3
    assert (chaos.regime, chaos.settled) == ("chaotic", True)
    assert chaos.lyapunov > 5 * chaos.lyapunov_error
    for found in (torus, chaos):
        # phase volumes shrink by both dampers
        q = found.params
        assert found.exponents.sum() == pytest.approx(-(q.lam + (1 + q.mu) * q.l2), abs=1e-13)
    with pytest.raises(ParameterError, match=r"vines\.Params alone"):
        orbit_of(chaos)


@pytest.mark.full
def test_the_exponent_of_chaos_against_dop853():
    rng = np.random.default_rng(5)
    end = vines.simulate(SOFT, periods=300).final
    y = np.array([*(end[name] for name in ("x1", "v1", "x2", "v2")), *rng.normal(size=16)])
    grown = 0.0
    for k in range(340):
        y = solve_ivp(rates(SOFT), (0, SOFT.period), y, "DOP853", rtol=1e-9, atol=1e-12).y[:, -1]
        column = y[4:].reshape(4, 4)[:, 0]
        if k >= 40:
            grown += np.log(np.linalg.norm(column))
        y[4:] = np.tile(column / np.linalg.norm(column), (4, 1)).T.ravel()
    found = vines.settle(SOFT, errors=False)
    assert grown / (300 * SOFT.period) == pytest.approx(found.lyapunov, abs=6 * found.lyapunov_error)


def test_neimark_sacker_where_a_multiplier_of_dop853_crosses_the_circle():
    branch = continue_orbit(find_orbit("-", SOFT, guess=[-0.0499, 0.1534, 0.021, -0.3459]), "A", 0.005, step=0.2)
    [met] = branch.bifurcations
    assert met.type == "neimark_sacker"
    assert abs(abs(met.multiplier) - 1) < 1e-12
    sizes = []
    for A in (met.value * (1 - 1e-4), met.value, met.value * (1 + 1e-4)):
        p = SOFT.replace(A=A)
        _, H = half_map(p, np.array(met.orbit.states[0]))
        sizes.append(np.abs(np.linalg.eigvals(H)).max() - 1)
    assert sizes[0] < 0 < sizes[2]
    assert abs(sizes[1]) < 1e-6 * (sizes[2] - sizes[0]) / 2e-4
    curve = follow_curve(met, ("A", "l2"), box={"A": (0.006, 0.008), "l2": (0.045, 0.055)}, step=0.2)
    assert curve.ends == ("box", "box")
    assert curve.residuals.max() < 1e-13
    orbit = curve.orbits[0]
    _, H = half_map(orbit.params, np.array(orbit.states[0]))
    assert np.abs(np.linalg.eigvals(H)).max() == pytest.approx(1, abs=1e-9)


def test_symmetry_breaks_and_the_period_doubles():
    first = find_orbit("-", SOFT.replace(A=0.09), guess=[-0.1259, -0.9103, -0.1729, -1.5206])
    branch = continue_orbit(first, "A", 0.11, step=0.3)
    [breaking] = [each for each in branch.bifurcations if each.type == "symmetry_breaking"]
    assert breaking.half_multiplier == pytest.approx(-1, abs=1e-10)
    assert all(each.symmetric for each in branch.orbits)
    first, second = switch_branch(breaking)
    assert not first.symmetric
    assert mirror_image(first).states == pytest.approx(second.states, abs=1e-11)
    on = continue_orbit(first, "A", 0.118, step=0.3)
    [doubling] = on.bifurcations
    assert doubling.type == "period_doubling"
    assert doubling.multiplier == pytest.approx(-1, abs=1e-9)
    [twice] = switch_branch(doubling)
    assert (str(twice.word), twice.name, twice.stable) == ("-/2T", "0:0/2T", True)
    p = twice.params
    end, Y = flown(p, twice.states[0], 2 * p.period)
    assert end == pytest.approx(twice.states[0], abs=1e-10)
    assert same_roots(twice.multipliers, np.linalg.eigvals(Y))
    around = continue_orbit(twice, "A", 0.13, step=0.3)
    assert around.ends[1] == "period_doubling"
    with pytest.raises(OrbitNotFound, match="shorter period"):
        find_orbit("-/2T", p, guess=find_orbit("-", p, guess=branch.orbits[-1]).states[0])
    flips = follow_curve(doubling, ("A", "l2"), box={"A": (0.11, 0.12), "l2": (0.048, 0.052)}, step=0.3)
    assert flips.type == "period_doubling"
    assert flips.residuals.max() < 1e-13


def test_a_family_ends_where_it_grazes_a_barrier():
    p = SOFT.replace(walls=1.0, A=0.02, k3=1.0, l2=0.1)
    branch = continue_orbit(find_orbit("-", p, guess=[-0.2361, 0.3548, 0.0543, -0.3357]), "A", 0.05, step=0.3)
    assert branch.ends == ("range", "grazing")
    graze = branch.bifurcations[-1]
    assert graze.type == "grazing"
    assert 0 < graze.orbit.min_clearance < 1e-14
    found = solve_ivp(
        rates(graze.params), (0, p.period), [*graze.orbit.states[0], *np.eye(4).ravel()], "DOP853",
        t_eval=np.linspace(0, p.period, 5001), rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    assert np.abs(found.y[0] - found.y[2]).max() == pytest.approx(1, abs=1e-6)
    curve = follow_curve(graze, ("A", "l2"), box={"A": (0.03, 0.045), "l2": (0.09, 0.11)}, step=0.3)
    assert curve.residuals.max() < 1e-13
    assert all(abs(each.min_clearance) < 1e-12 for each in curve.orbits)
    beyond = find_orbit("-", p.replace(A=0.04), guess=graze.orbit)
    assert not beyond.admissible
    assert beyond.violation_side in (1, -1)


def test_an_isola_is_followed_once_round():
    p = systems.CubicBarriers(mu=0.05, A=0.015, Omega=0.92, k3=3.0, l2=0.1, walls=False)
    large = max(all_orbits("-", p), key=lambda orbit: orbit.measures.max_abs_x1)
    branch = continue_orbit(large, "Omega", 1.0, within=(0.85, 1.0), step=0.3)
    assert branch.ends == ("closed", "closed")
    assert [each.type for each in branch.bifurcations] == ["fold", "fold"]
    assert branch.orbits[-1] is branch.orbits[0]
    assert branch.values.min() > 0.88
    assert branch.values.max() < 0.957


def test_what_has_no_such_orbit_says_why():
    with pytest.raises(ParameterError, match="no isolated orbits"):
        find_orbit("-", Params(mu=0.01, A=0.02))
    with pytest.raises(ParameterError, match="k1 = k3 = 0"):
        find_orbit("-", systems.CubicBarriers(mu=0.01, A=0.02))
    with pytest.raises(ParameterError, match="the 4 numbers x1, v1, x2, v2 at phase 0"):
        find_orbit("-", C8, guess=[0.1, 0.2])
    with pytest.raises(ParameterError, match="orbits without any have the words -"):
        find_orbit("LR", C8)
    assert Word("0:0/3T") == Word("-/3T")
    assert (Word("-").symmetric, Word("-/2T").symmetric, Word("-/3T").symmetric) == (True, False, True)
