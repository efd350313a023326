"""Every flight against an ODE solver with small steps, restarted at each impact, and free runs on settled orbits."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from vines.attractors import settle
from vines.dynamics import simulate
from vines.model import Params

FLIGHTS = 1000
HORIZON = 8.0


def _random_flights(rng: np.random.Generator) -> list[tuple[Params, dict[str, float]]]:
    flights = []
    for _ in range(FLIGHTS):
        p = Params(
            mu=10 ** rng.uniform(-3, 0),
            A=10 ** rng.uniform(-2, 0),
            Omega=rng.uniform(0.3, 2.5),
            r=rng.uniform(0.2, 1.0),
            lam=rng.uniform(0.0, 0.3) + 1e-3,
        )
        side = rng.choice((-1.0, 1.0))
        x1 = rng.normal(0.0, 0.7)
        v1 = rng.normal(0.0, 0.7)
        v2 = v1 + side * 10 ** rng.uniform(-2, 0.7)
        start = {"x1": x1, "v1": v1, "x2": x1 - side, "v2": v2, "phi": rng.uniform(0.0, 2 * math.pi)}
        flights.append((p, start))
    return flights


def test_a_thousand_random_flights_agree_with_small_ode_steps() -> None:
    flights = _random_flights(np.random.default_rng(20240501))
    A, Omega, lam = (np.array([getattr(p, name) for p, _ in flights]) for name in ("A", "Omega", "lam"))
    x1, v1, x2, v2, phi = (np.array([s[name] for _, s in flights]) for name in ("x1", "v1", "x2", "v2", "phi"))

    def motion(t: float, y: np.ndarray) -> np.ndarray:
        x, v = y[:FLIGHTS], y[FLIGHTS:]
        angle = Omega * t + phi
        return np.concatenate([v, A * np.sin(angle) + lam * Omega * A * np.cos(angle) - lam * v - x])

    solved = solve_ivp(
        motion,
        (0.0, HORIZON),
        np.concatenate([x1, v1]),
        method="DOP853",
        rtol=1e-13,
        atol=1e-14,
        max_step=0.05,
        dense_output=True,
    )
    grid = np.linspace(0.0, HORIZON, 8001)
    gaps = np.array([np.abs(solved.sol(t)[:FLIGHTS] - x2 - v2 * t) for t in grid])
    assert solved.sol is not None
    hits = 0
    for k, (p, start) in enumerate(flights):
        run = simulate(p, **start, periods=HORIZON / p.period)
        struck = run.impacts[:1]
        until = float(struck["t"][0]) if len(struck) else HORIZON
        # Nothing was missed: before our contact the solver stays inside.
        assert np.max(gaps[grid < until - 1e-9, k][1:], initial=0.0) < 1.0 + 1e-10
        if len(struck):
            # Nothing was invented: there the solver is on the wall, with the same state.
            hits += 1
            there = solved.sol(until)
            assert abs(there[k] - struck["x1"][0]) < 1e-9
            assert abs(there[FLIGHTS + k] - struck["v1"][0]) < 1e-9
            assert abs(abs(there[k] - x2[k] - v2[k] * until) - 1.0) < 1e-9
    assert hits > 900


def _free_run(p: Params, start: dict[str, float], periods: int) -> np.ndarray:
    """Impacts (t, v1, v2) of a run by DOP853 with small steps and terminal events."""
    x1, v1, x2, v2 = (start[name] for name in ("x1", "v1", "x2", "v2"))
    phi, t, stop = start["phase"], 0.0, periods * p.period
    found = []

    def motion(t: float, y: np.ndarray) -> list[float]:
        angle = p.Omega * t + phi
        force = p.A * math.sin(angle) + p.lam * p.Omega * p.A * math.cos(angle)
        return [y[1], force - p.lam * y[1] - y[0]]

    while True:

        def gap(t: float, y: np.ndarray, x2: float = x2, v2: float = v2, since: float = t) -> float:
            return 1.0 - abs(y[0] - x2 - v2 * (t - since)) + (1e-9 if t == since else 0.0)

        gap.terminal, gap.direction = True, -1  # type: ignore[attr-defined]
        leg = solve_ivp(motion, (t, stop), [x1, v1], method="DOP853", rtol=1e-13, atol=1e-14, max_step=0.1, events=gap)
        if not len(leg.t_events[0]):
            return np.array(found)
        hit = leg.t_events[0][0]
        x2 += v2 * (hit - t)
        t, (x1, v1) = hit, leg.y_events[0][0]
        found.append((t, v1, v2))
        v1, v2 = (
            ((1 - p.r * p.mu) * v1 + p.mu * (1 + p.r) * v2) / (1 + p.mu),
            ((1 + p.r) * v1 + (p.mu - p.r) * v2) / (1 + p.mu),
        )


def test_fifty_periods_on_settled_orbits_agree_with_small_ode_steps() -> None:
    for A in (0.015, 0.023):
        p = Params(mu=0.01, A=A)
        at = settle(p).final
        ours = simulate(p, **{name: at[name] for name in ("x1", "v1", "x2", "v2")}, phi=at["phase"], periods=50).impacts
        theirs = _free_run(p, at, 50)
        assert len(theirs) == len(ours)
        for column, name in enumerate(("t", "v1", "v2")):
            assert np.max(np.abs(theirs[:, column] - ours[name])) < 1e-9
