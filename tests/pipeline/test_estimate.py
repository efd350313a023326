"""How long a run would take is told by points drawn from all, not by one that happens to be slow or quick."""

import numpy as np
import pytest

from vines.pipeline._estimate import seconds_a_point


@pytest.mark.parametrize(
    ("slow", "share", "total"),
    [(0.3, 0.1, 12_000), (0.05, 0.5, 400), (0.003, 0.0, 10**6), (0.02, 0.3, 30)],
)
def test_the_mean_of_quick_and_slow_points_is_found_within_a_factor_of_two(slow, share, total):
    for seed in range(20):
        costs = np.where(np.random.default_rng(seed).random(total) < share, slow, 0.003)
        passed, counts = [0.0], []

        def compute(first, count, costs=costs, passed=passed, counts=counts):
            assert first + count <= len(costs)
            counts.append(count)
            passed[0] += 0.001 + costs[first : first + count].sum()

        told = seconds_a_point(compute, total, lambda passed=passed: passed[0])
        assert 0.5 < told / costs.mean() < 2.0
        assert passed[0] < 12.0
        assert counts[:2] == [1, 1]  # the first loads and compiles


def test_one_point_is_told_by_itself():
    clock = iter([0.0, 0.25])
    assert seconds_a_point(lambda first, count: None, 1, lambda: next(clock)) == 0.25
