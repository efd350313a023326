"""A ball in a Duffing oscillator against DOP853, the VI-NES as its limit, and balances."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import vines
from vines import systems
from vines.dynamics import ball_locked, decay, no_ball, tangent_map
from vines.dynamics._advance import MODE
from vines.dynamics._simulate import record
from vines.dynamics.duffing import duffing_constants
from vines.dynamics.kernels import constants, room_of
from vines.errors import OrbitNotFound, ParameterError
from vines.orbits import follow_curve

P = systems.Duffing(mu=0.02, A=0.05, Omega=1.1, alpha=2.0)
HEAVY = systems.Duffing(mu=0.1, A=2.0, Omega=0.3, r=0.0, alpha=0.1)
"""Sticks at half of its impacts, without a chatter before, whose last hops double precision does not resolve."""

STATE = ("x1", "v1", "x2", "v2")
TIGHT = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}


def force(p, angle):
    return p.A * (math.sin(angle) + p.lam * p.Omega * math.cos(angle))


def rates(p, phase):
    """Return the equations of flight in (x1, v1, x2, v2), and in the columns of disturbances behind them."""

    def f(t, y):
        x1, v1, _, v2 = y[:4]
        first = [v1, force(p, phase + p.Omega * t) - p.lam * v1 - x1 - p.alpha * x1**3, v2, 0.0]
        if len(y) == 4:
            return first
        J = np.array([[0, 1, 0, 0], [-1 - 3 * p.alpha * x1**2, -p.lam, 0, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
        return [*first, *(J @ np.reshape(y[4:], (4, -1))).ravel()]

    return f


def flown_frame(p, phase, mass=1.0):
    """Return the equation of the frame, which has the mass 1 + mu while it carries the ball."""
    drive, damping, Omega, lam, alpha = p.A, p.lam * p.Omega, p.Omega, p.lam, p.alpha

    def f(t, y):
        x, v = y
        angle = phase + Omega * t
        push = drive * (math.sin(angle) + damping * math.cos(angle)) - lam * v - x - alpha * x**3
        return v, push / mass

    return f


def ends(event: Any) -> Any:
    """Return an event that ends an integration where it rises through 0."""
    event.terminal, event.direction = True, 1.0
    return event


def struck(p, y):
    """Return a state after an impact."""
    x1, v1, x2, v2 = y
    kick = -p.mu * (1 + p.r) * (v1 - v2) / (1 + p.mu)
    return np.array([x1, v1 + kick, x2, v1 + kick + p.r * (v1 - v2)])


def test_sixty_impacts_against_dop853_with_events():
    orbit = vines.find_orbit("LR", P)
    assert orbit.stable
    run = vines.simulate(P, **orbit.start(), periods=31)
    begin = run.events[0]
    t, y = begin["t"], np.array([begin[name] for name in STATE])
    for hit in run.impacts[:60]:
        x2, v2 = y[2:]
        frame = flown_frame(P, P.Omega * t)
        # What has just been struck is on its wall and leaves it: only a wall that is met from inside counts.
        walls = [ends(lambda s, z, side=side, x2=x2, v2=v2: side * (z[0] - x2 - v2 * s) - 1) for side in (1, -1)]
        out = solve_ivp(frame, (0, 9), y[:2], events=walls, **TIGHT)
        s = out.t[-1]
        t, y = t + s, np.array([*out.y[:, -1], x2 + v2 * s, v2])
        assert (t, *y) == pytest.approx([hit[name] for name in ("t", *STATE)], abs=1e-10)
        y = struck(P, y)


@pytest.mark.parametrize("seed", range(2))
def test_every_flight_against_dop853(seed):
    rng = np.random.default_rng(seed)
    p = systems.Duffing(
        mu=rng.uniform(0.01, 0.3), A=rng.uniform(0.05, 1), Omega=rng.uniform(0.5, 2), r=rng.uniform(0, 0.9),
        alpha=rng.uniform(0.2, 3),
    )  # fmt: skip
    run = vines.simulate(p, phi=rng.uniform(0, 6), periods=12)
    rows, seen = run.events, 0
    for now, after, mode in zip(rows[:-1], rows[1:], run.rows[:-1, MODE], strict=True):
        tau = after["t"] - now["t"]
        if mode != 0 or tau < 1e-3:
            continue
        begin = [now["x1"], now["v1_after"], now["x2"], now["v2_after"]]
        y = solve_ivp(rates(p, now["phase"]), (0, tau), begin, max_step=0.1, **TIGHT).y
        gaps = y[0] - y[2]
        assert np.abs(gaps[1:-1]).max(initial=0.0) < 1
        assert [after[name] for name in STATE] == pytest.approx(y[:, -1], abs=1e-12)
        if after["kind"] == 1:
            assert abs(gaps[-1]) == pytest.approx(1, abs=1e-12)
        seen += 1
    assert seen >= 12


def test_a_ride_and_its_release_against_dop853():
    run = vines.simulate(HEAVY, periods=6)
    seen = 0
    for now, after in pairwise(run.events):
        tau = after["t"] - now["t"]
        if now["kind"] != 2 or after["kind"] != 3 or tau < 1e-3:
            continue
        carrier = flown_frame(HEAVY, now["phase"], 1 + HEAVY.mu)
        lost = ends(lambda t, y, side=now["side"], of=carrier: -side * of(t, y)[1])
        begin = [now["x1"], now["v1_after"]]
        out = solve_ivp(carrier, (0, 9), begin, events=lost, max_step=0.05, **TIGHT)
        # The push falls slowly through 0, so that its root is where rounding leaves it.
        assert tau == pytest.approx(out.t[-1], abs=1e-11)
        assert (after["x1"], after["v1"]) == pytest.approx(out.y[:, -1], abs=1e-11)
        middle = run.sample(times=np.linspace(now["t"], after["t"], 30)[1:-1])
        assert middle["w"] == pytest.approx(now["side"], abs=1e-14)
        seen += 1
    assert seen > 10


def test_a_run_does_not_depend_on_how_it_was_cut():
    room, c = room_of(HEAVY), constants(HEAVY)
    layout, found = room.layout(HEAVY), []
    for stops in ([60.0], [*np.arange(0.37, 60.0, 0.37), 60.0]):
        state = np.zeros(layout.state)
        room.begin(c, state, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0)
        found.append(record(c, state, stops, 1000, 256)[0])
    whole, cut = (rows[(rows[:, 0] > 0) & (rows[:, 0] < 4)] for rows in found)
    assert np.array_equal(whole, cut)
    assert np.count_nonzero(whole[:, 0] == 3) > 4


def test_twice_the_order_gives_the_same_run():
    room, rows = room_of(HEAVY), []
    for order in (20, 40):
        c = duffing_constants(*HEAVY.as_dict().values(), order=order)
        state = np.zeros(room.layout(HEAVY).state)
        room.begin(c, state, 0.1, 0.0, 0.0, 0.4, 0.0, 0.0)
        rows.append(record(c, state, [5 * HEAVY.period], 1000, 256)[0])
    usual, sceptic = rows
    assert np.count_nonzero(usual[:, 0] == 3) > 10
    assert usual == pytest.approx(sceptic, abs=1e-11)


@pytest.mark.parametrize("alpha", [0.0, 1e-14])
def test_without_its_spring_it_is_the_vi_nes(alpha):
    given = {"mu": 0.01, "A": 0.015}
    ours, theirs = (vines.find_orbit("LR", p) for p in (systems.Duffing(**given, alpha=alpha), vines.Params(**given)))
    assert ours.states == pytest.approx(theirs.states, abs=1e-12)
    assert ours.multipliers == pytest.approx(theirs.multipliers, abs=1e-12)
    for name in ("kinetic_ratio", "max_abs_x1", "base_work", "damper_loss", "impact_loss"):
        assert getattr(ours.measures, name) == pytest.approx(getattr(theirs.measures, name), abs=1e-12)
    for of in (no_ball, ball_locked):
        assert of(ours.params) == pytest.approx(of(theirs.params), abs=1e-12)
    given = {"mu": 0.1, "A": 2.0, "Omega": 0.3, "r": 0.0}
    ours, theirs = (vines.simulate(p, periods=1.5) for p in (HEAVY.replace(alpha=alpha), vines.Params(**given)))
    assert len(ours.sticks) == len(theirs.sticks) > 2
    for name in ("t_start", "t_release", "impacts"):
        assert ours.sticks[name] == pytest.approx(theirs.sticks[name], rel=1e-12, nan_ok=True)
    assert ours.impacts["t"] == pytest.approx(theirs.impacts["t"], rel=1e-12)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_no_run_loses_energy_or_passes_a_wall(seed):
    rng = np.random.default_rng(seed)
    p = systems.Duffing(
        mu=10 ** rng.uniform(-3, 0), A=10 ** rng.uniform(-2, 0.5), Omega=10 ** rng.uniform(-0.5, 0.5),
        r=rng.choice([0.0, rng.uniform(0, 0.95)], p=[0.2, 0.8]), alpha=10 ** rng.uniform(-2, 1.5),
    )  # fmt: skip
    x1 = rng.uniform(-1, 1)
    run = vines.simulate(p, x1=x1, x2=x1 - rng.uniform(-1, 1), v2=rng.uniform(-1, 1), phi=1.0, periods=12)
    assert run.status == "complete"
    found = run.measures()
    assert abs(found.balance) < 1e-12 * (1 + abs(found.base_work))
    at = run.sample(400)
    assert np.abs(at["w"]).max() <= 1 + 1e-13
    assert np.abs(at["x1"]).max() <= found.max_abs_x1 * (1 + 1e-13)
    # A stopped contact pushes.
    push = room_of(p).push(p, at["x1"], at["v1"], at["phase"])
    assert np.all((at["stuck"] * push)[at["stuck"] != 0] > -1e-9)


def test_samples_keep_the_energy():
    at = vines.simulate(HEAVY, periods=5).sample(400, at_events=True)
    assert set(at["stuck"]) == {-1, 0, 1}
    stored = at["kinetic_1"] + at["kinetic_2"] + at["potential"]
    assert np.ptp(stored - at["base_work"] + at["damper_loss"] + at["impact_loss"]) < 1e-12
    spring = at["potential"] - (at["x1"] - at["base"]) ** 2 / 2
    assert spring == pytest.approx(HEAVY.alpha * at["x1"] ** 4 / 4, abs=1e-13)


def test_a_transient_counts_what_the_cubic_spring_holds():
    found = decay(vines.simulate(systems.Duffing(mu=0.05, A=0.0, alpha=3.0), v1=2.0, v2=0.0, periods=15))
    assert 0.1 < found.impact_share < 1
    assert found.impact_share + found.damper_share + found.frame_share + found.ball_share == pytest.approx(1, abs=1e-12)


def test_disturbances_against_variational_dop853():
    p, begin = P.replace(A=0.4), [0.3, -0.2, 0.2, 0.05]
    run = vines.simulate(p, **dict(zip(STATE, begin, strict=True)), phi=0.7, periods=0.4)
    assert len(run.impacts) == 0
    y = solve_ivp(rates(p, 0.7), (0, 0.4 * p.period), [*begin, *np.eye(4).ravel()], **TIGHT).y
    assert tangent_map(run) == pytest.approx(y[4:, -1].reshape(4, 4), abs=1e-11)


def test_disturbances_through_impacts_and_rides():
    """A ride forgets the ball, so that only the frame's differences tell; impacts keep the determinant."""
    p = P.replace(A=0.4)
    begin = dict(zip(STATE, (0.4, 0.1, 0.0, -0.9), strict=True))
    run = vines.simulate(p, **begin, phi=0.3, periods=2.2)
    assert len(run.impacts) > 3
    assert differences(p, begin, 2.2) == pytest.approx(tangent_map(run), abs=1e-8)
    expected = p.r ** (2 * len(run.impacts)) * math.exp(-p.lam * 2.2 * p.period)
    assert np.linalg.det(tangent_map(run)) == pytest.approx(expected, rel=1e-11)
    begin = dict(zip(STATE, (-0.4, 0.9, 0.5, 0.9), strict=True))
    run = vines.simulate(HEAVY, **begin, phi=0.3, periods=0.6)
    assert len(run.sticks) > 0
    assert run.sticks["t_release"][0] < run.t_end
    assert differences(HEAVY, begin, 0.6)[:, :2] == pytest.approx(tangent_map(run)[:, :2], abs=1e-6)


