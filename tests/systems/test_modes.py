"""A structure of several modes against DOP853, the limits that tie it to other systems, and balances."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import vines
from vines import systems
from vines.dynamics import lyapunov_spectrum, tangent_map
from vines.dynamics._advance import A_V2, MODE, PHASE, SIDE, TAU, V2, X2
from vines.dynamics.kernels import constants, segment_state, tangent_product
from vines.dynamics.modes.kernels import R_MODAL
from vines.errors import ParameterError
from vines.orbits import continue_orbit, switch_branch
from vines.orbits._turnings_of_balls import turnings_kernel

BEAM = {"omega": (1.0, 6.267), "phi": (2.0, -2.0), "gamma": (0.783, 0.434), "lam": (0.012, 0.1)}
TWO = {"omega": (1.0, 2.4), "phi": (1.0, -0.6), "gamma": (0.8, 0.3), "lam": (0.02, 0.03)}
THREE = {
    "omega": (1.0, 1.9, 3.3), "phi": (0.8, -0.7, 0.4), "gamma": (0.9, 0.5, -0.3), "lam": (0.02, 0.05, 0.01),
}  # fmt: skip
OF_ONE = ("kinetic_1", "kinetic_2", "kinetic_ratio", "max_abs_x1", "rms_x1", "base_work", "damper_loss", "impact_loss")


def slopes(p, phase, rides):
    """Return the equations of motion in z_1, z_1', …, x2, v2, from relative coordinates and the law of the base."""
    omega, lam, phi, gamma = (np.array(each) for each in (p.omega, p.lam, p.phi, p.gamma))
    square, direct, S = omega**2, 1 - phi @ gamma, phi @ phi
    out = np.empty(2 * p.modes + 2)

    def f(t, y):
        angle = phase + p.Omega * t
        e, rate = p.A * math.sin(angle), p.A * p.Omega * math.cos(angle)
        # eta = z - gamma e is the motion of the mode relative to the base.
        push = -lam * (y[1:-2:2] - gamma * rate) - square * (y[0:-2:2] - gamma * e)
        out[0:-2:2], out[1:-2:2], out[-2], out[-1] = y[1:-2:2], push, y[-1], 0.0
        if rides:
            out[-1] = (phi @ push - direct * p.Omega**2 * e) / (1 + p.mu * S)
            out[1:-2:2] -= p.mu * phi * out[-1]
        return out.copy()

    return f


def flown(p, phase, y, tau, rides=False):
    return solve_ivp(slopes(p, phase, rides), (0, tau), y, "DOP853", rtol=1e-13, atol=1e-15, max_step=0.5).y


def cavity(p, y, phase):
    """Return x1 and v1."""
    angle = np.asarray(phase)
    x = np.array(p.phi) @ y[0:-2:2] + p.direct * p.A * np.sin(angle)
    return x, np.array(p.phi) @ y[1:-2:2] + p.direct * p.A * p.Omega * np.cos(angle)


def state_of(p, row):
    return [*row[R_MODAL : R_MODAL + 2 * p.modes], row[X2], row[A_V2]]


@pytest.mark.parametrize("shape", [BEAM, THREE])
def test_every_flight_and_ride_against_dop853(shape):
    p = systems.Modes(mu=0.05, A=0.5, r=0.3, Omega=0.9, **shape)
    rows = vines.simulate(p, v2=0.3, phi=0.7, periods=6).rows
    flights = rides = 0
    for now, after in pairwise(rows):
        tau = after[TAU]
        if tau < 1e-3:
            continue
        y = flown(p, now[PHASE], state_of(p, now), tau, now[MODE] != 0)
        end = y[:, -1].copy()
        x, v = cavity(p, end, after[PHASE])
        assert [after[5], after[6]] == pytest.approx([x, v], abs=1e-10)
        assert [after[X2], after[V2]] == pytest.approx(end[-2:], abs=1e-10)
        impulse = p.mu * (after[A_V2] - after[V2])
        kicked = end[1:-2:2] - np.array(p.phi) * impulse
        assert after[R_MODAL::2] == pytest.approx(end[0:-2:2], abs=1e-10)
        assert after[R_MODAL + 1 :: 2] == pytest.approx(kicked, abs=1e-10)
        if now[MODE] == 0:
            flights += 1
            continue
        # The wall presses all the way, and no more when it lets go.
        press = now[MODE] * slopes(p, after[PHASE], True)(0.0, end)[-1]
        middle = flown(p, now[PHASE], state_of(p, now), 0.5 * tau, True)[:, -1]
        assert now[MODE] * slopes(p, now[PHASE] + 0.5 * p.Omega * tau, True)(0.0, middle)[-1] > 0
        assert after[0] != 3 or press == pytest.approx(0, abs=1e-10)
        rides += 1
    assert flights > 10
    assert rides >= 2


