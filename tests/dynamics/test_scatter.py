"""Scatter: without any it is the model, its draws are reproducible whatever the cores, and its energy balances."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from vines.dynamics import Scatter, ensemble, simulate
from vines.dynamics._ensemble import _Runs
from vines.dynamics._lane_run import WITH_IMPACTS, WITH_MEASURES
from vines.dynamics._random import fill_normals, normal
from vines.errors import ParameterError, StateError
from vines.model import Params

P = Params(mu=0.01, A=0.02)
V2 = np.linspace(0.05, 0.2, 130)


def test_without_scatter_it_is_the_model() -> None:
    many = ensemble(P, {"v2": V2[:5]}, periods=5, record="impacts", scatter=Scatter(seed=1))
    assert many.impacts is not None
    for k in range(5):
        ours = many.impacts[many.impacts["run"] == k]
        model = simulate(P, v2=float(V2[k]), periods=5).impacts
        n = min(len(ours), len(model), 4)
        assert n >= 2
        for name in ("t", "side", "v1", "v2", "x1"):
            assert ours[name][:n] == pytest.approx(model[name][:n], abs=1e-9)


@pytest.mark.parametrize(
    "scatter", [Scatter(sigma_r=0.05, seed=4), Scatter(noise=0.1, second=0.2, second_phase=0.3, r_speed=0.05, seed=4)]
)
def test_draws_do_not_depend_on_cores_and_energy_balances(scatter: Scatter) -> None:
    one = ensemble(P, {"v2": V2}, periods=6, record="measures", scatter=scatter, threads=1)
    two = ensemble(P, {"v2": V2}, periods=6, record="measures", scatter=scatter, threads=2)
    assert np.array_equal(one.final, two.final)
    assert one.scatter == scatter
    m = one.measures
    assert m is not None
    balance = m["base_work"] - m["damper_loss"] - m["impact_loss_left"] - m["impact_loss_right"] - m["energy_change"]
    assert np.max(np.abs(balance)) < 1e-12


def test_trajectories_draw_from_streams_of_their_own() -> None:
    same = ensemble(P, {"v2": [0.1, 0.1]}, periods=30, scatter=Scatter(sigma_r=0.05, seed=4))
    other = ensemble(P, {"v2": [0.1]}, periods=30, scatter=Scatter(sigma_r=0.05, seed=5))
    assert same.final["x1"][0] != same.final["x1"][1]
    assert same.final["x1"][0] != other.final["x1"][0]


def test_forces_drawn_ahead_are_the_numbers_drawn_one_by_one() -> None:
    ahead = np.empty(3001)
    fill_normals(7, 3, 5, 2, ahead)
    assert ahead == pytest.approx([normal(7, 3, 5 + 2 * k) for k in range(len(ahead))], abs=1e-14)


@pytest.mark.parametrize("p", [P, Params(mu=0.1, A=0.3), Params(mu=0.5, A=0.3)])
def test_a_second_harmonic_of_no_size_changes_no_energies(p: Params) -> None:
    # Without one the integrals are those of the model; with one, forms of their own.
    one, other = (
        ensemble(
            p, {"v2": V2[:3]}, periods=4, record="measures", scatter=Scatter(noise=0.1, second=second, seed=2)
        ).measures
        for second in (0.0, 1e-15)
    )
    assert one is not None
    assert other is not None
    for name in ("base_work", "damper_loss", "kinetic_1", "rms_x1", "max_abs_x1"):
        assert one[name] == pytest.approx(other[name], rel=1e-8)


@pytest.mark.parametrize(
    ("Omega", "lam", "A", "periods"),
    [
        (1.0, 0.0, 0.01, 3.0),
        (1.0, 0.004, 0.01, 3.0),
        (1.003, 0.001, 0.01, 3.0),
        (0.5, 0.0, 0.02, 2.0),
        (0.5, 0.004, 0.02, 2.0),
        (0.499, 0.001, 0.02, 2.0),
        (1.3, 0.012, 0.01, 3.0),
        (1.1, 0.3, 60.0, 0.02),
    ],
)
def test_energies_of_a_flight_under_both_harmonics_are_those_of_an_integrator(
    Omega: float, lam: float, A: float, periods: float
) -> None:
    # At the resonance of the first harmonic, at that of the second, away from both, and where both responses are large.
    p, share, ahead = Params(mu=0.01, A=A, Omega=Omega, lam=lam), 0.3, 0.7
    scatter = Scatter(second=share, second_phase=ahead, seed=1)
    run = ensemble(p, {"x1": [0.1], "v1": [0.02], "v2": [0.0]}, periods=periods, record="measures", scatter=scatter)

    def motion(t: float, y: np.ndarray) -> list[float]:
        x, v = y[:2]
        e = A * (np.sin(Omega * t) + share * np.sin(2 * Omega * t + ahead))
        e_dot = A * Omega * (np.cos(Omega * t) + 2 * share * np.cos(2 * Omega * t + ahead))
        spring, slip = x - e, v - e_dot
        return [v, -spring - lam * slip, x * x, v * v, -(spring + lam * slip) * e_dot, lam * slip * slip]

    duration = periods * p.period
    there = solve_ivp(
        motion, (0.0, duration), [0.1, 0.02, 0, 0, 0, 0], method="DOP853", rtol=1e-13, atol=1e-15, dense_output=True
    )
    x, v, square, speed, work, lost = there.y[:, -1]
    m = run.measures
    assert m is not None
    assert m["impacts_left"][0] + m["impacts_right"][0] == 0
    assert run.final["x1"][0] == pytest.approx(x, abs=2e-11)
    assert run.final["v1"][0] == pytest.approx(v, abs=2e-11)
    assert m["rms_x1"][0] ** 2 * duration == pytest.approx(square, rel=1e-11)
    assert 2 * m["kinetic_1"][0] * duration == pytest.approx(speed, rel=1e-11)
    assert m["base_work"][0] == pytest.approx(work, rel=1e-11)
    assert m["damper_loss"][0] == pytest.approx(lost, rel=1e-11, abs=1e-15)
    densely = there.sol(np.linspace(0.0, duration, 20_001))[0]
    assert m["max_abs_x1"][0] == pytest.approx(np.max(np.abs(densely)), rel=1e-7)


def test_restitution_has_the_mean_and_spread_asked_for() -> None:
    hits = ensemble(
        P, {"v2": V2}, periods=60, record="impacts", scatter=Scatter(sigma_r=0.03, r_speed=0.04, seed=9)
    ).impacts
    assert hits is not None
    fast = hits[np.abs(hits["w_dot"]) > 0.05]
    r = -(fast["v1_after"] - fast["v2_after"]) / fast["w_dot"]
    left_over = r - (P.r - 0.04 * np.abs(fast["w_dot"]))
    n = len(fast)
    assert n > 5000
    assert abs(left_over.mean()) < 5 * 0.03 / n**0.5
    assert left_over.std() == pytest.approx(0.03, rel=0.05)


def test_standard_errors_with_scatter_are_those_between_runs() -> None:
    chaos = Params(mu=0.01, A=0.03)
    scatter = Scatter(sigma_r=0.05, noise=0.05, seed=3)
    m = ensemble(chaos, {"v2": np.linspace(0.05, 0.2, 64)}, settle=150, periods=480, record="measures", scatter=scatter)
    assert m.measures is not None
    for name in ("kinetic_ratio", "rms_x1"):
        z = (m.measures[name] - np.mean(m.measures[name])) / m.measures[f"{name}_error"]
        told = np.isfinite(z)
        assert np.mean(told) > 0.4
        assert 0.6 < np.mean(z[told] ** 2) < 1.6
    cut = ensemble(chaos, periods=20, record="measures", scatter=scatter, max_impacts_per_period=1)
    assert cut.measures is not None
    assert cut.status[0] == "impact_cap"
    assert np.isnan(cut.measures["kinetic_ratio_error"][0])


def test_impacts_alone_are_those_of_a_run_with_measures_which_can_be_had_later() -> None:
    for scatter in (None, Scatter(sigma_r=0.02, seed=2)):
        asked: dict[str, Any] = {"settle": 2.3, "periods": 9, "scatter": scatter}
        many = ensemble(P, {"v2": V2[:4]}, record="impacts", **asked)
        alone = ensemble(P, {"v2": V2[:4]}, record="measures", **asked)
        assert many.impacts is not None
        assert alone.impacts is None
        assert isinstance(many._measured, _Runs)  # nothing was measured yet
        both = many._measured.done(WITH_IMPACTS + WITH_MEASURES)
        assert np.array_equal(many.impacts, both.impacts)
        assert np.array_equal(many.final, both.final)
        assert many.measures is not None
        assert many.measures is many.measures
        assert many.measures.tobytes() == alone.measures.tobytes() == both.measures.tobytes()
        assert ensemble(P, {"v2": V2[:4]}, **asked).measures is None
        hits = many.measures["impacts_left"] + many.measures["impacts_right"]
        assert np.array_equal(np.bincount(many.impacts["run"], minlength=4), hits)


def test_bad_scatter_is_refused() -> None:
    for options, message in (
        ({"sigma_r": -1.0}, "sigma_r is -1"),
        ({"hold": 0}, "hold is 0"),
        ({"seed": -1}, "seed is"),
    ):
        with pytest.raises(ParameterError, match=message):
            Scatter(**options)
    with pytest.raises(StateError, match="lyapunov is not defined"):
        ensemble(P, lyapunov=True, scatter=Scatter())
