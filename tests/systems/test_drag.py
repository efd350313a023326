"""A ball that is dragged, against the VI-NES, matrix exponentials of 30 digits, DOP853 and its own equations."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import root

import vines
from vines import systems
from vines.dynamics import decay, tangent_map
from vines.errors import ParameterError


def matrix(p):
    """Return the rates of x1, v1, x2, v2, A sin, A cos."""
    d = p.delta
    return np.array(
        [
            [0, 1, 0, 0, 0, 0],
            [-1, -p.lam - p.mu * d, 0, p.mu * d, 1, p.lam * p.Omega],
            [0, 0, 0, 1, 0, 0],
            [0, d, 0, -d, 0, 0],
            [0, 0, 0, 0, 0, p.Omega],
            [0, 0, 0, 0, -p.Omega, 0],
        ]
    )


def test_without_drag_it_is_the_vi_nes():
    p, same = systems.Drag(mu=0.02, A=0.03), vines.Params(mu=0.02, A=0.03)
    ours, theirs = vines.simulate(p, periods=15), vines.simulate(same, periods=15)
    assert ours.rows == pytest.approx(theirs.rows, abs=1e-12)
    assert ours.measures().damper_loss == pytest.approx(theirs.measures().damper_loss, abs=1e-13)
    for A, delta in ((0.03, 0.0), (0.015, 1e-14)):
        orbit = vines.find_orbit("LR", systems.Drag(mu=0.02, A=A, delta=delta))
        model = vines.find_orbit("LR", same.replace(A=A))
        assert orbit.states == pytest.approx(model.states, abs=1e-12)
        assert orbit.multipliers == pytest.approx(model.multipliers, abs=1e-11)
        assert orbit.measures.kinetic_ratio == pytest.approx(model.measures.kinetic_ratio, abs=1e-12)


@given(
    mu=st.floats(1e-6, 4),
    delta=st.floats(0, 100) | st.floats(0, 1e-3),
    lam=st.floats(0, 0.5),
    Omega=st.floats(0.2, 3) | st.just(1.0),
    seed=st.integers(0, 999),
)
@settings(max_examples=25, deadline=None)
def test_flights_are_the_matrix_exponential(mu, delta, lam, Omega, seed):
    rng = np.random.default_rng(seed)
    p = systems.Drag(mu=mu, A=0.03, Omega=Omega, lam=lam, delta=delta, r=0.6)
    x1, v1, v2, phi = *rng.uniform(-0.4, 0.4, 3), rng.uniform(0, 6)
    run = vines.simulate(p, x1=x1, v1=v1, x2=x1 - rng.uniform(-0.5, 0.5), v2=v2, phi=phi, periods=0.7)
    rows = run.events
    with mpmath.workdps(30):
        M = mpmath.matrix(matrix(p).tolist())
        for k in range(min(len(rows) - 1, 3)):
            if rows["kind"][k] == 2:
                break
            phase = rows["phase"][k]
            begin = [rows["x1"][k], rows["v1_after"][k], rows["x2"][k], rows["v2_after"][k]]
            shaken = [p.A * math.sin(phase), p.A * math.cos(phase)]
            tau = run.rows[k + 1, 3]
            end = mpmath.expm(M * tau) * mpmath.matrix([float(each) for each in begin + shaken])
            found = [rows[name][k + 1] for name in ("x1", "v1", "x2", "v2")]
            assert found == pytest.approx([float(each) for each in end[:4]], abs=2e-13)
    assert run.measures().balance == pytest.approx(0, abs=1e-13)


@pytest.mark.parametrize("seed", range(5))
def test_no_contact_is_missed_beside_dop853(seed):
    rng = np.random.default_rng(seed)
    delta = 10.0 ** rng.uniform(-2, 0)
    p = systems.Drag(
        mu=rng.uniform(0.005, 0.5), A=0.3, Omega=rng.uniform(0.6, 1.6), r=rng.uniform(0.3, 0.95), delta=delta
    )
    run = vines.simulate(p, v1=rng.uniform(-3, 3), v2=rng.uniform(-2, 2), phi=rng.uniform(0, 6), periods=2)
    rows, M = run.events, matrix(p)
    for k in range(len(rows) - 1):
        tau = run.rows[k + 1, 3]
        if rows["kind"][k] == 2 or tau < 1e-3:
            continue
        phase = rows["phase"][k]
        begin = [rows["x1"][k], rows["v1_after"][k], rows["x2"][k], rows["v2_after"][k]]
        begin += [p.A * math.sin(phase), p.A * math.cos(phase)]
        flown = solve_ivp(lambda t, y: M @ y, (0, tau), begin, "DOP853", rtol=1e-13, atol=1e-14, max_step=0.05).y
        w = flown[0] - flown[2]
        assert np.abs(w[1:-1]).max(initial=0.0) < 1
        assert [rows[name][k + 1] for name in ("x1", "v1", "x2", "v2")] == pytest.approx(flown[:4, -1], abs=2e-11)
        if rows["kind"][k + 1] == 1:
            assert abs(w[-1]) == pytest.approx(1.0, abs=2e-11)
    assert run.measures().balance == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(("lam", "Omega"), [(0.0, 1.0), (1e-9, 1.0), (0.012, 1.0), (0.012, 0.4)])
@pytest.mark.parametrize("delta", [0.0, 1e-11, 0.05])
def test_budget_at_resonance(lam, Omega, delta):
    run = vines.simulate(systems.Drag(mu=0.01, A=0.05, lam=lam, Omega=Omega, delta=delta), periods=6)
    m = run.measures()
    assert abs(m.balance) < 1e-12 * max(1.0, m.base_work)
    last = run.sample(5, at_events=True)[-1]
    stored = sum(last[name] for name in ("kinetic_1", "kinetic_2", "potential"))
    start = 0.5 * 0.01 * 0.1**2
    assert last["base_work"] - last["damper_loss"] - last["impact_loss"] == pytest.approx(stored - start, abs=1e-12)
    assert last["damper_loss"] == pytest.approx(m.damper_loss + m.travel_loss, abs=1e-13)


def test_the_power_of_the_coil_is_the_mean_square():
    p = systems.Drag(mu=0.02, A=0.03, delta=0.05)
    run = vines.simulate(p, periods=30)
    states = run.sample(400_001)
    mean = np.trapezoid((states["v1"] - states["v2"]) ** 2, states["t"])
    assert run.measures().travel_loss == pytest.approx(p.mu * p.delta * mean, rel=1e-4)


def test_tangent_map_is_the_derivative_of_the_run():
    p = systems.Drag(mu=0.3, A=0.1, delta=0.2, r=0.7)
    begin = {"x1": 0.1, "v1": 1.0, "x2": -0.2, "v2": -0.4}
    run = vines.simulate(p, **begin, phi=0.3, periods=1.3)
    assert len(run.impacts) > 1
    assert not len(run.sticks)
    h = 1e-6
    columns = []
    for name, value in begin.items():
        ends = [
            np.array(
                [vines.simulate(p, **{**begin, name: value + step}, phi=0.3, periods=1.3).final[key] for key in begin]
            )
            for step in (h, -h)
        ]
        columns.append((ends[0] - ends[1]) / (2 * h))
    Y = tangent_map(run)
    assert pytest.approx(np.column_stack(columns), rel=1e-7, abs=1e-7) == Y
    trace = p.lam + (1 + p.mu) * p.delta
    expected = p.r ** (2 * len(run.impacts)) * math.exp(-trace * 1.3 * p.period)
    assert np.linalg.det(Y) == pytest.approx(expected, rel=1e-10)


def struck(p, v1, v2):
    """Return the velocities after an impact: momentum is kept, w' becomes -r w'."""
    common = (v1 + p.mu * v2) / (1 + p.mu)
    return common - p.mu * p.r * (v1 - v2) / (1 + p.mu), common + p.r * (v1 - v2) / (1 + p.mu)


def half_of(p, x1, v1, v2, phase, lasts):
    """Return the state a time after an impact on L at a phase, by the matrix exponential."""
    after = struck(p, v1, v2)
    begin = [x1, after[0], x1 - 1, after[1], p.A * math.sin(phase), p.A * math.cos(phase)]
    return expm(matrix(p) * lasts) @ begin


def test_symmetric_orbit_and_its_breaking_by_their_own_equations():
    start = vines.find_orbit("LR", systems.Drag(mu=0.02, A=0.03, delta=0.03))
    branch = vines.continue_orbit(start, "A", 0.032)
    (broken,) = branch.bifurcations
    assert broken.type == "symmetry_breaking"
    orbit = broken.orbit
    p = orbit.params

    def closes(z):
        end = half_of(p, *z, math.pi / p.Omega)
        return [end[0] + z[0], end[1] + z[1], end[3] + z[2], end[0] - end[2] + 1]

    guess = [orbit.states[0, 0], orbit.states[0, 1], orbit.states[0, 3], orbit.phase[0]]
    solved = root(closes, np.array(guess) + 1e-3, tol=1e-13).x
    assert solved == pytest.approx(guess, abs=1e-10)

    def mirrored_map(z):
        """Return the mirror image of the next impact on R: x1, v1, v2, phase."""
        lasts = math.pi / p.Omega
        for _ in range(40):
            end = half_of(p, *z, lasts)
            step = (end[0] - end[2] + 1) / (end[1] - end[3])
            lasts -= step
        end = half_of(p, *z, lasts)
        return np.array([-end[0], -end[1], -end[3], z[3] + p.Omega * lasts - math.pi])

    h = 1e-5
    slope = np.column_stack([(mirrored_map(solved + e) - mirrored_map(solved - e)) / (2 * h) for e in h * np.eye(4)])
    assert np.linalg.eigvals(slope).real.min() == pytest.approx(-1.0, abs=1e-6)
    assert np.linalg.det(slope) ** 2 == pytest.approx(np.prod(orbit.multipliers).real, rel=1e-6)


def test_orbits_and_runs_agree():
    p = systems.Drag(mu=0.02, A=0.03, delta=0.03)
    found, orbit = vines.settle(p, settle=600), vines.find_orbit("LR", p)
    assert (found.word, found.regime) == ("LR", "periodic")
    assert np.sort_complex(found.multipliers) == pytest.approx(np.sort_complex(orbit.multipliers), abs=1e-9)
    assert found.measures.travel_loss / found.measures.duration == pytest.approx(
        orbit.measures.travel_loss / orbit.measures.duration, rel=1e-9
    )
    assert abs(orbit.energy_imbalance) < 1e-13
    trace = p.lam + (1 + p.mu) * p.delta
    assert np.prod(orbit.multipliers).real == pytest.approx(p.r**4 * math.exp(-trace * p.period), rel=1e-12)
    followed = vines.continue_orbit(orbit, "delta", 0.2)
    last = followed.orbits[-1]
    assert last.states == pytest.approx(vines.find_orbit("LR", last.params, guess=last).states, abs=1e-12)


def test_words_without_symmetry():
    p = systems.Drag(mu=0.01, A=0.023, delta=0.01)
    orbit = vines.find_orbit("LLR", p)
    assert orbit.residual < 1e-12
    run = vines.simulate(p, **orbit.start(), periods=1.01)
    assert [int(side) for side in run.impacts["side"]] == [1, -1, 1]
    assert run.impacts["w_dot"] == pytest.approx(np.roll(orbit.w_dot, -1), abs=1e-9)


def test_a_ball_that_is_dragged_to_rest_in_its_cavity_is_never_hit():
    p = systems.Drag(mu=0.02, A=0.015, delta=0.3)
    found = vines.settle(p, settle=600)
    assert (found.regime, found.settled, found.reason) == ("no_impact", True, "")
    roots = np.sort(np.linalg.eigvals(matrix(p)[:4, :4]).real)[::-1]
    assert found.exponents == pytest.approx(roots, abs=1e-12)


def test_a_transient_loses_to_impacts_damper_and_coil():
    found = decay(vines.simulate(systems.Drag(mu=0.02, A=0.0, delta=0.05), v1=2.0, v2=0.0, periods=40))
    assert found.travel_share > 0.01
    whole = (found.impact_share, found.damper_share, found.travel_share, found.frame_share, found.ball_share)
    assert sum(whole) == pytest.approx(1, abs=1e-12)


def test_the_pair_of_roots_stays_a_pair_in_the_declared_range():
    """Below |Im s| all differences of the three roots stay away from 0, so that nothing cancels."""
    least = math.inf
    for mu in (1e-3, 0.1, 1, 2, 3, 4):
        for lam in (0, 0.012, 0.25, 0.5):
            for delta in np.geomspace(1e-3, 100, 200):
                roots = np.roots([1, lam + (1 + mu) * delta, 1 + lam * delta, delta])
                least = min(least, float(np.abs(roots.imag).max()))
    assert least > 0.25


def test_what_cannot_be_is_refused():
    for given_, text in (({"mu": 5}, "mu is 5"), ({"lam": 0.6}, "lam is 0.6"), ({"delta": -1}, "delta is -1")):
        with pytest.raises(ParameterError, match=text):
            systems.Drag(**{"mu": 0.01, "A": 0.02, **given_})
