"""Block lengths and standard errors of correlated series against the closed forms of an autoregression."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from vines.rig.uncertainty import block_length, mean_over_periods, standard_error


def autoregression(rng, n, rho):
    """Return x_k = rho x_(k-1) + normal noise; its mean has the standard error 1/((1 - rho) sqrt n)."""
    return np.asarray(lfilter([1.0], [1.0, -rho], rng.normal(size=n + 400)))[400:]


@pytest.mark.parametrize("rho", [0.5, 0.8, -0.5])
def test_blocks_are_twice_as_long_as_those_of_the_closed_form(rho):
    # Patton, Politis and White: (3/2 (2 rho/(1 - rho^2))^2 n)^(1/3) for the circular bootstrap of an autoregression.
    n = 40_000
    best = (1.5 * (2 * rho / (1 - rho**2)) ** 2 * n) ** (1 / 3)
    found = [block_length(autoregression(np.random.default_rng(seed), n, rho)) for seed in range(5)]
    assert np.median(found) == pytest.approx(2 * best, rel=0.15)


def test_a_constant_series_has_no_uncertainty():
    assert block_length(np.full(100, 0.3)) == 1
    assert standard_error(np.full(100, 0.3)) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("rho", [0.0, 0.6, 0.9])
def test_the_standard_error_of_a_long_series_is_that_of_the_closed_form(rho):
    n = 20_000
    found = standard_error(autoregression(np.random.default_rng(3), n, rho))
    assert found == pytest.approx(1 / ((1 - rho) * math.sqrt(n)), rel=0.15)


@pytest.mark.parametrize(("rho", "least"), [(0.0, 0.92), (0.8, 0.9), (-0.5, 0.92)])
def test_intervals_of_a_record_of_a_minute_hold_the_mean(rho, least):
    rng = np.random.default_rng(5)
    held = []
    for _ in range(600):
        found = mean_over_periods(autoregression(rng, 530, rho), np.arange(530), 530)
        held.append(abs(found.value) <= 1.96 * found.u)
    assert least <= np.mean(held) <= 0.985


def test_a_weighted_mean_over_uneven_periods_has_the_error_of_a_ratio():
    # Two values in even periods, one in odd ones, weighted: against 1000 records of the same kind.
    rng = np.random.default_rng(6)
    period = np.repeat(np.arange(200), np.where(np.arange(200) % 2, 1, 2))
    means, stated = [], []
    for _ in range(1000):
        size = rng.uniform(0.5, 1.5, size=len(period))
        found = mean_over_periods(2 + rng.normal(size=len(period)), period, 200, size)
        means.append(found.value)
        stated.append(found.u)
    assert np.mean(means) == pytest.approx(2, abs=0.01)
    assert np.median(stated) == pytest.approx(np.std(means), rel=0.1)
