"""The constants of the certified steps, and the corners: two walls in one step, resonance, fast and slow balls."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from vines.dynamics import ensemble, simulate
from vines.dynamics._flight import derivatives, fourth_bound, phasors, turn
from vines.dynamics._room import constants
from vines.dynamics._steps import leaving_step, safe_step
from vines.model import Params

pytestmark = pytest.mark.long(12)


@settings(max_examples=150, deadline=None)
@given(
    A=st.floats(0, 10),
    Omega=st.one_of(st.floats(0.05, 5.0), st.floats(0.99, 1.01)),
    lam=st.one_of(st.just(0.0), st.floats(0, 1.9)),
    x=st.floats(-2, 2),
    v=st.floats(-2, 2),
    phase=st.floats(0, 6.28),
)
def test_the_fourth_derivative_stays_below_its_bound(
    A: float, Omega: float, lam: float, x: float, v: float, phase: float
) -> None:
    c = constants(Params(mu=0.1, A=A, Omega=Omega, lam=lam))
    at = phasors(c.free, Omega, x, v, phase)
    bound = fourth_bound(c, *at, c.window)
    for h in np.linspace(0.0, c.window, 40):
        later = derivatives(c.free, Omega, *turn(c.free, Omega, *at, float(h)))[4]
        assert abs(later) <= bound * (1 + 1e-9) + 1e-12 * (1 + math.hypot(at[0], at[1]) + math.hypot(at[2], at[3]))


@given(gap=st.floats(0, 2), slope=st.floats(-3, 3), curvature=st.floats(-5, 5))
def test_a_safe_step_reaches_the_wall_at_most_at_its_end(gap: float, slope: float, curvature: float) -> None:
    h = safe_step(gap, slope, curvature, 0.9)
    inner = np.linspace(0.0, h, 200)
    assert 0.0 <= h <= 0.9
    assert np.all(slope * inner + 0.5 * curvature * inner**2 <= gap + 1e-12)


@given(speed=st.floats(0, 1), second=st.floats(-2, 2), third=st.floats(-2, 2), bound=st.floats(0, 5))
def test_a_leaving_step_does_not_come_back(speed: float, second: float, third: float, bound: float) -> None:
    h = leaving_step(speed, second, third, bound, 0.9)
    inner = np.linspace(0.0, h, 200)
    height = inner * (-speed + inner * (second / 2 + inner * (max(third, 0.0) / 6 + inner * bound / 24)))
    if not (second <= 0.0 and third < 0.0):
        assert np.all(height <= 1e-15)


@pytest.mark.parametrize("v2", [20.0, -50.0, 200.0])
def test_two_walls_within_one_step(v2: float) -> None:
    p = Params(mu=1e-6, A=0.1, Omega=1.3, r=1.0)
    run = simulate(p, v2=v2, periods=0.5)
    many = ensemble(p, {"v2": [v2]}, periods=0.5)
    assert len(run.impacts) == many.counts[0] > 10
    assert np.all(np.diff(run.impacts["side"]) != 0)
    assert np.allclose(np.diff(run.impacts["t"]), 2.0 / abs(v2), rtol=0.2)


def test_a_ball_that_rests_is_struck_only_where_the_oscillator_reaches_it() -> None:
    p = Params(mu=0.1, A=0.0, Omega=2.0, lam=0.0)
    for amplitude, struck in ((0.999999, False), (1.000001, True)):
        run = simulate(p, x1=amplitude, x2=0.0 if amplitude < 1 else 1e-6, v2=0.0, periods=3)
        assert (len(run.impacts) > 0) == struck


@pytest.mark.parametrize("Omega", [0.05, 0.5, 1.0, 2.0, 5.0])
@pytest.mark.parametrize("A", [0.0, 0.1, 10.0])
@pytest.mark.parametrize("mu", [1e-6, 0.1, 10.0])
@pytest.mark.parametrize("r", [0.0, 1.0])
def test_lanes_agree_with_the_scalar_kernel_in_the_corners(Omega: float, A: float, mu: float, r: float) -> None:
    p = Params(mu=mu, A=A, Omega=Omega, r=r)
    run = simulate(p, v2=0.7, phi=0.3, periods=1.5, max_impacts_per_period=300)
    many = ensemble(p, {"v2": [0.7], "phase": [0.3]}, periods=1.5, record="impacts", max_impacts_per_period=300)
    assert many.impacts is not None
    n = min(len(run.impacts), len(many.impacts), 3)
    for name in ("t", "side", "x1", "v1", "v2"):
        assert many.impacts[name][:n] == pytest.approx(run.impacts[name][:n], rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("Omega", [0.05, 1.0, 5.0])
@pytest.mark.parametrize("A", [0.0, 0.5, 10.0])
def test_a_flight_that_never_touches_goes_on_to_the_end(Omega: float, A: float) -> None:
    # A ball at rest in the middle is touched as soon as the oscillator, which does not feel it, swings beyond 1.
    p = Params(mu=0.1, A=0.4 * A / (1 + 10 * A), Omega=Omega, lam=0.2)

    def rhs(t: float, y: list[float]) -> list[float]:
        force = p.A * math.sin(p.Omega * t) + p.lam * p.Omega * p.A * math.cos(p.Omega * t)
        return [y[1], force - p.lam * y[1] - y[0]]

    # After 200 units of time the free motion is down to 1e-9.
    free = solve_ivp(rhs, (0.0, 200.0 + p.period), [0.0, 0.0], method="DOP853", rtol=1e-10, atol=1e-12, max_step=0.02)
    largest = float(np.max(np.abs(free.y[0])))
    assert abs(largest - 1.0) > 1e-3
    run = simulate(p, v2=0.0, periods=400)
    assert (len(run.impacts) > 0) == (largest > 1.0)
    if largest < 1.0:
        assert run.status == "complete"
        assert np.max(np.abs(run.sample(20_000)["w"])) <= largest + 1e-4


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("Omega", [0.05, 1.0, 5.0])
def test_a_start_on_a_wall_with_no_relative_velocity_follows_the_push(side: int, Omega: float) -> None:
    for phi in np.linspace(0.1, 6.2, 9):
        p = Params(mu=0.2, A=0.3, Omega=Omega)
        run = simulate(p, x1=0.1, v1=0.2, x2=0.1 - side, v2=0.2, phi=float(phi), periods=0.3)
        force = p.A * math.sin(phi) + p.lam * Omega * p.A * math.cos(phi)
        push = side * (force - p.lam * 0.2 - 0.1)
        assert (run.rows[1, 0] == 2 and run.rows[1, 2] == 0.0) == (push > 0)
        many = ensemble(p, {"x1": [0.1], "v1": [0.2], "x2": [0.1 - side], "v2": [0.2], "phase": [phi]}, periods=0.3)
        assert many.final["x1"][0] == pytest.approx(run.final["x1"], abs=1e-12)


@settings(max_examples=60, deadline=None)
@given(depth=st.floats(-11, -4), miss=st.booleans(), Omega=st.floats(0.3, 3.0), phi=st.floats(0, 6.28))
def test_grazing_under_forcing_is_decided_by_the_peak(depth: float, miss: bool, Omega: float, phi: float) -> None:
    # The ball rests so that the largest gap of the free oscillator stops short of the wall, or passes it, by 10**depth.
    p = Params(mu=0.05, A=0.05, Omega=Omega, lam=0.05)
    start = {"x1": 0.1, "v1": 0.4, "x2": 0.0, "v2": 0.0}
    free = simulate(p, **(start | {"x2": 0.0}), phi=phi, periods=2)
    until = float(free.impacts["t"][0]) if len(free.impacts) else free.t_end
    t = np.linspace(0.0, min(until, free.t_end), 4001)
    x = free.sample(times=t)["x1"]
    k = int(np.argmax(x[: 1 + len(x) // 2]))
    if k in (0, len(x) // 2) or x.min() < x[k] - 1.9:
        return
    near = np.linspace(t[k - 1], t[k + 1], 4001)
    peak = float(np.max(free.sample(times=near)["x1"]))
    shift = 10**depth if miss else -(10**depth)
    stop = float(t[k] + (t[1] - t[0]))
    run = simulate(p, **(start | {"x2": peak - 1.0 + shift}), phi=phi, periods=stop / p.period)
    assert (len(run.impacts) == 0) == miss


@pytest.mark.parametrize("lam", [1e-2, 1e-4, 1e-6])
def test_resonance_with_vanishing_damping(lam: float) -> None:
    p = Params(mu=0.01, A=0.01, Omega=1.0, lam=lam)
    run = simulate(p, x2=0.95, v2=0.0, periods=3)
    first = run.impacts[0]
    # Without damping x1 = A (sin t - t cos t)/2 from rest; lam changes it by less than lam t times as much.
    t = float(first["t"])
    assert first["x1"] == pytest.approx(0.5 * p.A * (math.sin(t) - t * math.cos(t)), abs=3 * lam * t * p.A * t + 1e-10)
    m = run.measures()
    assert abs(m.balance) < 1e-9 * (m.base_work + m.max_abs_x1**2)
