"""A ball with a mass on a cubic spring beside it against DOP853, closed forms of its limits, and balances."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import vines
from vines import systems
from vines.attractors import random_starts
from vines.dynamics import lyapunov_spectrum, tangent_map
from vines.dynamics._advance import MODE
from vines.dynamics._simulate import record
from vines.dynamics.hybrid import hybrid_constants
from vines.dynamics.kernels import room_of
from vines.errors import ParameterError

H = systems.Hybrid(mu=0.01, A=0.03, mu_n=0.01, k3=1.0, l2=0.2)
STATE = ("x1", "v1", "x2", "v2", "x3", "v3")
ORBIT = [
    [1.3808, -0.3786, 0.1968, -1.3786, -0.8776, -1.6804, -0.2051],
    [4.5224, 0.3786, -0.1968, 1.3786, 0.8776, 1.6804, 0.2051],
]
"""The orbit LR of H: t, then the state just before each impact."""


def drawn(seed: int, **given: float) -> systems.Hybrid:
    """Return parameters at random: springs soft, stiff and with two wells."""
    rng = np.random.default_rng(seed)
    free = {
        "mu": rng.uniform(0.005, 0.2), "A": rng.uniform(0.05, 0.6), "Omega": rng.uniform(0.5, 2.0),
        "r": rng.uniform(0.0, 0.95), "mu_n": rng.uniform(0.005, 0.2), "k1": rng.uniform(-0.5, 2.0),
        "k3": rng.uniform(0.1, 5.0), "l2": rng.uniform(0.0, 0.3),
    }  # fmt: skip
    return systems.Hybrid(**(free | given))


def rates(p, phase):
    """Return the equations of flight in (x1, v1, x2, v2, x3, v3) from a phase on, with their variational ones."""

    def f(t, y):
        x1, v1, _, v2, x3, v3 = y[:6]
        angle = phase + p.Omega * t
        u, rate = x1 - x3, v1 - v3
        spring = p.k1 * u + p.k3 * u**3 + p.l2 * rate
        force = p.A * (math.sin(angle) + p.lam * p.Omega * math.cos(angle))
        first = [v1, force - p.lam * v1 - x1 - p.mu_n * spring, v2, 0.0, v3, spring]
        if len(y) == 6:
            return first
        k = p.k1 + 3 * p.k3 * u * u
        a = np.array([k, p.l2, 0, 0, -k, -p.l2])
        own = np.array([-1, -p.lam, 0, 0, 0, 0]) - p.mu_n * a
        J = np.array([[0, 1, 0, 0, 0, 0], own, [0, 0, 0, 1, 0, 0], np.zeros(6), [0, 0, 0, 0, 0, 1], a])
        return [*first, *(J @ np.reshape(y[6:], (6, 6))).ravel()]

    return f


def flown(p, phase, y, tau, **options):
    return solve_ivp(rates(p, phase), (0, tau), y, "DOP853", rtol=1e-13, atol=1e-15, max_step=0.05, **options)


def after(row):
    """Return the state just after the event of a row."""
    return [row["x1"], row["v1_after"], row["x2"], row["v2_after"]]


def test_a_run_of_many_impacts_against_dop853_with_events():
    """Nothing is taken from ours but the start: SciPy finds every impact of the whole run itself."""
    p = H.replace(A=0.025)
    run = vines.simulate(p, v2=0.4, x3=0.2, periods=30)
    hits = run.impacts
    assert len(hits) > 50
    walls = [lambda t, y, side=side: 1.0 - side * (y[0] - y[2]) for side in (1, -1)]
    for wall in walls:
        wall.terminal, wall.direction = True, -1
    t, y, found = 0.0, np.array([0.0, 0.0, 0.0, 0.4, 0.2, 0.0]), []
    while len(found) < 55:
        flight = flown(p, p.Omega * t, y, 3 * p.period, events=walls)
        side = 1 if flight.t_events[0].size else -1
        t, y = t + flight.t[-1], flight.y[:, -1]
        found.append((t, side, *y))
        w = y[1] - y[3]
        y[1], y[3] = y[1] - p.mu * (1 + p.r) * w / (1 + p.mu), y[3] + (1 + p.r) * w / (1 + p.mu)
    found = np.array(found)
    assert np.array_equal(hits["side"][:55], found[:, 1])
    assert hits["t"][:55] == pytest.approx(found[:, 0], abs=1e-10)
    for column, name in enumerate(("x1", "v1", "x2", "v2"), start=2):
        assert hits[name][:55] == pytest.approx(found[:, column], abs=1e-10)


@pytest.mark.parametrize("seed", range(4))
def test_every_flight_against_dop853(seed):
    p = drawn(seed)
    run = vines.simulate(p, x1=0.3, v2=0.7, x2=-0.2, x3=0.5, v3=-0.3, phi=1.3, periods=3)
    beside = run.rows[:, -2:]
    seen = 0
    for k, (now, then) in enumerate(pairwise(run.events)):
        tau = then["t"] - now["t"]
        if run.rows[k, MODE] != 0 or tau < 1e-3:
            continue
        y = flown(p, now["phase"], [*after(now), *beside[k]], tau).y
        gaps = y[0] - y[2]
        assert np.abs(gaps[1:-1]).max(initial=0.0) < 1
        assert [*(then[name] for name in STATE[:4]), *beside[k + 1]] == pytest.approx(y[:, -1], abs=3e-11)
        if then["kind"] == 1:
            assert abs(gaps[-1]) == pytest.approx(1, abs=3e-11)
            assert then["v1_after"] - then["v2_after"] == pytest.approx(-p.r * (y[1, -1] - y[3, -1]), abs=3e-11)
        seen += 1
    assert seen >= 3


def test_twice_the_order_gives_the_same_run():
    p = drawn(3, r=0.8, A=0.5)
    values = list(p.as_dict().values())
    room = room_of(p)
    layout = room.layout(p)
    rows = []
    for order in (20, 40):
        c = hybrid_constants(*values, order=order)
        state = np.zeros(layout.state)
        room.begin(c, state, 0.1, 0.0, np.array([0.0, 0.3]), np.array([0.4, 0.0]), 0.0, 0.0)
        rows.append(record(c, state, [8 * p.period], 1000, 256, layout.width)[0])
    usual, sceptic = rows
    assert len(usual) > 15
    assert usual == pytest.approx(sceptic, abs=1e-10)


def test_without_mass_it_is_the_vi_nes():
    given = {"mu": 0.01, "A": 0.015}
    ours, theirs = (vines.simulate(p(**given), periods=150) for p in (systems.Hybrid, vines.Params))
    assert ours.impacts["t"] == pytest.approx(theirs.impacts["t"], abs=1e-11)
    mine, other = ours.measures(last=30), theirs.measures(last=30)
    for name in ("kinetic_ratio", "max_abs_x1", "base_work", "damper_loss", "impact_loss"):
        assert getattr(mine, name) == pytest.approx(getattr(other, name), abs=1e-12)
    # With a mass that is next to nothing the spring does its work and the ball does not see it.
    light = vines.simulate(H.replace(mu_n=1e-14, A=0.015), periods=30)
    theirs = vines.simulate(vines.Params(**given), periods=30)
    assert light.impacts["t"] == pytest.approx(theirs.impacts["t"], abs=1e-12)


def test_without_mass_it_sticks_as_the_vi_nes_does():
    given = {"mu": 0.05, "A": 2.0, "Omega": 0.3, "r": 0.3}
    ours, theirs = (vines.simulate(p(**given), periods=12) for p in (systems.Hybrid, vines.Params))
    assert len(ours.sticks) == len(theirs.sticks) > 5
    for name in ("t_start", "t_release", "impacts"):
        assert ours.sticks[name][:5] == pytest.approx(theirs.sticks[name][:5], abs=1e-8)


def test_with_a_ball_of_no_mass_it_is_the_smooth_sink_and_a_tracer():
    given = {"A": 0.05, "k3": 3.0, "l2": 0.2}
    ours = vines.simulate(systems.Hybrid(mu=0.0, mu_n=0.05, **given), v2=0.3, x3=0.1, periods=40)
    smooth = vines.simulate(systems.CubicBarriers(mu=0.05, walls=False, **given), x2=0.1, v2=0.0, periods=40)
    assert len(ours.impacts) > 10
    times = np.linspace(0.0, ours.t_end, 200)
    here, there = (run.sample(times=times) for run in (ours, smooth))
    for name, other in (("x1", "x1"), ("v1", "v1"), ("x3", "x2"), ("v3", "v2")):
        assert here[name] == pytest.approx(there[other], abs=1e-12)
    # The tracer is a ball that the motion of the frame alone drives.
    for hit in ours.impacts:
        assert hit["v1_after"] == hit["v1"]
    mine, other = ours.measures(last=5), smooth.measures(last=5)
    assert mine.kinetic_ratio_mass == pytest.approx(other.kinetic_ratio, abs=1e-12)
    assert mine.viscous_loss == pytest.approx(other.viscous_loss, abs=1e-12)


def test_at_rest_in_the_middle_the_ball_is_never_hit():
    """Check value c8 as the limit of a light ball."""
    found = vines.settle(systems.Hybrid(mu=1e-12, A=0.05, mu_n=0.05, k3=3.0, l2=0.2), v2=0.0)
    assert (found.regime, found.name, found.settled) == ("no_impact", "0:0", True)
    assert found.measures.kinetic_ratio_mass == pytest.approx(0.652355764370, abs=1e-10)
    assert found.measures.max_abs_x1 == pytest.approx(0.271962210333, abs=1e-10)
    assert found.multipliers[:2] == pytest.approx([1, 1], abs=0)
    assert abs(found.multipliers[2]) < 1
    drifting = vines.settle(systems.Hybrid(mu=1e-12, A=0.01, k1=1.0, l2=0.5), v2=1e-3, settle=4, record=8, patience=0)
    assert (drifting.regime, drifting.settled) == ("unsettled", False)


def test_beside_a_ball_at_rest_tori_and_chaos_are_those_of_the_sink():
    strong = {"k1": 0.0, "k3": 3.0, "l2": 0.05, "lam": 0.01, "A": 0.02}
    slow = {"k1": 0.0, "k3": 1.0, "l2": 0.2, "lam": 0.012, "A": 0.018}
    for values, regime in ((strong, "chaotic"), (slow, "quasiperiodic")):
        p = systems.Hybrid(mu=0.02, mu_n=0.05, **values)
        found = vines.settle(p, v2=0.0, errors=False)
        alone = vines.settle(systems.CubicBarriers(mu=0.05, walls=False, **values), errors=False)
        assert (found.regime, found.settled, alone.regime) == (regime, True, regime)
        assert abs(found.lyapunov - alone.lyapunov) < 3 * (found.lyapunov_error + alone.lyapunov_error)
        # the ball keeps what it is given, and phase volumes shrink by both dampers
        assert np.sum(found.exponents == 0.0) >= 2
        assert np.all(np.diff(found.exponents) <= 0.0)
        assert found.exponents.sum() == pytest.approx(-(p.lam + (1 + p.mu_n) * p.l2), abs=1e-13)
    # of the torus they are no chance
    np.testing.assert_allclose(found.exponents[-3:], alone.exponents[-3:], rtol=1e-4)


def test_a_linear_spring_has_a_closed_form():
    p = systems.Hybrid(mu=0.02, A=0.2, Omega=1.1, mu_n=0.1, k1=0.9, l2=0.05)
    spring = np.array([p.k1, p.l2, 0, 0, -p.k1, -p.l2])
    # The forcing as two more states: sine and cosine of its phase.
    M = np.zeros((8, 8))
    M[0, 1] = M[2, 3] = M[4, 5] = 1.0
    M[1, :6] = np.array([-1, -p.lam, 0, 0, 0, 0]) - p.mu_n * spring
    M[1, 6:] = p.A, p.A * p.lam * p.Omega
    M[5, :6] = spring
    M[6, 7], M[7, 6] = p.Omega, -p.Omega
    run = vines.simulate(p, v2=0.4, periods=8)
    assert len(run.impacts) > 6
    for k, (now, then) in enumerate(pairwise(run.events)):
        if run.rows[k, MODE] != 0:
            continue
        y = [*after(now), *run.rows[k, -2:], math.sin(now["phase"]), math.cos(now["phase"])]
        end = expm(M * (then["t"] - now["t"])) @ y
        assert [*(then[name] for name in STATE[:4]), *run.rows[k + 1, -2:]] == pytest.approx(end[:6], abs=1e-12)


def test_disturbances_against_variational_dop853():
    p = drawn(1)
    begin = [0.3, -0.2, 0.1, 0.1, 0.9, 0.4]
    run = vines.simulate(p, **dict(zip(STATE, begin, strict=True)), phi=0.7, periods=0.1)
    assert len(run.impacts) == 0
    y = flown(p, 0.7, [*begin, *np.eye(6).ravel()], 0.1 * p.period).y
    assert tangent_map(run) == pytest.approx(y[6:, -1].reshape(6, 6), abs=1e-11)


def test_disturbances_through_impacts():
    p = H.replace(A=0.3)
    begin = dict(zip(STATE, (0.4, 0.1, 0.0, -0.9, 0.2, 0.3), strict=True))
    run = vines.simulate(p, **begin, phi=0.3, periods=2.2)
    assert len(run.impacts) > 3
    Y, h, columns = tangent_map(run), 1e-5, []
    for name in STATE:
        ends = [
            vines.simulate(p, **{**begin, name: begin[name] + k * h}, phi=0.3, periods=2.2).final
            for k in (-2, -1, 1, 2)
        ]
        a, b, c, d = (np.array([end[name] for name in STATE]) for end in ends)
        columns.append((a - 8 * b + 8 * c - d) / (12 * h))
    assert pytest.approx(np.column_stack(columns), abs=1e-8) == Y
    rate = p.lam + (1 + p.mu_n) * p.l2
    expected = p.r ** (2 * len(run.impacts)) * math.exp(-rate * 2.2 * p.period)
    assert np.linalg.det(Y) == pytest.approx(expected, rel=1e-11)


def test_disturbances_through_sticking():
    p = systems.Hybrid(mu=0.1, A=2.0, Omega=0.3, r=0.1, mu_n=0.05, k1=0.2, k3=0.05, l2=0.4)
    begin = dict(zip(STATE, (0.2, 0.3, 0.0, 0.1, 0.3, 0.1), strict=True))
    run = vines.simulate(p, **begin, periods=1.1)
    assert len(run.sticks) > 0
    Y, h = tangent_map(run), 1e-5
    for k, name in enumerate(STATE):
        ends = [
            np.array([vines.simulate(p, **{**begin, name: begin[name] + s * h}, periods=1.1).final[n] for n in STATE])
            for s in (-1, 1)
        ]
        assert Y[:, k] == pytest.approx((ends[1] - ends[0]) / (2 * h), abs=1e-4)


@pytest.mark.parametrize(("k1", "k3", "l2"), [(0.02, 0.05, 0.1), (-0.1, 0.02, 0.0)])
def test_it_sticks_as_long_as_the_wall_presses(k1, k3, l2):
    p = systems.Hybrid(mu=0.1, A=2.0, Omega=0.3, r=0.0, mu_n=0.3, k1=k1, k3=k3, l2=l2)
    run = vines.simulate(p, periods=12)
    assert len(run.sticks) > 10
    for stick in run.sticks[:-1]:
        times = np.linspace(stick["t_start"], stick["t_release"], 40)[1:]
        at = run.sample(times=times)
        # The balance of forces on oscillator and ball, (1 + mu) x1'' = F - lam x1' - x1 - mu_n f.
        u, rate = at["x1"] - at["x3"], at["v1"] - at["v3"]
        push = p.A * (np.sin(at["phase"]) + p.lam * p.Omega * np.cos(at["phase"])) - p.lam * at["v1"] - at["x1"]
        push -= p.mu_n * (k1 * u + k3 * u**3 + l2 * rate)
        presses = stick["side"] * push / (1 + p.mu)
        assert np.all(presses[:-1] > 0)
        assert presses[-1] == pytest.approx(0, abs=1e-11)
        assert at["w"][:-1] == pytest.approx(np.full(len(at) - 1, stick["side"]), abs=1e-14)
    assert abs(run.measures().balance) < 1e-12 * run.measures().base_work


def test_riding_against_dop853():
    """While the ball rides, frame and ball together and the mass beside them are integrated independently."""
    p = systems.Hybrid(mu=0.1, A=2.0, Omega=0.3, r=0.0, mu_n=0.3, k1=0.2, k3=0.05, l2=0.1)
    run = vines.simulate(p, periods=4)
    (k, *_), count = np.flatnonzero(run.rows[:, MODE] != 0), 0
    heavy = 1 + p.mu
    for k in np.flatnonzero(run.rows[:-1, MODE] != 0):
        now, then = run.events[k], run.events[k + 1]

        def f(t, y, phase=now["phase"]):
            u, rate = y[0] - y[2], y[1] - y[3]
            spring = p.k1 * u + p.k3 * u**3 + p.l2 * rate
            angle = phase + p.Omega * t
            force = p.A * (math.sin(angle) + p.lam * p.Omega * math.cos(angle))
            return [y[1], (force - p.lam * y[1] - y[0] - p.mu_n * spring) / heavy, y[3], spring]

        start = [now["x1"], now["v1_after"], *run.rows[k, -2:]]
        end = solve_ivp(f, (0, then["t"] - now["t"]), start, "DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
        assert [then["x1"], then["v1"], *run.rows[k + 1, -2:]] == pytest.approx(end, abs=1e-10)
        count += 1
    assert count > 3


def test_samples_keep_the_energy():
    run = vines.simulate(drawn(4), v2=0.5, x3=0.4, periods=6)
    at = run.sample(400, at_events=True)
    stored = at["kinetic_1"] + at["kinetic_2"] + at["kinetic_3"] + at["potential"]
    assert np.ptp(stored - at["base_work"] + at["damper_loss"] + at["impact_loss"]) < 1e-12
    assert np.all(np.diff(at["viscous_loss"]) >= 0)
    last = run.measures()
    assert at["viscous_loss"][-1] == pytest.approx(last.viscous_loss, rel=1e-12)
    assert np.abs(at["x1"]).max() <= last.max_abs_x1 * (1 + 1e-14)
    assert last.kinetic_ratio == pytest.approx(last.kinetic_ratio_ball + last.kinetic_ratio_mass, rel=1e-14)
    fine = run.sample(times=[last.t_max_abs_x1])
    assert abs(fine["x1"][0]) == pytest.approx(last.max_abs_x1, rel=1e-13)


def test_exponents_of_chaos_sum_to_what_dampers_and_impacts_take():
    p = H.replace(A=0.1, k3=0.3, l2=0.02)
    run = vines.simulate(p, periods=120)
    exponents, _ = lyapunov_spectrum(run, skip=20)
    late = np.count_nonzero(run.impacts["t"] > 20 * p.period) / (100 * p.period)
    rate = p.lam + (1 + p.mu_n) * p.l2
    assert exponents.sum() == pytest.approx(-rate + 2 * late * math.log(p.r), abs=2e-3)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6))
def test_no_run_loses_energy_or_passes_a_wall(seed):
    rng = np.random.default_rng(seed)
    p = systems.Hybrid(
        mu=10 ** rng.uniform(-3, 0), A=10 ** rng.uniform(-2, 0.5), Omega=10 ** rng.uniform(-0.5, 0.5),
        r=rng.choice([0.0, rng.uniform(0, 0.95)], p=[0.15, 0.85]), mu_n=rng.choice([0.0, 10 ** rng.uniform(-3, 0)]),
        k1=rng.choice([0.0, rng.uniform(0, 3)]), k3=rng.choice([0.0, 10 ** rng.uniform(-2, 1.5)]),
        l2=rng.choice([0.0, 10 ** rng.uniform(-2, 0)]),
    )  # fmt: skip
    (start,) = random_starts(p, 1, seed).tolist()
    run = vines.simulate(p, **dict(zip(STATE, start, strict=True)), periods=10)
    assert run.status == "complete"
    found = run.measures()
    scale = 1 + abs(found.base_work) + abs(found.energy_change)
    assert abs(found.balance) < 1e-12 * scale
    at = run.sample(300)
    assert np.abs(at["w"]).max() <= 1 + 1e-12
    assert np.abs(at["x1"]).max() <= found.max_abs_x1 * (1 + 1e-13)


def test_random_starts_are_those_of_the_vi_nes_with_a_mass_beside():
    ours = random_starts(H, 3, 1)
    assert ours.shape == (3, 6)
    assert np.all(np.abs(ours[:, 0] - ours[:, 2]) <= 1)
    assert np.array_equal(ours, random_starts(H, 3, 1))


def test_what_cannot_be_is_refused():
    with pytest.raises(ParameterError, match="nothing holds the mass"):
        systems.Hybrid(mu=0.02, A=0.1, mu_n=0.01, k1=-1.0)
    with pytest.raises(ParameterError, match="mu_n is -1"):
        systems.Hybrid(mu=0.02, A=0.1, mu_n=-1.0)


def test_an_orbit_and_its_branch():
    orbit = vines.find_orbit("LR", H)
    assert (orbit.symmetric, orbit.stable, orbit.admissible, orbit.residual < 1e-12) == (True,) * 4
    rate = H.lam + (1 + H.mu_n) * H.l2
    assert np.prod(orbit.multipliers).real == pytest.approx(H.r**4 * math.exp(-rate * H.period), rel=1e-11)
    assert abs(orbit.energy_imbalance) < 1e-13
    early, late = (vines.simulate(H, **orbit.start(), periods=periods).final for periods in (0.2, 1.2))
    assert [late[name] for name in STATE] == pytest.approx([early[name] for name in STATE], abs=1e-11)
    rough = np.column_stack([orbit.t, orbit.states]) + 1e-4
    assert vines.find_orbit("LR", H, guess=rough).states == pytest.approx(orbit.states, abs=1e-12)
    settled = vines.settle(H)
    assert sorted(np.abs(settled.multipliers)) == pytest.approx(sorted(np.abs(orbit.multipliers)), abs=1e-8)
    assert settled.measures.kinetic_ratio_mass == pytest.approx(orbit.measures.kinetic_ratio_mass, abs=1e-9)
    # Without the mass it is the orbit of the VI-NES.
    plain = vines.find_orbit("LR", systems.Hybrid(mu=0.01, A=0.015, k3=1.0, l2=0.2))
    other = vines.find_orbit("LR", vines.Params(mu=0.01, A=0.015))
    assert plain.states[:, :4] == pytest.approx(other.states, abs=1e-12)
    for root in other.multipliers:
        assert np.abs(plain.multipliers - root).min() < 1e-11


def test_an_orbit_closes_in_dop853():
    orbit = vines.find_orbit("LR", H, guess=ORBIT)
    begin = orbit.start()
    t, y = begin["t"], np.array([begin[name] for name in STATE])
    for gap in orbit.flight_times:
        y = flown(H, H.Omega * t, y, gap).y[:, -1]
        t += gap
        w = y[1] - y[3]
        y[1], y[3] = y[1] - H.mu * (1 + H.r) * w / (1 + H.mu), y[3] + (1 + H.r) * w / (1 + H.mu)
    assert y == pytest.approx([begin[name] for name in STATE], abs=1e-11)


def test_a_branch_loses_its_symmetry():
    orbit = vines.find_orbit("LR", H, guess=ORBIT)
    branch = vines.continue_orbit(orbit, "A", 0.038, step=0.3)
    (breaking,) = branch.bifurcations
    assert (breaking.type, branch.ends) == ("symmetry_breaking", ("range", "range"))
    pair = vines.switch_branch(breaking)
    assert [each.symmetric for each in pair] == [False, False]
    assert pair[0].states == pytest.approx(-np.roll(pair[1].states, 1, axis=0), abs=1e-11)
    heavier = vines.continue_orbit(orbit, "mu_n", 0.0102, step=0.2).orbits[-1]
    fresh = vines.find_orbit("LR", heavier.params, guess=orbit)
    assert heavier.states == pytest.approx(fresh.states, abs=1e-11)


def test_what_is_too_fast_to_follow_ends_with_a_status():
    wild = vines.simulate(systems.Hybrid(mu=0.5, A=1e4, mu_n=0.5, k3=1e4), x3=1e6, periods=1)
    assert wild.status == "step_limit"
    assert wild.measures().duration < wild.params.period
    stiff = vines.simulate(systems.Hybrid(mu=0.5, A=0.1, mu_n=0.5, k1=1e3, k3=1e3, l2=20.0), x3=0.5, periods=2)
    assert stiff.status == "complete"
    assert abs(stiff.measures().balance) < 1e-11
