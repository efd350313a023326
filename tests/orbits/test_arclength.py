"""Following a zero set that is known in closed form: the circle x² + a² = 1."""

from types import SimpleNamespace

import numpy as np
import pytest

from vines.model import Word
from vines.orbits._arclength import Chord, Walk
from vines.orbits._problem import Point, ZeroSet


class Circle:
    word = Word("LR")
    parameter = "a"
    start = np.array([1.0, 0.0])

    def equations(self, y):
        return np.array([y @ y - 1.0]), 2.0 * y[None, :]

    def orbit(self, y):
        return SimpleNamespace(params=y)


def followed(high, **how):
    zero = ZeroSet(Circle(), 1.0)
    met = []

    def record(here, there, last):
        met.append(there)
        return "border" if last else None

    walk = Walk(zero, np.array([-2.0]), np.array([high]), largest=0.1, smallest=1e-8, turn=0.2, **how)
    begin = Point(Circle.start, np.array([0.0, 1.0]), Circle().orbit(Circle.start))
    return walk.follow(begin, record, 100), met, zero


@pytest.mark.parametrize("only_inside", [True, False])
def test_it_ends_on_the_border(only_inside):
    end, met, _ = followed(0.6, only_inside=only_inside)
    assert end == "border"
    assert met[-1].y == pytest.approx([0.8, 0.6], abs=1e-14)
    assert all(abs(np.linalg.norm(point.y) - 1.0) < 1e-14 for point in met)
    assert all(point.value < 0.6 for point in met[:-1])


def test_it_goes_through_folds_and_finds_where_they_are():
    end, met, zero = followed(2.0)
    assert end == "points"
    angles = np.unwrap([np.arctan2(point.y[1], point.y[0]) for point in met])
    assert np.all((np.diff(angles) > 0) & (np.diff(angles) < 0.2))
    k = next(k for k, point in enumerate(met) if point.tangent[1] < 0)
    chord = Chord(zero, met[k - 1], met[k])
    fold = chord.point(chord.root(lambda point: float(point.tangent[1]), 1e-14))
    assert fold.y == pytest.approx([0.0, 1.0], abs=1e-13)


def test_a_curve_that_turns_too_sharply_for_the_least_step_is_lost():
    zero = ZeroSet(Circle(), 1.0)
    begin = Point(Circle.start, np.array([0.0, 1.0]), Circle().orbit(Circle.start))
    walk = Walk(zero, np.array([-2.0]), np.array([2.0]), largest=0.4, smallest=0.05, turn=0.01)
    assert walk.follow(begin, lambda here, there, last: None, 10) == "lost"
