"""A mass on a cubic spring in barriers against DOP853, closed forms of its limits, and balances."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import vines
from vines import systems
from vines.dynamics import lyapunov_spectrum, tangent_map
from vines.dynamics._advance import MODE
from vines.dynamics._simulate import record
from vines.dynamics.kernels import constants, room_of
from vines.dynamics.taylor import taylor_constants
from vines.errors import OrbitNotFound, ParameterError

C3 = systems.CubicBarriers(mu=0.02, A=0.03, k3=1.0, l2=0.2)
STATE = ("x1", "v1", "x2", "v2")


def drawn(seed: int, **given: float) -> systems.CubicBarriers:
    """Return parameters at random: springs soft, stiff and with two wells."""
    rng = np.random.default_rng(seed)
    free = {
        "mu": rng.uniform(0.005, 0.3), "A": rng.uniform(0.01, 0.6), "Omega": rng.uniform(0.5, 2.0),
        "r": rng.uniform(0.0, 0.95), "k1": rng.uniform(-0.5, 2.0), "k3": rng.uniform(0.0, 5.0),
        "l2": rng.uniform(0.0, 0.3),
    }  # fmt: skip
    return systems.CubicBarriers(**(free | given))


def rates(p, phase):
    """Return the equations of flight in (x1, v1, x2, v2) from a phase on."""

    def f(t, y):
        x1, v1, x2, v2 = y[:4]
        angle = phase + p.Omega * t
        w, u = x1 - x2, v1 - v2
        spring = p.k1 * w + p.k3 * w**3 + p.l2 * u
        force = p.A * (math.sin(angle) + p.lam * p.Omega * math.cos(angle))
        first = [v1, force - p.lam * v1 - x1 - p.mu * spring, v2, spring]
        if len(y) == 4:
            return first
        k = p.k1 + 3 * p.k3 * w * w
        a = np.array([k, p.l2, -k, -p.l2])
        J = np.array([[0, 1, 0, 0], [-1, -p.lam, 0, 0] - p.mu * a, [0, 0, 0, 1], a])
        return [*first, *(J @ np.reshape(y[4:], (4, 4))).ravel()]

    return f


def flown(p, phase, y, tau):
    return solve_ivp(rates(p, phase), (0, tau), y, "DOP853", rtol=1e-13, atol=1e-15, max_step=0.05).y


@pytest.mark.parametrize("seed", range(6))
def test_every_flight_against_dop853(seed):
    p = drawn(seed)
    rng = np.random.default_rng(100 + seed)
    run = vines.simulate(p, x1=0.3, v2=rng.uniform(-1, 1), x2=rng.uniform(-0.5, 1.2), phi=rng.uniform(0, 6), periods=3)
    rows = run.events
    seen = 0
    for now, after, mode in zip(rows[:-1], rows[1:], run.rows[:-1, MODE], strict=True):
        tau = after["t"] - now["t"]
        if mode != 0 or tau < 1e-3:
            continue
        y = flown(p, now["phase"], [now["x1"], now["v1_after"], now["x2"], now["v2_after"]], tau)
        gaps = y[0] - y[2]
        assert np.abs(gaps[1:-1]).max(initial=0.0) < 1
        assert [after[name] for name in STATE] == pytest.approx(y[:, -1], abs=3e-11)
        if after["kind"] == 1:
            assert abs(gaps[-1]) == pytest.approx(1, abs=3e-11)
            assert after["v1_after"] - after["v2_after"] == pytest.approx(-p.r * (y[1, -1] - y[3, -1]), abs=3e-11)
        seen += 1
    assert seen >= 3
    assert abs(run.measures().balance) < 1e-12 * (1 + run.measures().base_work)


def test_twice_the_order_gives_the_same_run():
    p = drawn(3, r=0.8, A=0.5)
    values = list(p.as_dict().values())
    room = room_of(p)
    layout = room.layout(p)
    rows = []
    for order in (20, 40):
        c = taylor_constants(*values, order=order)
        state = np.zeros(layout.state)
        room.begin(c, state, 0.1, 0.0, 0.0, 0.4, 0.0, 0.0)
        rows.append(record(c, state, [20 * p.period], 1000, 256)[0])
    usual, sceptic = rows
    assert len(usual) > 20
    assert usual[:, :4] == pytest.approx(sceptic[:, :4], abs=1e-11)
    assert usual == pytest.approx(sceptic, abs=1e-10)


def test_without_spring_it_is_the_vi_nes():
    given = {"mu": 0.01, "A": 0.015}
    ours, theirs = (vines.simulate(p(**given), periods=150) for p in (systems.CubicBarriers, vines.Params))
    assert ours.impacts["t"] == pytest.approx(theirs.impacts["t"], abs=1e-11)
    ours, theirs = (vines.find_orbit("LR", p(**given)) for p in (systems.CubicBarriers, vines.Params))
    assert ours.states == pytest.approx(theirs.states, abs=1e-12)
    assert ours.multipliers == pytest.approx(theirs.multipliers, abs=1e-12)
    for name in ("kinetic_ratio", "max_abs_x1", "base_work", "damper_loss", "impact_loss"):
        assert getattr(ours.measures, name) == pytest.approx(getattr(theirs.measures, name), abs=1e-12)
    assert ours.min_clearance == theirs.min_clearance == 2


def test_without_spring_it_sticks_as_the_vi_nes_does():
    given = {"mu": 0.05, "A": 2.0, "Omega": 0.3, "r": 0.3}
    ours, theirs = (vines.simulate(p(**given), periods=12) for p in (systems.CubicBarriers, vines.Params))
    assert len(ours.sticks) == len(theirs.sticks) > 5
    for name in ("t_start", "t_release", "impacts"):
        assert ours.sticks[name][:5] == pytest.approx(theirs.sticks[name][:5], abs=1e-8)


def test_barriers_that_are_not_reached_change_nothing():
    given = {"mu": 0.05, "A": 0.05, "k3": 3.0, "l2": 0.2}
    within, without = (systems.CubicBarriers(**given, walls=walls) for walls in (True, False))
    first, second = (vines.simulate(p, periods=50) for p in (within, without))
    assert np.array_equal(first.rows, second.rows)
    found = [vines.settle(p) for p in (within, without)]
    assert [each.name for each in found] == ["0:0", "0:0"]
    assert all(each.settled and each.regime == "no_impact" for each in found)
    assert found[0].measures == found[1].measures
    far = vines.simulate(without, x2=-3.0, periods=2)
    assert np.abs(far.sample(50)["w"]).max() > 1


def test_a_linear_spring_has_a_closed_form():
    p = systems.CubicBarriers(mu=0.1, A=0.2, Omega=1.1, k1=0.9, l2=0.05)
    J = np.array(rates_of(p))
    # The forcing as two more states: sine and cosine of its phase.
    M = np.zeros((6, 6))
    M[:4, :4] = J
    M[1, 4:] = p.A, p.A * p.lam * p.Omega
    M[4, 5], M[5, 4] = p.Omega, -p.Omega
    rows = vines.simulate(p, v2=0.4, periods=8).events
    assert np.count_nonzero(rows["kind"] == 1) > 6
    for now, after in pairwise(rows):
        if now["kind"] == 2:
            continue
        y = [now["x1"], now["v1_after"], now["x2"], now["v2_after"], math.sin(now["phase"]), math.cos(now["phase"])]
        assert [after[name] for name in STATE] == pytest.approx((expm(M * (after["t"] - now["t"])) @ y)[:4], abs=1e-12)
    free = p.replace(walls=False)
    found = vines.settle(free, settle=600)
    answer = np.linalg.solve(1j * p.Omega * np.eye(4) - J, [0, p.A * (p.lam * p.Omega - 1j), 0, 0])
    assert found.measures.max_abs_x1 == pytest.approx(abs(answer[0]), rel=1e-9)
    roots = sorted(np.exp(np.linalg.eigvals(J) * p.period), key=abs)
    assert sorted(np.abs(found.multipliers)) == pytest.approx(np.abs(roots), rel=1e-11)


def rates_of(p):
    """Return the matrix of the linear flight in (x1, v1, x2, v2)."""
    spring = np.array([p.k1, p.l2, -p.k1, -p.l2])
    return [[0, 1, 0, 0], np.array([-1, -p.lam, 0, 0]) - p.mu * spring, [0, 0, 0, 1], spring]


def test_disturbances_against_variational_dop853():
    p = drawn(1, walls=0.0)
    begin = [0.3, -0.2, 0.9, 0.4]
    run = vines.simulate(p, **dict(zip(STATE, begin, strict=True)), phi=0.7, periods=1.5)
    y = flown(p, 0.7, [*begin, *np.eye(4).ravel()], 1.5 * p.period)
    assert tangent_map(run) == pytest.approx(y[4:, -1].reshape(4, 4), abs=1e-10)


def test_disturbances_through_impacts():
    p = C3.replace(A=0.3)
    begin = dict(zip(STATE, (0.4, 0.1, 0.0, -0.9), strict=True))
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
    assert pytest.approx(np.column_stack(columns), abs=1e-9) == Y
    rate = p.lam + (1 + p.mu) * p.l2
    expected = p.r ** (2 * len(run.impacts)) * math.exp(-rate * 2.2 * p.period)
    assert np.linalg.det(Y) == pytest.approx(expected, rel=1e-12)


def test_exponents_of_chaos_sum_to_what_dampers_and_impacts_take():
    p = systems.CubicBarriers(mu=0.02, A=0.06, k3=0.3, l2=0.02)
    run = vines.simulate(p, periods=150)
    exponents, _ = lyapunov_spectrum(run, skip=20)
    late = np.count_nonzero(run.impacts["t"] > 20 * p.period) / (130 * p.period)
    assert exponents[0] > 0.05
    assert exponents.sum() == pytest.approx(-p.lam - (1 + p.mu) * p.l2 + 2 * late * math.log(p.r), abs=1e-3)


@pytest.mark.parametrize(("k1", "k3"), [(0.02, 0.05), (-0.1, 0.02)])
def test_it_sticks_until_the_spring_pulls_it_off(k1, k3):
    """While it sticks the barrier presses with side x1'' - k1 - k3; it lets go where that vanishes, falling."""
    p = systems.CubicBarriers(mu=0.1, A=2.0, Omega=0.3, r=0.0, k1=k1, k3=k3, l2=0.1)
    run = vines.simulate(p, periods=12)
    assert len(run.sticks) > 10
    for stick in run.sticks[:-1]:
        times = np.linspace(stick["t_start"], stick["t_release"], 40)[1:]
        at = run.sample(times=times)
        # The balance of forces on both, x1'' (1 + mu) = F - lam x1' - x1.
        push = p.A * (np.sin(at["phase"]) + p.lam * p.Omega * np.cos(at["phase"])) - p.lam * at["v1"] - at["x1"]
        presses = stick["side"] * push / (1 + p.mu) - k1 - k3
        assert np.all(presses[:-1] > 0)
        assert presses[-1] == pytest.approx(0, abs=1e-11)
        assert np.all(at["w"][:-1] == pytest.approx(stick["side"], abs=1e-14))
    assert abs(run.measures().balance) < 1e-13 * run.measures().base_work


def test_samples_keep_the_energy():
    run = vines.simulate(drawn(4), v2=0.5, periods=6)
    at = run.sample(400, at_events=True)
    stored = at["kinetic_1"] + at["kinetic_2"] + at["potential"]
    assert np.ptp(stored - at["base_work"] + at["damper_loss"] + at["impact_loss"]) < 1e-12
    assert np.all(np.diff(at["viscous_loss"]) >= 0)
    last = run.measures()
    assert at["viscous_loss"][-1] == pytest.approx(last.viscous_loss, rel=1e-12)
    assert np.abs(at["x1"]).max() <= last.max_abs_x1 * (1 + 1e-14)
    fine = run.sample(times=[last.t_max_abs_x1])
    assert abs(fine["x1"][0]) == pytest.approx(last.max_abs_x1, rel=1e-13)
    cut = vines.simulate(run.params, v2=0.5, periods=2.3)
    assert run.sample(times=[cut.t_end])["v2"][0] == pytest.approx(cut.final["v2"], abs=1e-11)


def test_an_orbit_and_its_branch():
    p = C3.replace(l2=0.1)
    orbit = vines.find_orbit("LR", p)
    assert (orbit.symmetric, orbit.stable, orbit.admissible, orbit.residual < 1e-13) == (True,) * 4
    rate = p.lam + (1 + p.mu) * p.l2
    assert np.prod(orbit.multipliers).real == pytest.approx(p.r**4 * math.exp(-rate * p.period), rel=1e-12)
    assert abs(orbit.energy_imbalance) < 1e-13
    early, late = (vines.simulate(p, **orbit.start(), periods=periods).final for periods in (0.2, 1.2))
    assert [late[name] for name in STATE] == pytest.approx([early[name] for name in STATE], abs=1e-12)
    rough = np.column_stack([orbit.t, orbit.states]) + 1e-4
    assert vines.find_orbit("LR", p, guess=rough).states == pytest.approx(orbit.states, abs=1e-13)
    settled = vines.settle(p)
    assert sorted(np.abs(settled.multipliers)) == pytest.approx(sorted(np.abs(orbit.multipliers)), abs=1e-8)
    assert settled.measures.kinetic_ratio == pytest.approx(orbit.measures.kinetic_ratio, abs=1e-9)
    branch = vines.continue_orbit(orbit, "A", 0.036, step=0.1)
    breaking = branch.bifurcations[0]
    assert (breaking.type, round(breaking.value, 9)) == ("symmetry_breaking", 0.033972732)
    pair = vines.switch_branch(breaking)
    assert [each.symmetric for each in pair] == [False, False]
    assert pair[0].states == pytest.approx(-np.roll(pair[1].states, 1, axis=0), abs=1e-11)
    stiffer = vines.continue_orbit(orbit, "k3", 1.1, step=0.3).orbits[-1]
    fresh = vines.find_orbit("LR", stiffer.params, guess=orbit)
    assert stiffer.states == pytest.approx(fresh.states, abs=1e-12)


def test_the_end_of_a_branch_grazes():
    branch = vines.continue_orbit(vines.find_orbit("LR", C3.replace(l2=0.1)), "A", 0.01, step=0.2)
    assert branch.ends[1] == "grazing"
    assert [each.type for each in branch.bifurcations] == ["neimark_sacker", "grazing"]
    last = branch.bifurcations[-1].orbit
    assert min(last.min_clearance, *np.abs(last.w_dot)) == pytest.approx(0, abs=1e-12)


def test_what_cannot_be_is_refused():
    with pytest.raises(ParameterError, match=r"walls is 0\.5, allowed are 1 and 0"):
        systems.CubicBarriers(mu=0.02, A=0.03, walls=0.5)
    with pytest.raises(ParameterError, match="k3 is -1"):
        systems.CubicBarriers(mu=0.02, A=0.03, k3=-1.0)
    with pytest.raises(ParameterError, match="walls is 0: a word tells of impacts"):
        vines.find_orbit("LR", C3.replace(walls=False))
    with pytest.raises(ParameterError, match="give an orbit at nearby parameters"):
        vines.find_orbit("LR", C3, guess=[0.1, 3.0])
    with pytest.raises(OrbitNotFound):
        vines.find_orbit("LR", C3.replace(A=0.001))
    assert constants(C3).field.order == 20


def test_what_is_too_fast_to_follow_ends_with_a_status():
    p = systems.CubicBarriers(mu=0.5, A=1e4, k3=1e4, walls=False)
    run = vines.simulate(p, x2=1e6, periods=1)
    assert run.status == "step_limit"
    stiff = vines.simulate(systems.CubicBarriers(mu=0.5, A=0.1, k1=1e3, k3=1e3, l2=20.0), periods=2)
    assert stiff.status == "complete"
    assert abs(stiff.measures().balance) < 1e-11
    with pytest.raises(ParameterError, match="nothing holds it"):
        systems.CubicBarriers(mu=0.02, A=0.1, k1=-1.0, walls=False)


@pytest.mark.parametrize("block", range(3))
def test_no_run_loses_energy_or_passes_a_barrier(block):
    rng = np.random.default_rng(block)
    hits = sticks = 0
    for _ in range(60):
        p = systems.CubicBarriers(
            mu=10 ** rng.uniform(-3, 0), A=10 ** rng.uniform(-2, 0.5), Omega=10 ** rng.uniform(-0.5, 0.5),
            r=rng.choice([0.0, rng.uniform(0, 0.95)], p=[0.15, 0.85]), k1=rng.choice([0.0, rng.uniform(-1, 3)]),
            k3=rng.choice([0.0, 10 ** rng.uniform(-2, 1.5)]), l2=rng.choice([0.0, 10 ** rng.uniform(-2, 0)]),
        )  # fmt: skip
        x1 = rng.uniform(-1, 1)
        run = vines.simulate(p, x1=x1, x2=x1 - rng.uniform(-1, 1), v2=rng.uniform(-1, 1), phi=1.0, periods=12)
        assert run.status == "complete"
        found = run.measures()
        assert abs(found.balance) < 1e-12 * (1 + abs(found.base_work))
        at = run.sample(400)
        assert np.abs(at["w"]).max() <= 1 + 1e-13
        assert np.abs(at["x1"]).max() <= found.max_abs_x1 * (1 + 1e-13)
        hits, sticks = hits + len(run.impacts), sticks + len(run.sticks)
    assert hits > 1000
    assert sticks > 30


def test_the_rest_of_a_step_is_no_contact():
    """Where a certified step ended a rounding short of the end of its series, that rest was once taken for one."""
    p = systems.CubicBarriers(mu=0.45853489954660936, A=1.9732007182359343, Omega=0.6464421085573149,
                              r=0.7359636530886098, k1=-0.44190651788682356, l2=0.7433302110153561)  # fmt: skip
    run = vines.simulate(p, x1=-0.9352966688888046, v1=-4.421125081278097, x2=0.06470333111119542,
                         v2=-4.442324775472302, phi=3.494402628753789, periods=0.1)  # fmt: skip
    assert len(run.impacts) == 0
    assert abs(run.measures().balance) < 1e-13
