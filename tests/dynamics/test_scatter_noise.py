"""Noise of the base with a memory and a phase that wanders: their laws, and what an oscillator makes of them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

from vines.dynamics import OrnsteinUhlenbeck, Scatter, ensemble
from vines.dynamics._coloured import transition
from vines.errors import ParameterError
from vines.model import VI_NES, Params

# The ball rests far from the walls: what is seen is the oscillator alone.
ALONE = {"x1": 0.0, "v1": 0.0, "v2": 0.0}


def _alone(p: Params, scatter: Scatter, runs: int, periods: float) -> np.ndarray:
    """Return x1, v1, phase at the end of many runs without impacts, shape (runs, 3)."""
    many = ensemble(p, {name: np.full(runs, value) for name, value in ALONE.items()}, periods=periods, scatter=scatter)
    assert not many.counts.any()
    return np.stack([many.final[name] for name in ("x1", "v1", "phase")], axis=1)


@pytest.mark.parametrize(("hold", "time"), [(32, 2.0), (26, 0.05), (64, 30.0)])
def test_an_oscillator_under_a_coloured_force_has_the_covariance_of_its_lyapunov_equation(
    hold: int, time: float
) -> None:
    # Exact at every second draw, so also where a step is half of the oscillator's time.
    p = Params(mu=0.01, A=1e-3, lam=0.5)
    n = 2500
    seen = _alone(p, Scatter(ou=OrnsteinUhlenbeck(2.0, time), hold=hold, seed=11), n, 8)
    steady = _alone(p, Scatter(), 1, 8)
    rate = 1.0 / (time * p.period)
    drift = np.array([[0.0, 1.0, 0.0], [-1.0, -p.lam, 1.0], [0.0, 0.0, -rate]])
    force = 2.0 * p.A
    push = np.diag([0.0, 0.0, 2.0 * rate * force**2])
    exact = solve_continuous_lyapunov(drift, -push)
    assert exact[2, 2] == pytest.approx(force**2)
    # The force begins stationary, the oscillator at rest: what is left of that is e^(-lam t) of it.
    away = seen[:, :2] - steady[:, :2]
    assert np.abs(away.mean(axis=0)) == pytest.approx([0.0, 0.0], abs=4 * np.sqrt(exact[0, 0] / n))
    for i, j in ((0, 0), (1, 1), (0, 1)):
        error = np.sqrt((exact[i, i] * exact[j, j] + exact[i, j] ** 2) / n)
        assert np.mean(away[:, i] * away[:, j]) == pytest.approx(exact[i, j], abs=4.0 * error)


@pytest.mark.parametrize(("step", "time"), [(0.01, 3.0), (0.5, 0.2), (0.3, 1e-3)])
def test_the_transition_is_that_of_many_small_steps(step: float, time: float) -> None:
    # Heun's rule for the mean and for the covariance, in steps so small that it is exact to ten digits.
    lam, parts = 0.3, 1000 if time > 1e-2 else 20_000
    drift = np.array([[0.0, 1.0, 0.0], [-1.0, -lam, 1.0], [0.0, 0.0, -1.0 / time]])
    push = np.diag([0.0, 0.0, 2.0 / time])
    h = step / parts
    flow = np.eye(3) + h * drift + 0.5 * h * h * drift @ drift
    flow += h**3 / 6 * drift @ drift @ drift + h**4 / 24 * np.linalg.matrix_power(drift, 4)
    small = np.zeros((3, 3))
    for share, weight in ((0.5 - 0.5 / 3**0.5, 0.5), (0.5 + 0.5 / 3**0.5, 0.5)):
        part = np.eye(3) + share * h * drift + 0.5 * (share * h) ** 2 * drift @ drift
        part += (share * h) ** 3 / 6 * drift @ drift @ drift
        small += weight * h * part @ push @ part.T
    mean, added = np.eye(3), np.zeros((3, 3))
    for _ in range(parts):
        mean, added = flow @ mean, flow @ added @ flow.T + small
    units = np.diag([step**2, step, 1.0])
    ours, more = transition(lam, step, time)
    assert units @ ours @ np.linalg.inv(units) == pytest.approx(mean, rel=1e-6, abs=1e-10)
    assert units @ more @ units == pytest.approx(added, rel=1e-6, abs=1e-11)


def test_the_phase_diffuses_as_a_brownian_motion_does() -> None:
    p, n, per = Params(mu=0.01, A=1e-3, lam=0.5), 4000, 0.05
    for periods in (4.0, 9.5):
        phase = _alone(p, Scatter(phase_diffusion=per, seed=5), n, periods)[:, 2]
        turned = (phase - 2 * np.pi * periods + np.pi) % (2 * np.pi) - np.pi
        expected = per**2 * periods
        assert turned.mean() == pytest.approx(0.0, abs=4 * (expected / n) ** 0.5)
        assert turned.var() == pytest.approx(expected, rel=4 * (2 / n) ** 0.5)
    # To first order the oscillator follows what F = A sin(theta) + lam Omega A cos(theta) turns by.
    small = 1e-4
    seen = _alone(p, Scatter(phase_diffusion=small, hold=128, seed=6), n, 12)
    s, q = complex(-0.25, (1 - 0.0625) ** 0.5), p.A * complex(p.lam, -1.0)
    t = np.linspace(0.0, 12 * p.period, 40_001)
    # x(T) = Re of the convolution of the force; a turn at t changes what comes after it.
    response = np.imag(np.exp(s * (t[-1] - t))) / s.imag
    force = np.real(1j * q * np.exp(1j * t))
    after = np.cumsum((response * force)[::-1])[::-1] * (t[1] - t[0])
    expected = small**2 / p.period * np.sum(after**2) * (t[1] - t[0])
    steady = _alone(p, Scatter(), 1, 12)
    assert np.var(seen[:, 0] - steady[0, 0]) == pytest.approx(expected, rel=4 * (2 / n) ** 0.5 + 0.02)


@pytest.mark.parametrize(
    "scatter",
    [
        Scatter(phase_diffusion=0.3, second=0.2, noise=0.1, seed=1),
        Scatter(phase_diffusion=0.1, sigma_r=0.02, ou={"sigma": 0.3, "correlation_time": 4.0}, seed=2),
    ],
)
def test_energy_balances_and_draws_do_not_depend_on_cores(scatter: Scatter) -> None:
    for p in (Params(mu=0.1, A=0.3, Omega=1.17), Params(mu=0.2, A=0.02)):
        starts = {"v2": np.linspace(0.05, 0.2, 66)}
        one, two = (
            ensemble(p, starts, periods=24, record="measures", scatter=scatter, threads=threads) for threads in (1, 2)
        )
        assert one.final.tobytes() == two.final.tobytes()
        hits = ensemble(p, starts, periods=24, record="impacts", scatter=scatter)
        assert np.array_equal(hits.final, one.final)
        m = one.measures
        assert m is not None
        spent = m["damper_loss"] + m["impact_loss_left"] + m["impact_loss_right"] + m["energy_change"]
        assert np.abs(m["base_work"] - spent).max() < 1e-11


def test_impacts_have_the_phase_of_the_forcing_that_was_there() -> None:
    p = Params(mu=0.01, A=0.02)
    hits = ensemble(p, periods=40, record="impacts", scatter=Scatter(phase_diffusion=0.02, seed=3)).impacts
    assert hits is not None
    turned = (hits["phase"] - p.Omega * hits["t"] + np.pi) % (2 * np.pi) - np.pi
    steps = np.diff(turned)
    assert np.all(steps[:40] != 0.0)
    assert steps.std() == pytest.approx(0.02 * np.sqrt(np.mean(np.diff(hits["t"])) / p.period), rel=0.4)


def test_without_noise_it_is_the_run_without() -> None:
    p, starts = Params(mu=0.01, A=0.015), {"v2": [0.08, 0.1]}
    plain = ensemble(p, starts, periods=300)
    for scatter in (
        Scatter(phase_diffusion=1e-300),
        Scatter(ou={"sigma": 1e-300, "correlation_time": 1.0}),
        Scatter(sigma_r=1e-300, spread={"mu": 1e-300}),
        Scatter(),
    ):
        noisy = ensemble(p, starts, periods=300, scatter=scatter)
        for name in ("x1", "v1", "x2", "v2"):
            assert noisy.final[name] == pytest.approx(plain.final[name], abs=1e-11)


def test_units_have_the_spread_asked_for_and_are_those_of_their_number() -> None:
    p, n = Params(mu=0.01, A=0.02, r=0.99), 2000
    scatter = Scatter(spread={"mu": 0.02, "r": 0.01}, seed=4)
    drawn = ensemble(p, {"v2": np.full(n, 0.1)}, periods=1, scatter=scatter).parameters
    assert drawn[:, 0].std() == pytest.approx(2e-4, rel=4 * (0.5 / n) ** 0.5)
    assert drawn[:, 0].mean() == pytest.approx(0.01, abs=4 * 2e-4 / n**0.5)
    # Cut at 1, where a restitution ends: drawn again, not set to it.
    assert drawn[:, 3].max() < 1.0
    assert len(np.unique(drawn[:, 3])) == n
    assert np.all(drawn[:, [1, 2, 4]] == [p.A, p.Omega, p.lam])
    table = np.tile([0.01, 0.02, 1.0, 0.99, p.lam], (5, 1))
    assert np.array_equal(scatter.units(VI_NES, table, first=7), drawn[7:12])


def test_bad_noise_is_refused() -> None:
    p = Params(mu=0.01, A=0.02)
    for options, message in (
        ({"phase_diffusion": -1.0}, "phase_diffusion is -1"),
        ({"ou": {"sigma": 1.0}}, "give {'sigma': 0.01, 'correlation_time': 2.0}"),
        ({"ou": {"sigma": 1.0, "correlation_time": 0.0}}, "ou.correlation_time is 0"),
        ({"spread": [1]}, "give shares by parameter"),
        ({"spread": {"mu": -0.1}}, "spread.mu is -0.1"),
    ):
        with pytest.raises(ParameterError, match=message):
            Scatter(**options)  # pyright: ignore[reportArgumentType]
    with pytest.raises(ParameterError, match="spread: unknown parameter 'Mu': did you mean 'mu'"):
        ensemble(p, scatter=Scatter(spread={"Mu": 0.1}))
    with pytest.raises(ParameterError, match="hold is 8; with ou at Omega = 1 allowed is hold >= 26"):
        ensemble(p, scatter=Scatter(hold=8, ou={"sigma": 0.1, "correlation_time": 1.0}))
