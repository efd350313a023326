"""The closing equations of any system: of the VI-NES they are its own, and their slope is that of differences."""

from __future__ import annotations

import numpy as np
import pytest

from vines.dynamics._room import constants
from vines.model import Params, Word
from vines.orbits._chains import chain_closing, links
from vines.orbits._equations import closing_kernel, closing_unit
from vines.orbits._values import essentials_of
from vines.systems import ImpactPair


def test_of_the_vi_nes_they_are_its_own():
    p = Params(mu=0.3, A=0.4, Omega=1.2)
    c = constants(p)
    side = np.array(Word("LLRLR").sides, dtype=np.int64)
    t = np.array([0.3, 1.0, 2.4, 3.6, 4.9])
    regular, own, own_slope, own_states = closing_kernel(essentials_of(c), p.period, side, t)
    again, defect, slope, states = chain_closing(c, p.period, side, t)
    assert regular
    assert again
    assert states == pytest.approx(own_states, abs=1e-12)
    assert defect * p.mu == pytest.approx(own, abs=1e-12)
    assert slope * p.mu == pytest.approx(own_slope, abs=1e-11)
    assert closing_unit(c)[0] == p.mu


@pytest.mark.parametrize("sides", [[1], [1, -1], [1, 1, -1, 1]])
def test_slopes_are_those_of_differences(sides):
    c = constants(ImpactPair(B=0.7, G=0.1, r=0.6))
    side = np.array(sides, dtype=np.int64)
    duration = 2 * np.pi * 2
    t = 0.4 + np.arange(len(side)) * 1.7
    _, _, slope, _ = chain_closing(c, duration, side, t)
    h = 1e-6
    for k in range(len(side)):
        step = np.zeros(len(side))
        step[k] = h
        above, below = (chain_closing(c, duration, side, t + s * step)[1] for s in (1, -1))
        assert slope[:, k] == pytest.approx((above - below) / (2 * h), abs=1e-8)


def test_each_ball_has_a_chain_of_its_own():
    assert links(np.array([1, 2, -1, -2, 1, 3])).tolist() == [2, 3, 4, 1, 0, 5]