@pytest.mark.parametrize(("shape", "mu"), [(TWO, 0.01), (THREE, 0.05)])
def test_a_run_of_fifty_impacts_against_dop853(shape, mu):
    p = systems.Modes(mu=mu, A=0.05 if mu > 0.02 else 0.02, **shape)
    run = vines.simulate(p, v2=0.3, periods=60)
    hits = run.impacts[:55]
    assert len(hits) == 55
    y = np.array(state_of(p, run.rows[0]))
    t = 0.0
    for hit in hits:

        def gap(s, y, p=p, t=t):
            return 1.0 - abs(cavity(p, y, p.Omega * (t + s))[0] - y[-2])

        gap.terminal, gap.direction = True, -1
        # The first steps leave the wall just hit.
        found = solve_ivp(
            slopes(p, p.Omega * t, False), (0, 60), y, "DOP853", rtol=1e-13, atol=1e-15, max_step=0.25, events=gap
        )
        t += found.t_events[0][0]
        y = found.y_events[0][0].copy()
        x, v = cavity(p, y, p.Omega * t)
        assert [hit["t"], hit["x1"], hit["v1"], hit["x2"]] == pytest.approx([t, x, v, y[-2]], abs=1e-9)
        side = 1.0 if x > y[-2] else -1.0
        assert side == hit["side"]
        S = np.array(p.phi) @ np.array(p.phi)
        after = v - p.mu * S * (1 + p.r) * (v - y[-1]) / (1 + p.mu * S)
        leaves = after + p.r * (v - y[-1])
        y[1:-2:2] -= np.array(p.phi) * p.mu * (leaves - y[-1])
        # On its wall, to the last bit, so that it is left at once.
        y[-2], y[-1] = x - side * (1 - 1e-15), leaves


def test_one_mode_is_the_vi_nes():
    given = {"mu": 0.01, "A": 0.015}
    ours, theirs = (vines.simulate(p(**given), periods=150) for p in (systems.Modes, vines.Params))
    assert ours.impacts["t"] == pytest.approx(theirs.impacts["t"], abs=1e-11)
    assert tangent_map(ours) == pytest.approx(tangent_map(theirs), abs=1e-12)
    ours, theirs = (vines.settle(p(**given)) for p in (systems.Modes, vines.Params))
    assert ours.name == theirs.name == "1:1"
    for name in OF_ONE:
        assert getattr(ours.measures, name) == pytest.approx(getattr(theirs.measures, name), abs=1e-12)
    given = {"mu": 0.05, "A": 2.0, "Omega": 0.3, "r": 0.3}
    ours, theirs = (vines.simulate(p(**given), periods=12) for p in (systems.Modes, vines.Params))
    assert len(ours.sticks) == len(theirs.sticks) > 5
    for name in ("t_start", "t_release", "impacts"):
        assert ours.sticks[name][:5] == pytest.approx(theirs.sticks[name][:5], abs=1e-8)
    assert tangent_map(ours) == pytest.approx(tangent_map(theirs), rel=1e-8)
    assert lyapunov_spectrum(ours)[0][:2] == pytest.approx(lyapunov_spectrum(theirs)[0][:2], abs=1e-9)


def test_one_mode_of_another_scale_is_the_vi_nes_of_that_scale():
    # z of a mode with shape phi is x1/phi: the mass that moves with the cavity is 1/phi².
    ours = systems.Modes(mu=0.0025, A=0.015, Omega=3.0, omega=(3.0,), phi=(2.0,), gamma=(0.5,), lam=0.036)
    theirs = vines.Params(mu=0.01, A=0.015, lam=0.012)
    first, second = vines.find_orbit("LR", ours), vines.find_orbit("LR", theirs)
    assert vines.settle(ours, v2=0.3).name == first.name == second.name
    assert first.measures.max_abs_x1 == pytest.approx(second.measures.max_abs_x1, abs=1e-12)
    assert first.measures.kinetic_ratio == pytest.approx(second.measures.kinetic_ratio / 4, abs=1e-12)


def test_a_mode_that_does_not_move_the_cavity_is_none():
    one = systems.Modes(mu=0.02, A=0.02, phi=(2.0,), gamma=(0.5,))
    two = systems.Modes(mu=0.02, A=0.02, omega=(1.0, 6.267), phi=(2.0, 0.0), gamma=(0.5, 0.7), lam=(one.lam[0], 0.1))
    first, second = (vines.simulate(p, v2=0.4, periods=15) for p in (one, two))
    assert len(first.impacts) == len(second.impacts) > 20
    assert first.impacts["t"] == pytest.approx(second.impacts["t"], abs=1e-10)
    assert first.measures().max_abs_x1 == pytest.approx(second.measures().max_abs_x1, abs=1e-10)


