"""How many ticks a lane takes for a flight: what depends on the guess of its length."""

from __future__ import annotations

import math

import numpy as np
import pytest

from vines.dynamics import _lane_fields as f
from vines.dynamics._advance import new_state, set_state
from vines.dynamics._lane_state import fill_lane
from vines.dynamics._lanes import tick
from vines.dynamics._room import constants
from vines.model import Params


@pytest.mark.filterwarnings("ignore::numba.core.errors.NumbaPendingDeprecationWarning")
@pytest.mark.parametrize("r", [0.5, 0.9])
def test_a_hop_of_a_chatter_takes_one_tick(r: float) -> None:
    # A ball 1 behind the frame, which accelerates towards it: each hop is about r times the one before.
    p = Params(mu=0.001, A=0.1, r=r)
    state, lanes, length = new_state(), np.zeros(f.SIZE), 100.0
    lanes[f.WAITS : f.WAITS + f.LANES] = 1.0
    set_state(state, -1.0, 0.0, -2.0, 0.05, 0.5 * math.pi, 0.0)
    assert fill_lane([constants(p)] * f.LANES, state, lanes, 0, length)
    ticks = hits = 0
    while lanes[f.WAITS] == 0.0 and ticks < 1000:
        tick(lanes, 10**9)
        ticks += 1
        hits += int(lanes[f.HIT] > 0.0)
    # The scalar kernel, which decides on merges, is asked before a quarter of a period is over.
    assert lanes[f.LEFT] > length - 0.5 * math.pi
    assert hits > 8
    assert ticks <= hits + 5