def differences(p, begin, periods):
    """Return the tangent map by central differences of fourth order."""
    h, columns = 1e-5, []
    for name in STATE:
        ends = [
            vines.simulate(p, **{**begin, name: begin[name] + k * h}, phi=0.3, periods=periods).final
            for k in (-2, -1, 1, 2)
        ]
        a, b, c, d = (np.array([end[name] for name in STATE]) for end in ends)
        columns.append((a - 8 * b + 8 * c - d) / (12 * h))
    return np.column_stack(columns)


def half_map(orbit):
    """Return by DOP853 how far half a period of a symmetric orbit ends from its mirror image, and its tangent map."""
    p, half = orbit.params, orbit.period / 2
    assert len(orbit.t) == 2
    (t, after), before = orbit.t, np.array(orbit.states[0])
    behind = struck(p, before)
    y = solve_ivp(rates(p, p.Omega * t), (0, after - t), [*behind, *np.eye(4).ravel()], **TIGHT).y[:, -1]
    # The impact, as a map of disturbances at fixed time (saltation).
    f_before, f_behind = (np.array(rates(p, p.Omega * t)(0.0, each)) for each in (before, behind))
    side = orbit.side[0]
    gap = np.array([side, 0.0, -side, 0.0])
    a = (1 + p.r) / (1 + p.mu)
    law = np.array([[1, 0, 0, 0], [0, 1 - p.mu * a, 0, p.mu * a], [0, 0, 1, 0], [0, a, 0, 1 - a]])
    jump = law + np.outer(f_behind - law @ f_before, gap) / (gap @ f_before)
    assert after - t == pytest.approx(half, abs=1e-9)
    return y[:4] + before, y[4:].reshape(4, 4) @ jump