def test_a_stiff_mode_that_nothing_strikes_moves_with_the_base():
    # An impact shakes a mode however stiff it is; a ball without mass strikes none.
    one = systems.Modes(mu=0.0, A=0.5, phi=(2.0,), gamma=(0.4,))
    alone = vines.simulate(one, v2=0.4, periods=4)
    off = []
    for omega in (120.0, 480.0):
        two = systems.Modes(
            mu=0.0, A=0.5, omega=(1.0, omega), phi=(2.0, 1.5), gamma=(0.4, 0.4), lam=(one.lam[0], 0.0)
        )  # fmt: skip
        run = vines.simulate(two, v2=0.4, q_dot_2=0.4 * two.A, v1=0.0, periods=4)
        assert len(run.impacts) == len(alone.impacts) > 4
        off.append(np.abs(run.impacts["t"] - alone.impacts["t"]).max())
    assert off[0] < 0.02
    assert off[0] / off[1] == pytest.approx(16, rel=0.3)


@given(
    modes=st.integers(1, 4), seed=st.integers(0, 10**6), A=st.floats(0.0, 1.0), Omega=st.floats(0.4, 3.0),
    r=st.floats(0.0, 1.0), mu=st.floats(0.0, 0.3),
)  # fmt: skip
@settings(max_examples=25, deadline=None)
def test_the_energy_balance_closes(modes, seed, A, Omega, r, mu):
    rng = np.random.default_rng(seed)
    omega = np.cumsum(rng.uniform(0.4, 2.0, modes))
    p = systems.Modes(
        mu=mu, A=A, Omega=Omega, r=r, omega=omega, lam=omega * rng.uniform(0.0, 0.3, modes),
        phi=rng.choice([-1, 1], modes) * rng.uniform(0.2, 1.5, modes), gamma=rng.uniform(-1, 1, modes),
    )  # fmt: skip
    start = {f"{name}_{k}": rng.normal() for k in range(2, modes + 1) for name in ("q", "q_dot")}
    run = vines.simulate(p, x1=0.3, v1=rng.normal(), x2=rng.uniform(-0.6, 1.2), v2=rng.normal(), periods=6, **start)
    m = run.measures()
    whole = abs(m.base_work) + m.damper_loss + m.impact_loss + abs(m.energy_change)
    assert abs(m.balance) < 1e-12 * (1 + whole)
    assert sum(each.damper_loss for each in m.modes) == pytest.approx(m.damper_loss, rel=1e-12, abs=1e-14)
    at = run.sample(7)
    stored = at["kinetic_1"] + at["kinetic_2"] + at["potential"]
    gained = at["base_work"] - at["damper_loss"] - at["impact_loss"]
    assert stored - gained == pytest.approx(stored[0], abs=1e-11 * (1 + whole))
    assert m.max_abs_x1 >= np.abs(run.sample(500)["x1"]).max() - 1e-12


def test_disturbances_against_differences_and_the_closed_form_of_their_determinant():
    p = systems.Modes(mu=0.05, A=0.1, Omega=0.9, r=0.7, **THREE)
    start = {"x1": 0.2, "v1": 0.1, "x2": -0.3, "v2": 0.4, "q_2": 0.1, "q_dot_2": -0.2, "q_3": 0.05, "q_dot_3": 0.1}
    run = vines.simulate(p, periods=2, **start)
    J = tangent_map(run)
    assert len(run.impacts) > 2
    assert not len(run.sticks)
    t = 2 * p.period
    c = constants(p)
    flights = [np.linalg.det(tangent_product(c, run.rows, k, k + 1)) for k in range(len(run.rows) - 1)]
    assert np.prod(flights) == pytest.approx(p.r ** (2 * len(run.impacts)) * math.exp(-sum(p.lam) * t), rel=1e-12)
    h = 1e-7
    for k, name in enumerate(start):
        up, down = (
            vines.simulate(p, periods=2, **(start | {name: start[name] + sign * h})).final for sign in (1.0, -1.0)
        )
        column = [(up[each] - down[each]) / (2 * h) for each in start]
        assert column == pytest.approx(J[:, k], abs=1e-7 * np.abs(J).max())


def test_disturbances_through_sticking_against_differences():
    p = systems.Modes(mu=0.05, A=0.5, Omega=0.9, r=0.3, **BEAM)
    start = {"x1": 0.2, "v1": 0.1, "x2": -0.3, "v2": 0.4, "q_2": 0.1, "q_dot_2": -0.2}
    run = vines.simulate(p, periods=1.9, **start)
    assert len(run.sticks)
    assert np.isfinite(run.sticks["t_release"][0])
    J = tangent_map(run)
    h = 1e-6
    for k, name in enumerate(start):
        up, down = (
            vines.simulate(p, periods=1.9, **(start | {name: start[name] + sign * h})).final for sign in (1.0, -1.0)
        )
        column = [(up[each] - down[each]) / (2 * h) for each in start]
        assert column == pytest.approx(J[:, k], abs=2e-4 * np.abs(J).max())


