"""The impact pair with a restitution that is drawn: the variance of its impacts against a Lyapunov equation."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov
from scipy.optimize import brentq

from vines.dynamics import Scatter, simulate
from vines.dynamics._simulate import record
from vines.dynamics.kernels import constants_at, room_of
from vines.dynamics.kernels import rows as col
from vines.orbits import find_orbit
from vines.systems import ImpactPair

P = ImpactPair(B=0.5, G=0.0, r=0.65)


def _map(theta: float, speed: float, r: float) -> tuple[float, float]:
    """Return phase modulo pi and speed of the next impact on the other side, from w'' = -B sin theta alone."""

    def gap(h: float) -> float:
        return 1.0 - r * speed * h + P.B * (math.sin(theta + h) - math.sin(theta) - h * math.cos(theta))

    h: Any = brentq(lambda h: gap(h) + 1.0, 0.5, 5.0, xtol=1e-15)
    there = -r * speed + P.B * (math.cos(theta + h) - math.cos(theta))
    return theta + h - math.pi, -there


def _variance() -> tuple[np.ndarray, float, float]:
    """Return the covariance of phase and speed for a standard deviation 1 of r, and the orbit's impact."""
    orbit = find_orbit("LR", P)
    k = int(np.flatnonzero(orbit.side > 0)[0])
    theta, speed = float(orbit.phase[k]), float(orbit.w_dot[k])
    assert _map(theta, speed, P.r) == pytest.approx((theta, speed), abs=1e-11)
    d = 1e-6
    columns = [
        (np.array(_map(*(at + d * step))) - np.array(_map(*(at - d * step)))) / (2 * d)
        for at in [np.array([theta, speed, P.r])]
        for step in np.eye(3)
    ]
    J, b = np.stack(columns[:2], axis=1), columns[2]
    return solve_discrete_lyapunov(J, np.outer(b, b)), theta, speed


def _impacts(sigma: float, periods: int, stream: int = 0) -> np.ndarray:
    """Return the rows of the impacts of a run from the orbit."""
    room = room_of(P)
    orbit = find_orbit("LR", P)
    scatter = Scatter(sigma_r=sigma, seed=8)
    table, _room = room.scattered(P.as_array()[None], scatter, np.array([stream]))
    state = np.zeros(room.layout(P).state)
    c = constants_at(table, 0)
    x1, v1, x2, v2 = orbit.states[0].tolist()
    room.begin(c, state, x1, v1, x2, v2, float(orbit.phase[0]), 0.0)
    rows, status = record(c, state, [periods * P.period], 1000, 3 * periods)
    assert status == "complete"
    return rows[rows[:, col.KIND] == col.IMPACT]


def test_the_variance_of_impacts_is_that_of_the_lyapunov_equation() -> None:
    exact, theta, speed = _variance()
    n, ratios = 24_000, []
    for sigma in (0.002, 0.03):
        hits = _impacts(sigma, n // 2)[200:]
        closing = np.abs(hits[:, col.V1] - hits[:, col.V2])
        phase = np.where(hits[:, col.SIDE] > 0, hits[:, col.PHASE], hits[:, col.PHASE] - math.pi)
        phase = (phase - theta + math.pi) % (2 * math.pi) - math.pi
        seen = np.array([np.mean((closing - closing.mean()) ** 2), np.mean((phase - phase.mean()) ** 2)])
        ratios.append(seen / sigma**2 / exact[[1, 0], [1, 0]])
        assert closing.mean() == pytest.approx(speed, abs=20 * sigma**2 + 4 * sigma * math.sqrt(exact[1, 1] * 20 / n))
    # Some twenty impacts are one independent one; the rest is of the order of sigma squared.
    error = 4 * math.sqrt(2 * 20 / n)
    assert ratios[0] == pytest.approx([1.0, 1.0], abs=error)
    assert ratios[1] == pytest.approx([1.0, 1.0], abs=error + 100 * 0.03**2)


def test_without_scatter_it_is_the_pair() -> None:
    orbit = find_orbit("LR", P)
    start: dict[str, Any] = room_of(P).leave(P, orbit.states[0].tolist(), float(orbit.phase[0]))
    plain = simulate(P, phi=float(orbit.phase[0]), periods=40, **start).impacts
    ours = _impacts(0.0, 40)
    assert np.array_equal(ours[:, col.TIME], plain["t"])
    assert np.array_equal(ours[:, col.V2], plain["v2"])
    assert not np.array_equal(_impacts(0.01, 40)[:, col.TIME], _impacts(0.01, 40, stream=1)[:, col.TIME])
