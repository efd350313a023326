"""Sticking that recurs is a property of its own, told from a stick now and then."""

from __future__ import annotations

import numpy as np
import pytest

from vines.attractors import classify_many, settle
from vines.dynamics import simulate
from vines.model import Params

# A complete chatter on both sides of a 1:1/3T orbit.
CHATTER = Params(mu=0.630582, A=0.299886, Omega=1.23057, r=0.287605, lam=0.229229)
# Chaos that sticks now and then.
NOW_AND_THEN = Params(mu=0.0124458, A=0.0635328, Omega=1.11182, r=0.40324)


def _share(p: Params, final: dict[str, float], periods: int) -> float:
    """Return the share of the forcing periods with a spell of sticking, from the list of spells."""
    state = {name: final[name] for name in ("x1", "v1", "x2", "v2")}
    run = simulate(p, **state, phi=final["phase"], periods=periods)
    seen = np.zeros(periods, dtype=bool)
    for spell in run.sticks:
        first, last = (int(spell[name] / p.period) for name in ("t_start", "t_release"))
        seen[first : min(last, periods - 1) + 1] = True
    return float(seen.mean())


def test_a_periodic_orbit_that_sticks_does_so_for_ever() -> None:
    found = settle(CHATTER)
    assert found.recurrent_sticking
    # Two spells in three periods: in which of them depends on where a period is taken to begin.
    assert found.sticking_share in (pytest.approx(1 / 3), pytest.approx(2 / 3), pytest.approx(1.0))
    assert not settle(Params(mu=0.01, A=0.015)).recurrent_sticking


def test_a_stick_now_and_then_does_not_recur_in_every_period() -> None:
    found = settle(NOW_AND_THEN, record=256)
    assert found.regime == "chaotic"
    assert 0 < found.sticks < 0.5
    assert not found.recurrent_sticking
    # The same run by itself, and its list of spells.
    p = NOW_AND_THEN
    start = settle(p, record=2, patience=0).final
    again = settle(
        p, **{name: start[name] for name in ("x1", "v1", "x2", "v2")}, phi=start["phase"], settle=0, record=64
    )
    assert again.sticking_share == pytest.approx(_share(p, start, 64), abs=1 / 64)


def test_a_heavy_ball_sticks_in_nearly_every_period_of_chaos_too() -> None:
    many = classify_many({"mu": np.geomspace(0.3, 1.0, 24), "A": 0.05}, settle=200, watch=128)
    chaotic = many.regime == "chaotic"
    assert np.array_equal(many.recurrent_sticking[chaotic], many.sticking_share[chaotic] >= 0.9)
    assert many.recurrent_sticking.tolist() == [many.attractor(k).recurrent_sticking for k in range(len(many))]
    assert np.all((many.sticking_share > 0) == (many.sticks > 0))