@pytest.mark.parametrize(
    ("kind", "to", "value", "root"), [("symmetry_breaking", 0.2, 0.142645, 1.0), ("fold", 0.01, 0.017727, -1.0)]
)
def test_bifurcations_are_those_of_dop853(kind, to, value, root):
    """Half a period ends on the mirror image, and has the eigenvalue 1 where symmetry breaks, -1 at a fold."""
    branch = vines.continue_orbit(vines.find_orbit("LR", P), "A", to, step=0.1)
    found = next(each for each in branch.bifurcations if each.type == kind)
    assert found.value == pytest.approx(value, abs=1e-6)
    assert found.orbit.symmetric
    off, M = half_map(found.orbit)
    assert np.abs(off).max() < 1e-11
    assert np.abs(np.linalg.eigvals(M) - root).min() < 1e-7
    if kind == "symmetry_breaking":
        pair = vines.switch_branch(found)
        assert [each.symmetric for each in pair] == [False, False]
        assert pair[0].states == pytest.approx(-np.roll(pair[1].states, 1, axis=0), abs=1e-10)


def test_orbits_are_looked_for_on_the_large_response_too():
    """None of the runs that start at rest comes near these two, mirror images of each other."""
    found = vines.all_orbits("LR", P.replace(Omega=1.3))
    large = [orbit for orbit in found if orbit.stable and orbit.admissible and not orbit.symmetric]
    assert [orbit.measures.max_abs_x1 for orbit in large] == [pytest.approx(0.7445, abs=1e-3)] * 2


