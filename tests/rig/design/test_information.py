"""What measurements to come would tell, against closed forms and draws."""

import numpy as np
import pytest

from vines.errors import ParameterError
from vines.rig.design import gain, informed


def straight(times, sigma, prior):
    """Return the covariance of a line a + b t by the textbook: the inverse of the sum of two matrices."""
    h = np.stack([np.ones(len(times)), times], axis=1)
    return np.linalg.inv(np.linalg.inv(prior) + h.T @ h / sigma**2)


def test_a_straight_line_is_known_as_the_closed_form_says():
    prior = np.diag([4.0, 9.0])
    times = np.array([0.0, 0.5, 2.0])
    slopes = np.stack([np.ones(3), times], axis=1)
    found = informed(prior, slopes, 0.3**2 * np.eye(3), 5)
    assert found == pytest.approx(straight(np.tile(times, 5), 0.3, prior), rel=1e-12)


def test_a_shared_error_stays_however_often_is_measured():
    """y = a + c + e: of a, after N readings, prior A and shared C leave A (C + s^2/N)/(A + C + s^2/N)."""
    a, c, s = 4.0, 0.01, 1.0
    for count in (1, 10, 1e6):
        found = informed(np.diag([a, c]), np.array([[1.0, 1.0]]), np.array([[s]]), count)
        left = c + s / count
        assert found[0, 0] == pytest.approx(a * left / (a + left), rel=1e-9)
    assert np.sqrt(found[0, 0]) == pytest.approx(0.1, rel=0.01)


def test_information_is_what_two_entropies_differ_by_and_does_not_depend_on_units():
    prior, slopes, noise = np.diag([1.0, 4.0, 1.0]), np.array([[1.0, 0.5, 1.0]]), np.array([[0.25]])
    one = gain(prior, [(slopes, noise)], np.array([0, 1]), 3)
    after = informed(prior, slopes, noise, 3)[:2, :2]
    assert one.bits == pytest.approx(0.5 * np.log2(4.0 / np.linalg.det(after)))
    unit = np.diag([1e-3, 1e3, 1.0])
    other = gain(unit @ prior @ unit, [(slopes @ np.linalg.inv(unit), noise)], np.array([0, 1]), 3)
    assert other.bits == pytest.approx(one.bits, rel=1e-9)
    assert other.after[:2] == pytest.approx(one.after[:2] * [1e-3, 1e3])


def test_estimates_of_many_draws_scatter_as_was_said_before():
    rng = np.random.default_rng(4)
    prior, noise = np.diag([0.5, 2.0, 0.3]) ** 2, np.diag([0.2, 0.4]) ** 2
    slopes = np.array([[1.0, -0.4, 1.0], [0.3, 1.2, 0.0]])
    said = informed(prior, slopes, noise, 4)
    true = rng.multivariate_normal(np.zeros(3), prior, 20_000)
    seen = np.mean([true @ slopes.T + rng.multivariate_normal(np.zeros(2), noise, 20_000) for _ in range(4)], axis=0)
    best = prior @ slopes.T @ np.linalg.inv(slopes @ prior @ slopes.T + noise / 4)
    assert np.cov((true - seen @ best.T).T) == pytest.approx(said, abs=0.005)


def test_shapes_that_do_not_fit_and_negative_counts_are_refused():
    with pytest.raises(ParameterError, match=r"shapes are \(2, 2\), \(1, 3\), \(1, 1\); allowed are"):
        informed(np.eye(2), np.ones((1, 3)), np.eye(1))
    with pytest.raises(ParameterError, match="count is -1, allowed is 0 and more"):
        informed(np.eye(2), np.ones((1, 2)), np.eye(1), -1)
    assert np.array_equal(informed(np.eye(2), np.ones((1, 2)), np.eye(1), 0), np.eye(2))
