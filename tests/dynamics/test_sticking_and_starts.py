"""Chatter, sticking, release; starts on a wall; caps; bad starts; limits of the parameters."""

from __future__ import annotations

import math

import numpy as np
import pytest

from vines.dynamics import ball_locked, no_ball, simulate
from vines.errors import StateError
from vines.model import Params

CHATTER = Params(mu=0.0084, A=0.015)


def test_the_known_chatter_ends_with_the_known_release() -> None:
    run = simulate(CHATTER)
    assert run.status == "complete"
    assert run.impacts["t"][4] == pytest.approx(45.353, abs=1e-3)
    slow = np.flatnonzero(np.abs(run.impacts["w_dot"]) * CHATTER.r < 1e-4)
    assert slow[0] + 1 == 21
    stick = run.sticks[0]
    assert stick["side"] == -1
    assert stick["t_start"] == pytest.approx(48.2963, abs=3e-4)
    assert stick["t_release"] == pytest.approx(48.6979167390, abs=1e-9)
    assert stick["impacts"] == 24


def test_while_stuck_both_move_as_one_heavier_mass() -> None:
    run = simulate(CHATTER, periods=10)
    spell = run.sticks[0]
    s = run.sample(times=np.linspace(spell["t_start"] + 1e-9, spell["t_release"] - 1e-9, 2001))
    assert np.all(s["stuck"] == -1)
    assert np.array_equal(s["v1"], s["v2"])
    dt = s["t"][1] - s["t"][0]
    acceleration = np.gradient(s["v1"], dt, edge_order=2)
    force = s["base"] + CHATTER.lam * CHATTER.A * np.cos(s["phase"]) - CHATTER.lam * s["v1"] - s["x1"]
    assert np.max(np.abs((1 + CHATTER.mu) * acceleration - force)) < 1e-7
    # Contact pushes the ball until it is let go.
    assert np.all(-force[:-1] > 0)
    assert abs(force[-1]) < 1e-8


def test_a_start_on_a_wall_strikes_sticks_or_leaves() -> None:
    p = Params(mu=0.1, A=0.0, Omega=2.0)
    struck = simulate(p, x1=0.0, v1=0.5, x2=-1.0, v2=0.0, periods=0.1)
    assert struck.impacts["t"][0] == 0.0
    assert struck.impacts["side"][0] == 1
    # With x1 < 0 the spring pushes the mass right: on the left end that is towards the ball.
    pushed = simulate(p, x1=-0.5, v1=0.0, x2=-1.5, v2=0.0, periods=0.1)
    assert (len(pushed.impacts), len(pushed.sticks)) == (0, 1)
    assert pushed.final["x1"] - pushed.final["x2"] == pytest.approx(1.0, abs=1e-15)
    pulled = simulate(p, x1=0.5, v1=0.0, x2=-0.5, v2=0.0, periods=0.1)
    assert (len(pulled.impacts), len(pulled.sticks)) == (0, 0)
    assert pulled.final["x1"] - pulled.final["x2"] < 1.0
    left = simulate(p, x1=0.0, v1=-0.5, x2=-1.0, v2=0.0, periods=0.1)
    assert len(left.impacts) == 0


def test_rest_in_contact_without_any_push_stays() -> None:
    run = simulate(Params(mu=0.1, A=0.0), x1=0.0, x2=-1.0, v2=0.0, periods=200)
    assert run.status == "complete"
    assert run.final["x2"] == -1.0
    assert run.measures().base_work == 0.0


def test_a_merge_into_vanishing_force_and_jerk_goes_on() -> None:
    # After the merge at the start v = 1/2 and F - x1 = F' - v = F'' = 0: no sign tells whether the ball stays.
    run = simulate(Params(mu=1.0, A=1.0, Omega=0.5, r=0.0, lam=0.0), x2=1.0, v2=1.0, periods=6)
    assert run.status == "complete"
    assert abs(run.measures().balance) < 1e-12


def test_a_ball_at_rest_that_is_never_touched_stays() -> None:
    p = Params(mu=0.1, A=0.001)
    run = simulate(p, v2=0.0, periods=3000)
    assert len(run.impacts) == 0
    assert run.measures(last=1).max_abs_x1 == pytest.approx(no_ball(p), rel=1e-9)


def test_a_stuck_ball_is_as_if_locked() -> None:
    p = Params(mu=0.01, A=0.02)
    step = 1e-6
    slope = (no_ball(p.replace(Omega=1 + step)) - no_ball(p.replace(Omega=1 - step))) / (2 * step)
    assert no_ball(p) == pytest.approx(0.02 * math.hypot(1, p.lam) / p.lam)
    assert slope < 0
    assert ball_locked(p.replace(mu=1e-12)) == pytest.approx(no_ball(p))


@pytest.mark.parametrize("r", [0.0, 1e-3, 0.3, 0.999, 1.0])
@pytest.mark.parametrize("mu", [1e-6, 0.1, 10.0])
@pytest.mark.parametrize(("A", "Omega"), [(0.0, 1.0), (0.05, 0.05), (10.0, 5.0), (1.0, 1.0)])
def test_nothing_hangs_at_the_limits(r: float, mu: float, A: float, Omega: float) -> None:
    run = simulate(Params(mu=mu, A=A, Omega=Omega, r=r), periods=30)
    assert run.status in ("complete", "impact_cap")
    assert np.all(np.isfinite(run.rows))
    gap = np.abs(run.sample(2000)["w"])
    assert np.max(gap) < 1.0 + 1e-11


def test_r_zero_sticks_at_the_first_impact_that_pushes() -> None:
    run = simulate(Params(mu=0.05, A=0.1, r=0.0), periods=20)
    assert len(run.sticks) > 3
    assert np.max(run.sticks["impacts"]) <= 3
    assert np.all(run.sticks["t_release"][:-1] > run.sticks["t_start"][:-1])


def test_a_cap_gives_a_status_and_a_shorter_run() -> None:
    run = simulate(CHATTER, max_impacts_per_period=8)
    assert run.status == "impact_cap"
    assert run.t_end < 50.0
    assert run.t_end == run.impacts["t"][-1]


def test_resonance_with_little_damping() -> None:
    p = Params(mu=0.01, A=0.01, Omega=1.0, lam=1e-5)
    run = simulate(p, periods=60)
    m = run.measures()
    assert len(run.impacts) > 50
    assert abs(m.balance) < 1e-9 * (m.base_work + m.impact_loss)


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ({"x1": 0.0, "x2": 1.2}, "gap w = x1 - x2 is -1.2"),
        ({"v1": math.nan}, "v1 is nan"),
        ({"v2": math.inf}, "v2 is inf"),
        ({"x1": "a"}, "x1 is 'a'"),
        ({"periods": 0}, "periods is 0"),
        ({"periods": math.nan}, "periods is nan"),
        ({"max_impacts_per_period": 0}, "max_impacts_per_period is 0"),
    ],
)
def test_bad_starts_are_refused_in_one_line(start: dict[str, float], message: str) -> None:
    with pytest.raises(StateError, match=message) as caught:
        simulate(CHATTER, **start)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


def test_samples_outside_the_run_are_refused() -> None:
    run = simulate(CHATTER, periods=2)
    for times in ([-1.0], [100.0], [2.0, 1.0], [math.nan]):
        with pytest.raises(StateError, match=r"times must ascend|times is nan"):
            run.sample(times=times)
    with pytest.raises(StateError, match="choose one"):
        run.sample(5, per_period=2)
    with pytest.raises(StateError, match="last is 3"):
        run.measures(last=3)