@pytest.mark.full
def test_a_fold_followed_in_two_parameters_is_one_of_dop853():
    branch = vines.continue_orbit(vines.find_orbit("LR", P), "A", 0.01, step=0.1)
    fold = next(each for each in branch.bifurcations if each.type == "fold")
    for last in follow_curve(fold, ("A", "alpha"), box={"A": (0.01, 0.03), "alpha": (1.9, 2.1)}).orbits[-2:]:
        assert last.params.alpha != P.alpha
        off, M = half_map(last)
        assert np.abs(off).max() < 1e-11
        assert np.abs(np.linalg.eigvals(M) + 1).min() < 1e-6


def test_an_orbit_repeats():
    orbit = vines.find_orbit("LR", P)
    assert (orbit.symmetric, orbit.stable, orbit.admissible, orbit.residual < 1e-13) == (True,) * 4
    assert np.prod(orbit.multipliers).real == pytest.approx(P.r**4 * math.exp(-P.lam * P.period), rel=1e-12)
    assert abs(orbit.energy_imbalance) < 1e-13
    early, late = (vines.simulate(P, **orbit.start(), periods=periods).final for periods in (0.2, 1.2))
    assert [late[name] for name in STATE] == pytest.approx([early[name] for name in STATE], abs=1e-12)
    settled = vines.settle(P)
    assert sorted(np.abs(settled.multipliers)) == pytest.approx(sorted(np.abs(orbit.multipliers)), abs=1e-8)
    assert settled.measures.max_abs_x1 == pytest.approx(orbit.measures.max_abs_x1, abs=1e-9)


