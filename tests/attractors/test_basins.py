"""Basins: every start to its attractor, mirror images told apart, shares with errors, boundaries cut finer."""

from __future__ import annotations

import numpy as np
import pytest

from vines.attractors import basins, settle
from vines.errors import StateError
from vines.model import Params

ASYMMETRIC = Params(mu=0.01, A=0.02)
GRID = (("x2", np.linspace(-0.9, 0.9, 6)), ("v2", np.linspace(-0.4, 0.4, 6)))


def test_mirror_images_are_one_attractor_and_each_start_goes_where_settle_says() -> None:
    found = basins(ASYMMETRIC, *GRID)
    assert [a.name for a in found.attractors] == ["1:1"]
    assert found.fraction(0)[0] == pytest.approx(1.0)
    assert set(found.mirrored) == {False, True}
    images = {}
    for k in range(0, len(found.x), 7):
        at = settle(ASYMMETRIC, x2=float(found.x[k]), v2=float(found.y[k])).impacts
        left = at[at["side"] > 0]
        images.setdefault(bool(found.mirrored[k]), []).append(float(left["x1"][-1]))
    for values in images.values():
        assert np.ptp(values) < 1e-6


def test_starts_outside_the_cavity_are_left_out_and_weights_sum_to_one() -> None:
    found = basins(ASYMMETRIC, ("x2", np.linspace(-1.5, 1.5, 6)), ("v2", [0.1, 0.2]), refine=1)
    assert np.all(np.abs(found.x) <= 1.0)
    assert found.weight.sum() == pytest.approx(1.0)
    assert 0.0 <= found.fraction(0)[1] < 0.3


def test_bad_coordinates_are_refused() -> None:
    with pytest.raises(StateError, match="unknown coordinate 'v3'"):
        basins(ASYMMETRIC, ("v3", [0.0, 1.0]), ("v2", [0.1, 0.2]))
    with pytest.raises(StateError, match="must be two"):
        basins(ASYMMETRIC, ("v2", [0.0, 1.0]), ("v2", [0.1, 0.2]))
    with pytest.raises(StateError, match="no start of the grid"):
        basins(ASYMMETRIC, ("x2", [2.0, 3.0]), ("v2", [0.1, 0.2]))
