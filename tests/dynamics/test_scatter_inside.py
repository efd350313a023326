"""How far the path of two held forces is from that of the coloured force where it is not exact (docs/noise.md)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm, solve_continuous_lyapunov, solve_discrete_lyapunov

from vines.dynamics._coloured import held_halves, transition

LAM = 0.012
COARSEST = 26
"""Least `hold` that is allowed at Omega = 1."""


def _process(mass: float, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Return drift and stationary covariance of (x, v, force)."""
    drift = np.array([[0.0, 1.0, 0.0], [-1.0 / mass, -LAM / mass, 1.0 / mass], [0.0, 0.0, -1.0 / time]])
    return drift, solve_continuous_lyapunov(drift, -np.diag([0.0, 0.0, 2.0 / time]))


def _held(mass: float, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Return how (x, v) goes on under a held force, and what a force of size 1 adds."""
    flow = expm(length * np.array([[0.0, 1.0, 0.0], [-1.0 / mass, -LAM / mass, 1.0 / mass], [0.0, 0.0, 0.0]]))
    return flow[:2, :2], flow[:2, 2]


def _inside(hold: int, time: float, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Return, of x and v inside a step: rms error of the path that shares its ends, and error of the variance.

    Both in units of the stationary law.
    """
    h = 4 * math.pi / hold

    def step(length: float) -> tuple[np.ndarray, np.ndarray]:
        mean, added = transition(LAM, length, time)
        units = np.diag([length**2, length, 1.0])
        return units @ mean @ np.linalg.inv(units), units @ added @ units

    law = _process(1.0, time)[1]
    (first, own), (second, other) = step(share * h), step((1 - share) * h)
    # Of the numbers (state at the begin, what is added until the time inside, what is added from there on).
    cov = np.zeros((9, 9))
    cov[:3, :3], cov[3:6, 3:6], cov[6:, 6:] = law, own, other
    begin = np.eye(3, 9)
    now = np.hstack([first, np.eye(3), np.zeros((3, 3))])
    end = second @ now + np.hstack([np.zeros((3, 6)), np.eye(3)])
    over, unit = _held(1.0, 0.5 * h)
    forces = np.linalg.solve(np.stack([over @ unit, unit], axis=1), end[:2] - over @ over @ begin[:2])
    if share <= 0.5:
        flow, gain = _held(1.0, share * h)
        path = flow @ begin[:2] + np.outer(gain, forces[0])
    else:
        flow, gain = _held(1.0, (share - 0.5) * h)
        path = flow @ (over @ begin[:2] + np.outer(unit, forces[0])) + np.outer(gain, forces[1])
    exact, away = now[:2] @ cov @ now[:2].T, (path - now[:2]) @ cov @ (path - now[:2]).T
    drawn = path @ cov @ path.T
    return np.sqrt(np.diag(away) / np.diag(exact)), np.abs(np.diag(drawn) / np.diag(exact) - 1.0)


def _worst(hold: int, time: float) -> np.ndarray:
    """Return the largest of these errors over a step: rms of x and v, variance of x and v."""
    found = [np.concatenate(_inside(hold, time, share)) for share in np.linspace(0.1, 0.9, 9)]
    return np.max(found, axis=0)


@pytest.mark.parametrize(("memory", "limits"), [(0.05, (1e-3, 7e-3, 2e-5, 6e-4)), (1.0, (3e-4, 3e-3, 1e-5, 4e-5))])
def test_inside_a_step_the_path_is_that_of_the_process_but_for_little(memory: float, limits: tuple[float, ...]) -> None:
    time = 2 * math.pi * memory
    coarse, finer, finest = (_worst(hold, time) for hold in (COARSEST, 4 * COARSEST, 16 * COARSEST))
    assert np.all(coarse < limits)
    # Strong orders 5/2 and 3/2, a white jerk's; the variances are closer still.
    assert np.log(finer[:2] / finest[:2]) / math.log(4) == pytest.approx([2.5, 1.5], abs=0.1)
    assert np.all(np.log(finer[2:] / finest[2:]) / math.log(4) > [2.9, 1.9])


def test_the_ends_of_a_step_are_exact() -> None:
    for share in (1e-3, 1 - 1e-3):
        away, off = _inside(COARSEST, 3.0, share)
        assert np.all(away < [1e-5, 2e-3])
        assert np.all(off < 1e-5)


@pytest.mark.parametrize("mu", [0.01, 1.0])
def test_while_the_ball_rides_the_law_is_that_of_the_heavier_oscillator_but_for_the_fourth_order(mu: float) -> None:
    def off(hold: int) -> np.ndarray:
        h, time, mass = 4 * math.pi / hold, 0.3 * 2 * math.pi, 1.0 + mu
        p11, p12, p21, p22, l11, l21, l22 = held_halves(LAM, h, time)
        over, unit = _held(mass, 0.5 * h)
        adds = np.stack([over @ unit, unit], axis=1)
        keeps = math.exp(-h / time)
        new = math.sqrt(1 - keeps**2)
        mean, drawn = np.zeros((3, 3)), np.zeros((3, 3))
        mean[:2, :2], mean[:2, 2], mean[2, 2] = over @ over, adds @ [p11 + p12 * keeps, p21 + p22 * keeps], keeps
        drawn[:2, 0], drawn[2, 0] = adds @ [p12 * new, p22 * new], new
        drawn[:2, 1], drawn[:2, 2] = adds @ [l11, l21], adds @ [0.0, l22]
        law = np.diag(solve_discrete_lyapunov(mean, drawn @ drawn.T))
        return np.abs(law / np.diag(_process(mass, time)[1]) - 1.0)[:2]

    coarse, fine = off(COARSEST), off(2 * COARSEST)
    assert np.all(coarse < 2e-4 * mu / (1 + mu) ** 2)
    assert np.log2(coarse / fine) == pytest.approx([4.0, 4.0], abs=0.1)
