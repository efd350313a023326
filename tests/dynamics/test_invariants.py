"""What the exact motion must keep: momentum, energy, symmetry, reversal, and itself however it is cut into calls."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vines.attractors import settle
from vines.dynamics import _advance as col
from vines.dynamics import lyapunov_spectrum, no_ball, simulate, tangent_map
from vines.dynamics._advance import advance, begin, new_state, pass_over, set_state
from vines.dynamics._room import constants
from vines.model import Params

parameters = st.builds(
    Params,
    mu=st.floats(-5, 1).map(lambda e: 10**e),
    A=st.floats(-3, 1).map(lambda e: 10**e),
    Omega=st.one_of(st.floats(0.05, 5.0), st.floats(0.99, 1.01), st.just(1.0)),
    r=st.floats(0.0, 1.0),
    lam=st.one_of(st.floats(0.0, 1.0), st.sampled_from([0.0, 1e-12, 1e-6])),
)


@settings(max_examples=120, deadline=None)
@given(p=parameters, v2=st.floats(-2, 2), w=st.floats(-1, 1), cut=st.floats(0.0, 1.0), phi=st.floats(0, 6.28))
def test_energy_balances_over_any_window(p: Params, v2: float, w: float, cut: float, phi: float) -> None:
    run = simulate(p, x2=-w, v2=v2, phi=phi, periods=6, max_impacts_per_period=500)
    ran = (run.t_end - run.t_start) / p.period
    for m in (run.measures(), run.measures(last=(0.01 + 0.98 * cut) * ran)) if ran > 0 else ():
        turned_over = abs(m.base_work) + m.damper_loss + m.impact_loss + abs(m.energy_change)
        stored = 0.5 * (1 + p.mu) * m.max_abs_x1**2 * max(1.0, p.Omega**2) + p.A**2
        assert abs(m.balance) <= 1e-12 * (turned_over + stored)


def test_energy_balances_over_a_period_to_1e_12_of_the_base_work() -> None:
    for A in (0.015, 0.020, 0.021, 0.023):
        m = settle(Params(mu=0.01, A=A)).measures
        assert abs(m.balance) <= 1e-12 * m.base_work
        assert abs(m.energy_change) <= 1e-8 * m.base_work


def test_momentum_is_kept_and_the_gap_reverses_at_impacts() -> None:
    p = Params(mu=0.1, A=0.3, Omega=1.2)
    hits = simulate(p, periods=100).impacts
    momentum = hits["v1"] + p.mu * hits["v2"] - hits["v1_after"] - p.mu * hits["v2_after"]
    assert np.max(np.abs(momentum)) < 1e-14
    assert np.max(np.abs(hits["v1_after"] - hits["v2_after"] + p.r * hits["w_dot"])) < 1e-14
    assert np.max(np.abs(hits["x1"] - hits["x2"] - hits["side"])) < 1e-15


def test_the_samples_stay_in_the_cavity_and_carry_a_running_balance() -> None:
    p = Params(mu=0.0084, A=0.015)
    run = simulate(p, periods=10)
    s = run.sample(per_period=64, at_events=True)
    assert np.max(np.abs(s["w"])) < 1.0 + 1e-13
    assert set(np.unique(s["stuck"])) == {-1, 0}
    stored = s["kinetic_1"] + s["kinetic_2"] + s["potential"]
    lost = s["base_work"] - s["damper_loss"] - s["impact_loss"] - (stored - stored[0])
    assert np.max(np.abs(lost)) < 1e-13 * s["base_work"][-1]
    twice = np.isin(s["t"], run.events["t"][1:-1])
    assert twice.sum() == 2 * (len(run.events) - 2)


def test_the_measures_are_those_of_dense_samples() -> None:
    run = simulate(Params(mu=0.05, A=0.1, Omega=1.17), periods=20)
    m, s = run.measures(), run.sample(200_001)
    assert m.max_abs_x1 == pytest.approx(np.max(np.abs(s["x1"])), rel=1e-6)
    assert m.max_abs_x1 >= np.max(np.abs(s["x1"]))
    assert abs(run.sample(times=[m.t_max_abs_x1])["x1"][0]) == pytest.approx(m.max_abs_x1, abs=1e-12)
    assert m.kinetic_1 == pytest.approx(np.mean(s["kinetic_1"]), rel=1e-4)
    assert m.kinetic_ratio == pytest.approx(np.mean(s["kinetic_2"]) / np.mean(s["kinetic_1"]), rel=1e-4)
    assert m.rms_x1 == pytest.approx(math.sqrt(np.mean(s["x1"] ** 2)), rel=1e-4)


def test_the_mirror_image_of_a_run_is_a_run() -> None:
    p = Params(mu=0.05, A=0.1, Omega=1.17)
    run = simulate(p, x1=0.2, v1=-0.1, x2=0.3, v2=0.4, phi=0.3, periods=8)
    other = simulate(p, x1=-0.2, v1=0.1, x2=-0.3, v2=-0.4, phi=0.3 + math.pi, periods=8)
    assert np.array_equal(run.impacts["side"], -other.impacts["side"])
    for name in ("v1", "v2", "x1"):
        assert np.max(np.abs(run.impacts[name] + other.impacts[name])) < 1e-9


def test_without_losses_a_run_reversed_comes_back() -> None:
    p = Params(mu=0.05, A=0.1, Omega=1.37, r=1.0, lam=0.0)
    there = simulate(p, x1=0.1, v1=0.2, x2=0.0, v2=0.5, phi=0.7, periods=4)
    assert len(there.impacts) > 4
    end = there.final
    back = simulate(
        p, x1=end["x1"], v1=-end["v1"], x2=end["x2"], v2=-end["v2"], phi=math.pi - end["phase"], periods=4
    ).final
    assert [back["x1"], -back["v1"], back["x2"], -back["v2"]] == pytest.approx([0.1, 0.2, 0.0, 0.5], abs=1e-9)


def test_a_run_does_not_depend_on_how_it_is_cut_into_calls() -> None:
    p = Params(mu=0.0084, A=0.015)
    c, state = constants(p), new_state()
    set_state(state, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0)
    rows = np.zeros((200, col.ROW))
    begin(c, state, rows)
    count = 1
    for stop in np.arange(0.1, 20 * p.period, 0.37):
        while True:
            count, code = advance(c, state, stop, 1000, rows[: count + 2], count)
            if code == col.COMPLETE:
                break
    whole = simulate(p, periods=20).rows
    assert np.array_equal(rows[:count], whole[:count])


def test_a_stable_orbit_is_the_same_after_a_million_periods() -> None:
    p = Params(mu=0.01, A=0.015)
    orbit = settle(p)
    c, state = constants(p), new_state()
    final = orbit.final
    set_state(state, final["x1"], final["v1"], final["x2"], final["v2"], final["phase"], 0.0)
    assert pass_over(c, state, 1e6 * p.period, 1000, np.empty((64, col.ROW))) == col.COMPLETE
    rows = np.empty((3, col.ROW))
    advance(c, state, (1e6 + 3) * p.period, 1000, rows, 0)
    # Symmetric 1:1 in closed form: (alpha² + beta²) V² + 2 alpha V + 1 - B² = 0 and w' = 2 V (1 + mu)/(1 + r).
    s, half = complex(-p.lam / 2, math.sqrt(1 - p.lam**2 / 4)), p.period / 2
    q = 1 / (1 + cmath.exp(s * half))
    kappa = (1 + 2 * p.mu - p.r) / (1 + p.r)
    alpha = 2 * p.mu * q.imag / s.imag - half / 2
    beta = (kappa + 2 * p.mu * ((s * q).imag / s.imag - 1)) / p.Omega
    square = alpha**2 + beta**2
    V = (-alpha + math.sqrt(alpha**2 - square * (1 - no_ball(p) ** 2))) / square
    reference = 2 * V * (1 + p.mu) / (1 + p.r)
    assert np.max(np.abs(np.abs(rows[:, col.V1] - rows[:, col.V2]) - reference)) < 1e-12
    drift = (rows[:, col.PHASE] - p.Omega * rows[:, col.TIME] - final["phase"] + math.pi) % (2 * math.pi) - math.pi
    assert np.max(np.abs(drift)) < 1e-8


def test_lyapunov_exponents_obey_the_sum_rule() -> None:
    p = Params(mu=0.01, A=0.03)
    run = simulate(p, periods=400)
    assert len(run.sticks) == 0
    exponents, errors = lyapunov_spectrum(run)
    duration = run.t_end - run.t_start
    assert exponents.sum() == pytest.approx(-p.lam + 2 * len(run.impacts) / duration * math.log(p.r), abs=1e-9)
    assert exponents[0] > 3 * errors[0]


def test_the_tangent_map_is_the_derivative_of_the_motion() -> None:
    p = Params(mu=0.1, A=0.3, Omega=1.2)
    start = {"x1": 0.1, "v1": 0.2, "x2": 0.05, "v2": 0.7}
    J = tangent_map(simulate(p, **start, periods=1.5))
    for j, name in enumerate(start):
        h = 1e-6
        ends = [simulate(p, **(start | {name: start[name] + s * h}), periods=1.5).final for s in (1, -1)]
        difference = [(ends[0][key] - ends[1][key]) / (2 * h) for key in start]
        assert J[:, j] == pytest.approx(difference, rel=1e-6, abs=1e-6)