def test_orbits_and_their_multipliers():
    p = systems.Modes(mu=0.05, A=0.04, **THREE)
    found = vines.settle(p)
    orbit = vines.find_orbit("LR", p)
    assert found.name == orbit.name == "1:1"
    assert orbit.stable
    assert orbit.admissible
    assert orbit.residual < 1e-12
    assert orbit.measures.max_abs_x1 == pytest.approx(found.measures.max_abs_x1, abs=1e-9)
    assert abs(orbit.measures.balance) < 1e-13
    assert np.sort(np.abs(orbit.multipliers)) == pytest.approx(np.sort(np.abs(found.multipliers)), abs=1e-7)
    product = np.prod(orbit.multipliers).real
    assert product == pytest.approx(p.r**4 * math.exp(-sum(p.lam) * p.period), rel=1e-9)
    one = systems.Modes(mu=0.01, A=0.015)
    ours, theirs = vines.find_orbit("LR", one), vines.find_orbit("LR", vines.Params(mu=0.01, A=0.015))
    assert ours.states == pytest.approx(theirs.states, abs=1e-12)
    assert ours.multipliers == pytest.approx(theirs.multipliers, abs=1e-12)


def test_a_family_loses_its_symmetry_where_runs_do():
    p = systems.Modes(mu=0.05, A=0.0478, **THREE)
    family = continue_orbit(vines.find_orbit("LR", p), "A", 0.0482)
    (breaking,) = family.bifurcations
    assert breaking.type == "symmetry_breaking"
    assert breaking.value == pytest.approx(0.0481379859734, abs=1e-12)
    found = vines.settle(p.replace(A=0.0483))
    assert (found.name, found.symmetric) == ("1:1", False)
    branched = switch_branch(breaking)[0]
    assert (branched.symmetric, branched.stable) == (False, True)
    orbit = vines.find_orbit("LR", found.params, branched)
    assert found.measures.max_abs_x1 == pytest.approx(orbit.measures.max_abs_x1, abs=1e-9)


def test_a_flight_turns_where_samples_do():
    orbit = vines.find_orbit("LLR", systems.Modes(mu=0.05, A=0.08, **THREE))
    side, t, states = orbit.side.astype(np.int64), orbit.t.copy(), orbit.states.copy()
    ((flight, when, wall, clearance, bend, _),) = turnings_kernel(
        constants(orbit.params), orbit.period, side, t, states
    )  # fmt: skip
    assert clearance == orbit.min_clearance
    run = vines.simulate(orbit.params, periods=1, **orbit.start())
    (at,) = run.sample(times=[t[int(flight)] + when])
    assert at["w_dot"] == pytest.approx(0, abs=1e-13)
    assert 1 - wall * at["w"] == pytest.approx(clearance, abs=1e-13)
    assert wall * bend < 0


def test_modes_that_coincide_with_the_ball_riding_are_refused_and_beside_it_hold():
    p = systems.Modes(
        mu=0.05439048676388367, A=0.3, omega=(1.0, 0.98), phi=(1.0, 0.5), gamma=(0.8, 0.3),
        lam=(0.01, 0.061514287059221504),
    )  # fmt: skip
    with pytest.raises(ParameterError, match="two modes of the structure coincide; change mu"):
        vines.simulate(p, periods=1)
    near = p.replace(mu=p.mu * (1 + 1e-6))
    start = [0.1, 0.3, -0.2, 0.1, 0.0, 0.0]
    row = np.zeros((1, R_MODAL + 4))
    row[0, R_MODAL:] = start[:4]
    row[0, [SIDE, MODE, PHASE]] = 1.0, 1.0, 0.4
    c = constants(near)
    x1, v1, _, v2, _ = segment_state(c, row[0], 2.0)
    end = flown(near, 0.4, start, 2.0, rides=True)[:, -1]
    assert [x1, v1] == pytest.approx([float(each) for each in cavity(near, end, 0.4 + 2.0 * near.Omega)], abs=1e-11)
    assert v1 == v2


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"phi": (1.0, 2.0)}, "phi has 2 values for 1 modes"),
        ({"omega": ()}, "allowed are 1 to 6"),
        ({"lam": 2.0}, "underdamped"),
        ({"phi": (0.0,)}, "phi_1 is 0"),
        ({"omega": "1"}, "number for each mode"),
        ({"gamma": (math.nan,)}, "gamma_1"),
    ],
)
def test_bad_parameters_are_one_line(given, says):
    with pytest.raises(ParameterError, match=says):
        systems.Modes(mu=0.01, A=0.02, **given)
