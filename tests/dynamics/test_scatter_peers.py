"""Scatter against a simulation by small steps of DOP853, which draws the same numbers, also at resonance."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from vines.dynamics import Scatter, ensemble
from vines.dynamics._random import normal
from vines.model import Params

P = Params(mu=0.02, A=0.1, Omega=1.1)
RESONANT = Params(mu=0.02, A=0.02, Omega=0.5, lam=0.0)


def _base(p: Params, scatter: Scatter, t: float) -> tuple[float, float]:
    """Return displacement and velocity of the base."""
    angle = p.Omega * t
    other = 2 * angle + scatter.second_phase
    return (
        p.A * (math.sin(angle) + scatter.second * math.sin(other)),
        p.A * p.Omega * (math.cos(angle) + 2 * scatter.second * math.cos(other)),
    )


def _peer(p: Params, scatter: Scatter, v2: float, periods: float) -> tuple[np.ndarray, dict[str, float]]:
    """Return time, side, v1, v2 just before and v1, v2 just after each impact, and energies, by DOP853."""
    y = np.array([0.0, 0.0, 0.0, v2, 0.0, 0.0, 0.0, 0.0])
    hits, draws, stop, t = [], 0, periods * p.period, 0.0
    grid = p.period / scatter.hold if scatter.noise > 0 else stop
    held, largest = 0.0, 0.0

    def motion(t: float, y: np.ndarray) -> list[float]:
        base, rate = _base(p, scatter, t)
        push = base - y[0] + p.lam * (rate - y[1])
        work = rate * push + held * y[1]
        return [y[1], push + held, y[3], 0.0, y[0] ** 2, y[1] ** 2, work, p.lam * (y[1] - rate) ** 2]

    def left(t: float, y: np.ndarray) -> float:
        return y[0] - y[2] - 1.0

    def right(t: float, y: np.ndarray) -> float:
        return y[0] - y[2] + 1.0

    left.terminal, left.direction = True, 1  # type: ignore[attr-defined]
    right.terminal, right.direction = True, -1  # type: ignore[attr-defined]
    piece = 0
    while t < stop - 1e-9:
        until = min((piece + 1) * grid, stop)
        if scatter.noise > 0:
            held = scatter.noise * p.A * normal(scatter.seed, 0, 2 * piece + 1)
        leg = solve_ivp(
            motion, (t, until), y, "DOP853", rtol=1e-13, atol=1e-14, max_step=0.05, events=(left, right),
            dense_output=True,
        )  # fmt: skip
        t, y = float(leg.t[-1]), leg.y[:, -1]
        largest = max(largest, float(np.abs(leg.sol(np.linspace(leg.t[0], leg.t[-1], 200))[0]).max()))
        if leg.status != 1:
            piece += 1
            continue
        closing, before = y[1] - y[3], (y[1], y[3])
        r = p.r - scatter.r_speed * abs(closing)
        r += scatter.sigma_r * normal(scatter.seed, 0, 2 * draws) if scatter.sigma_r > 0 else 0.0
        r = min(max(r, 0.0), 1.0)
        draws += 1
        y[1] -= p.mu * (1 + r) / (1 + p.mu) * closing
        y[3] += (1 + r) / (1 + p.mu) * closing
        side = math.copysign(1.0, y[0] - y[2])
        y[2] = y[0] - side * (1.0 - 1e-14)
        hits.append((t, side, *before, y[1], y[3]))
    energies = dict(zip(("rms_x1", "base_work", "damper_loss"), (math.sqrt(y[4] / stop), y[6], y[7]), strict=True))
    return np.array(hits), {**energies, "kinetic_1": 0.5 * y[5] / stop, "max_abs_x1": largest}


@pytest.mark.parametrize(
    ("p", "scatter"),
    [
        (P, Scatter(sigma_r=0.05, r_speed=0.04, seed=4)),
        (P, Scatter(second=0.3, second_phase=0.7)),
        (P, Scatter(noise=0.4, hold=5, seed=4)),
        (P, Scatter(sigma_r=0.05, noise=0.3, hold=32, second=0.3, second_phase=0.7, seed=8)),
        # The second harmonic, or the first, meets the oscillator without damping.
        (RESONANT, Scatter(sigma_r=0.05, second=0.2, second_phase=0.3, noise=0.3, hold=7, seed=2)),
        (RESONANT.replace(Omega=1.0, A=0.03), Scatter(second=0.2, noise=0.3, hold=7, seed=2)),
    ],
)
def test_impacts_and_energies_are_those_of_small_steps(p: Params, scatter: Scatter) -> None:
    v2, periods = 0.9, 4.0
    peer, energies = _peer(p, scatter, v2, periods)
    many = ensemble(p, {"v2": v2}, periods=periods, record="impacts", scatter=scatter)
    hits = many.impacts
    assert hits is not None
    assert len(hits) == len(peer) >= 5
    for k, name in enumerate(("t", "side", "v1", "v2", "v1_after", "v2_after")):
        assert hits[name] == pytest.approx(peer[:, k], abs=1e-8)
    m = many.measures
    assert m is not None
    for name, value in energies.items():
        assert m[name][0] == pytest.approx(value, abs=2e-6 if name == "max_abs_x1" else 1e-9)


@pytest.mark.parametrize("p", [P, RESONANT, Params(mu=0.3, A=0.3, Omega=0.7, r=0.2)])
def test_energy_balances_with_all_forces_on_where_the_ball_sticks_too(p: Params) -> None:
    scatter = Scatter(sigma_r=0.05, r_speed=0.02, noise=0.5, hold=9, second=0.3, second_phase=0.4, seed=6)
    m = ensemble(p, {"v2": np.linspace(0.05, 0.3, 40)}, periods=20, record="measures", scatter=scatter).measures
    assert m is not None
    balance = m["base_work"] - m["damper_loss"] - m["impact_loss_left"] - m["impact_loss_right"] - m["energy_change"]
    assert np.max(np.abs(balance)) < 1e-12 * (1.0 + np.max(np.abs(m["base_work"])))
    assert p.mu < 0.3 or m["sticks_left"].sum() > 40


def test_sticking_is_decided_as_without_scatter() -> None:
    p = Params(mu=0.05, A=0.1, r=0.1)
    starts = {"v2": np.linspace(0.05, 0.3, 5)}
    still = ensemble(p, starts, periods=20, record="measures", scatter=Scatter()).measures
    model = ensemble(p, starts, periods=20, record="measures").measures
    assert still is not None
    assert model is not None
    assert model["sticks_left"].sum() > 5
    for name in still.dtype.names or ():
        assert still[name] == pytest.approx(model[name], abs=1e-9, nan_ok=True)


def test_a_run_draws_the_same_whatever_runs_beside_it_and_however_it_is_cut() -> None:
    scatter = Scatter(sigma_r=0.05, noise=0.2, hold=6, seed=3)
    asked = {"periods": 5.0, "settle": 2.5, "record": "measures", "scatter": scatter, "threads": 1}
    many = ensemble(P, {"v2": [0.1, 0.2, 0.3]}, **asked)
    pair = ensemble(P, {"v2": [0.1, 0.2]}, **asked)
    assert np.array_equal(many.final[:2], pair.final)
    assert many.measures is not None
    assert pair.measures is not None
    assert many.measures[:2].tobytes() == pair.measures.tobytes()
    # The same time in one piece, none of it recorded.
    whole = ensemble(P, {"v2": [0.1, 0.2]}, periods=7.5, scatter=scatter)
    for name in ("x1", "v1", "x2", "v2"):
        assert whole.final[name] == pytest.approx(pair.final[name], abs=1e-9)
