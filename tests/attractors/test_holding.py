"""Means with censored runs, their intervals, and the stationary law of regimes."""

import math

import numpy as np
import pytest

from vines.attractors import Holding, mean_interval, stationary_law


@pytest.mark.parametrize(("mean", "watch", "runs"), [(100.0, 50.0, 20), (100.0, 400.0, 8), (100.0, 5.0, 30)])
def test_intervals_hold_the_mean_as_often_as_they_say(mean, watch, runs):
    # Exponential times, cut where the watch ends: from nearly all of them cut to nearly none.
    rng = np.random.default_rng(3)
    n, held = 1500, 0
    for times in rng.exponential(mean, (n, runs)):
        exits = int(np.sum(times < watch))
        _, low, high = mean_interval(exits, float(np.minimum(times, watch).sum()))
        held += low <= mean <= high
    assert held / n > 0.95 - 3 * math.sqrt(0.05 * 0.95 / n)


def test_without_an_exit_the_mean_is_known_from_below_alone():
    mean, low, high = mean_interval(0, 1000.0)
    assert (mean, high) == (math.inf, math.inf)
    # e^(-T/mean) = 2.5 %, the lower end of an interval of 95 %
    assert low == pytest.approx(1000.0 / -math.log(0.025), rel=1e-12)


def _holding(k, time, to):
    exits = sum(to.values())
    return Holding(k, "runs", 10, exits, time, time / exits if exits else math.inf, 0.0, 0.0, to)


def test_the_stationary_law_is_that_of_the_chain():
    many = [_holding(0, 1e6, {1: 2000, 2: 1000}), _holding(1, 1e5, {0: 3000}), _holding(2, 4e5, {0: 500, 1: 1500})]
    share, low, high = stationary_law(many)
    rates = np.array([[0, 2e-3, 1e-3], [3e-2, 0, 0], [1.25e-3, 3.75e-3, 0]])
    flow = rates - np.diag(rates.sum(axis=1))
    values, vectors = np.linalg.eig(flow.T)
    exact = np.real(vectors[:, np.argmin(abs(values))])
    assert share == pytest.approx(exact / exact.sum(), rel=2e-3)
    assert share.sum() == pytest.approx(1.0, abs=1e-12)
    assert np.all((low < share) & (share < high))
    assert high[1] - low[1] < 0.02


def test_a_regime_without_an_exit_has_a_share_and_a_wide_interval():
    share, low, high = stationary_law([_holding(0, 1e4, {}), _holding(1, 1e3, {0: 10})])
    assert share[0] == pytest.approx(10.5 / 1e3 / (10.5 / 1e3 + 0.5 / 1e4), rel=1e-9)
    assert low[0] < 0.99
    assert high[0] > 0.9999
    nothing = stationary_law([_holding(0, 1e4, {}), _holding(1, 1e4, {})])
    assert nothing[0] == pytest.approx([0.5, 0.5])
    assert nothing[1][0] < 0.05
    assert nothing[2][0] > 0.95