@pytest.mark.parametrize("Omega", [1.6])
def test_the_largest_response_without_a_ball_is_what_dop853_comes_to(Omega):
    p = systems.Duffing(mu=0.5, A=0.5, Omega=Omega, alpha=0.5, lam=0.5)
    for mass, largest in ((1.0, no_ball(p)), (1.5, ball_locked(p))):
        begin, end = 24 * p.period, 25 * p.period
        turns = lambda t, y: y[1]  # noqa: E731
        out = solve_ivp(flown_frame(p, 0.0, mass), (0, end), [0.0, 2.0], "DOP853", rtol=1e-10, atol=1e-12, events=turns)
        found = np.abs(out.y_events[0][out.t_events[0] > begin, 0]).max()
        assert largest == pytest.approx(found, abs=1e-5)


def test_the_frame_alone_may_answer_in_two_ways():
    """A ball at rest in the middle is not struck, and the frame keeps to the response that it starts near."""
    p = systems.Duffing(mu=0.02, A=0.02, Omega=1.1, alpha=0.5)
    small, large = (vines.settle(p, x1=x1, v1=v1, x2=0.0, v2=0.0, settle=600) for x1, v1 in ((0.0, 0.0), (-0.4, 0.75)))
    assert [each.name for each in (small, large)] == ["0:0", "0:0"]
    assert large.measures.max_abs_x1 == pytest.approx(no_ball(p), rel=1e-9)
    assert small.measures.max_abs_x1 < 0.3 * large.measures.max_abs_x1
    assert list(small.exponents[:2]) == [0.0, 0.0]
    assert vines.settle(p, settle=100, watch=16, x1=0.0, x2=0.0, v2=1e-5).regime == "unsettled"


def test_a_frame_that_never_repeats_is_chaotic_though_its_ball_is_not_hit():
    p = systems.Duffing(mu=0.02, A=2.0, lam=0.1, alpha=400.0)
    found = vines.settle(p, v2=0.0, errors=False)
    assert (found.regime, found.settled) == ("chaotic", True)
    assert found.lyapunov > 5 * found.lyapunov_error
    np.testing.assert_array_equal(found.exponents[1:3], 0.0)
    assert found.exponents.sum() == pytest.approx(-p.lam, abs=1e-13)


def test_orbits_without_damping_at_resonance():
    # The VI-NES has no steady response there; the cubic spring, or a mass beside with a damper, gives one.
    for p in (P.replace(Omega=1.0, lam=0.0), systems.Hybrid(mu=0.01, A=0.03, mu_n=0.01, k3=1.0, l2=0.2, lam=0.0)):
        found, run = vines.find_orbit("LR", p), vines.settle(p, errors=False)
        assert (found.symmetric, found.stable, run.name) == (True, True, "1:1")
        assert vines.find_orbit("LR", p, guess=found).multipliers == pytest.approx(found.multipliers, abs=1e-9)
        assert max(abs(found.multipliers)) == pytest.approx(max(abs(run.multipliers)), abs=1e-6)


def test_what_cannot_be_is_refused():
    with pytest.raises(ParameterError, match=r"alpha is -0\.1, allowed is .*: nothing holds a softening oscillator"):
        systems.Duffing(mu=0.02, A=0.03, alpha=-0.1)
    with pytest.raises(ParameterError, match="give an orbit at nearby parameters"):
        vines.find_orbit("LR", P, guess=[0.1, 3.0])
    with pytest.raises(OrbitNotFound):
        vines.find_orbit("LR", P.replace(A=0.001))
    assert constants(P).field.order == 20


def test_what_is_too_fast_to_follow_ends_with_a_status():
    run = vines.simulate(P.replace(alpha=1e4), x1=1e6, x2=1e6, periods=1)
    assert run.status in ("step_limit", "event_cap")
