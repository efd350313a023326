"""The impact pair against closed forms, DOP853 with small steps, and numbers of other programs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vines
from vines import systems
from vines.dynamics import lyapunov_spectrum, tangent_map
from vines.errors import OrbitNotFound, ParameterError, StateError


def symmetric_speed(B: float, r: float) -> float:
    """Return the larger speed U of the symmetric 1:1 orbit: (1 - r)² U² + (2 - pi (1 + r) U/2)² = 4 B²."""
    a, b = 1 - r, math.pi * (1 + r) / 2
    return (2 * b + math.sqrt(4 * b * b - (a * a + b * b) * (4 - 4 * B * B))) / (a * a + b * b)


@pytest.mark.parametrize(("B", "r"), [(0.6, 0.5), (0.3, 0.5), (0.7, 0.65)])
def test_symmetric_orbit_is_the_closed_form(B, r):
    p = systems.ImpactPair(B=B, r=r)
    orbit = vines.find_orbit("LR", p)
    U = symmetric_speed(B, r)
    assert orbit.symmetric
    assert orbit.w_dot == pytest.approx([U, -U], abs=1e-13)
    assert math.cos(orbit.phase[0]) == pytest.approx((1 - r) * U / (2 * B), abs=1e-13)
    assert math.sin(orbit.phase[0]) == pytest.approx((2 - math.pi * (1 + r) * U / 2) / (2 * B), abs=1e-13)
    assert np.prod(orbit.multipliers).real == pytest.approx(r**4, rel=1e-12)
    assert orbit.measures.impact_loss == pytest.approx((1 - r * r) * U * U, rel=1e-13)
    assert abs(orbit.measures.balance) < 1e-13
    assert orbit.residual < 1e-13


def test_fold_and_symmetry_breaking():
    orbit = vines.find_orbit("LR", systems.ImpactPair(B=0.6, r=0.5))
    down = vines.continue_orbit(orbit, "B", 0.1)
    assert [each.type for each in down.bifurcations] == ["fold"]
    assert down.bifurcations[0].value == pytest.approx(0.5 / math.hypot(0.5, 0.75 * math.pi), abs=1e-12)
    up = vines.continue_orbit(orbit, "B", 0.9)
    assert [each.type for each in up.bifurcations] == ["symmetry_breaking"]
    assert up.bifurcations[0].value == pytest.approx(0.7692409694848, abs=1e-12)
    softer = vines.continue_orbit(vines.find_orbit("LR", systems.ImpactPair(B=0.6, r=0.65)), "B", 0.8)
    assert [round(each.value, 8) for each in softer.bifurcations] == [0.71831086]


def test_tilted_orbits_their_doubling_and_grazing():
    """Check values of an independent prototype, laid beside DOP853."""
    tilted = vines.find_orbit("LR", systems.ImpactPair(B=0.6, G=0.05, r=0.5))
    assert tilted.w_dot == pytest.approx([1.387926565028, -1.178487054789], abs=1e-11)
    m = tilted.measures
    assert m.impact_loss / m.duration == pytest.approx(0.197859747453, abs=1e-11)
    assert m.impact_loss_left / m.impact_loss == pytest.approx(0.5810679551, abs=1e-9)
    branch = vines.continue_orbit(tilted, "B", 1.2)
    assert [each.type for each in branch.bifurcations] == ["period_doubling", "grazing"]
    assert [each.value for each in branch.bifurcations] == pytest.approx([0.96031987596, 1.1301], abs=5e-5)
    assert branch.bifurcations[0].value == pytest.approx(0.96031987596, abs=1e-10)
    assert branch.ends[1] == "grazing"
    steeper = vines.continue_orbit(vines.find_orbit("LR", systems.ImpactPair(B=0.3, G=0.15, r=0.5)), "B", 0.4)
    assert [round(each.value, 4) for each in steeper.bifurcations] == [0.3627]
    two_to_one = vines.find_orbit("LLR", systems.ImpactPair(B=0.95, G=0.15, r=0.5))
    assert sorted(two_to_one.w_dot) == pytest.approx([-1.609274437273, 0.530423857881, 1.70716911011], abs=1e-11)
    assert two_to_one.measures.impact_loss / two_to_one.measures.duration == pytest.approx(0.345298986768, abs=1e-11)


@pytest.mark.parametrize("parameter", ["G", "r"])
def test_any_parameter_can_be_followed(parameter):
    orbit = vines.find_orbit("LR", systems.ImpactPair(B=0.6, G=0.05, r=0.5))
    branch = vines.continue_orbit(orbit, parameter, orbit.params.as_dict()[parameter] * 1.2)
    last = branch.orbits[-1]
    fresh = vines.find_orbit("LR", last.params, guess=last)
    assert last.w_dot == pytest.approx(fresh.w_dot, abs=1e-12)


@pytest.mark.parametrize(
    ("B", "G", "word", "name"),
    [(0.6, 0.0, "LR", "1:1"), (0.6, 0.05, "LR", "1:1"), (0.95, 0.15, "LLR", "2:1"), (0.98, 0.05, "LRLR/2T", "2:2/2T")],
)
def test_runs_settle_on_the_orbit_of_their_word(B, G, word, name):
    p = systems.ImpactPair(B=B, G=G, r=0.5)
    found = vines.settle(p)
    assert (found.regime, found.word, found.name) == ("periodic", word, name)
    orbit = vines.find_orbit(word, p, guess=None if B < 0.98 else _times(found, len(word.split("/")[0])))
    assert found.symmetric is (G == 0)
    assert found.multipliers == pytest.approx(orbit.multipliers, abs=1e-9) or found.multipliers == pytest.approx(
        orbit.multipliers.conj(), abs=1e-9
    )
    assert found.exponents.sum() == pytest.approx(math.log(0.5) * 2 * len(orbit.t) / orbit.period, abs=1e-9)
    assert found.measures.impact_loss == pytest.approx(orbit.measures.impact_loss, rel=1e-10)


def _times(found, n):
    """Return the times of the last n impacts of an attractor that begin the canonical word."""
    hits = found.impacts
    first = len(hits) - n - (hits["side"][-n] < 0)
    t = hits["t"][first : first + n]
    phase = hits["phase"][first]
    return phase + (t - t[0])


def test_chaos_and_exponents():
    p = systems.ImpactPair(B=2.0, G=0.05, r=0.5)
    found = vines.settle(p, settle=100)
    assert found.regime == "chaotic"
    run = vines.simulate(p, periods=300)
    exponents, _ = lyapunov_spectrum(run, skip=20)
    assert exponents[0] > 0.1
    if not len(run.sticks):
        late = run.impacts["t"] > 20 * p.period
        expected = 2 * math.log(p.r) * late.sum() / (280 * p.period)
        assert exponents.sum() == pytest.approx(expected, abs=1e-3)


def _flown(p, row, tau):
    """Return t, w, w' of DOP853 with small steps, from just after an event."""
    theta = row["phase"]
    w = [row["x1"] - row["x2"], row["v1_after"] - row["v2_after"]]
    return solve_ivp(
        lambda t, y: [y[1], p.G - p.B * math.sin(theta + t)], (0, tau), w, "DOP853", rtol=1e-13, atol=1e-14,
        max_step=0.02,
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(6))
def test_every_flight_against_dop853(seed):
    rng = np.random.default_rng(seed)
    p = systems.ImpactPair(B=rng.uniform(0.1, 2.5), G=rng.uniform(-0.3, 0.3), r=rng.uniform(0.2, 0.95))
    run = vines.simulate(p, w=rng.uniform(-0.9, 0.9), w_dot=rng.uniform(-2, 2), phi=rng.uniform(0, 6), periods=4)
    rows = run.events
    for k in range(len(rows) - 1):
        tau = rows["t"][k + 1] - rows["t"][k]
        if rows["kind"][k] == 2 or tau < 1e-3:
            continue
        flown = _flown(p, rows[k], tau)
        w, speed = flown.y
        assert np.abs(w[1:-1]).max(initial=0.0) < 1
        after = rows[k + 1]
        assert w[-1] == pytest.approx(after["x1"] - after["x2"], abs=2e-11)
        assert speed[-1] == pytest.approx(after["v1"] - after["v2"], abs=2e-11)
        if after["kind"] == 1:
            assert abs(w[-1]) == pytest.approx(1.0, abs=2e-11)
            rebound = after["v1_after"] - after["v2_after"]
            assert rebound == pytest.approx(-p.r * speed[-1], abs=2e-11)
    assert run.measures().balance == pytest.approx(0, abs=1e-12)


def test_a_ball_that_rests_is_let_go_where_gravity_is_overcome():
    """While it rides on the lower end the contact force is G - B sin(theta): it ends where sin(theta) = G/B."""
    p = systems.ImpactPair(B=0.3, G=0.15, r=0.5)
    run = vines.simulate(p, w=1.0, w_dot=0.0, periods=40)
    released = run.sticks["phase_release"]
    assert run.sticks["side"][0] == 1
    assert len(released) > 5
    level = released[np.isfinite(released)]
    assert np.sin(level) == pytest.approx(p.G / p.B, abs=1e-12)
    assert np.all(np.cos(level) > 0)
    assert run.measures().balance == pytest.approx(0, abs=1e-12)


def test_a_ball_that_gravity_holds_makes_no_impact():
    found = vines.settle(systems.ImpactPair(B=0.1, G=0.15, r=0.5), w_dot=0.0)
    assert found.regime == "no_impact"
    assert found.settled
    assert found.final["w"] == 1.0


def test_tangent_map_is_the_derivative_of_the_run():
    p = systems.ImpactPair(B=0.9, G=0.1, r=0.7)
    begin = {"w": 0.2, "w_dot": -0.4}
    run = vines.simulate(p, **begin, phi=0.3, periods=1.3)
    assert len(run.impacts) > 1
    assert not len(run.sticks)
    h = 1e-6
    columns = []
    for name, value in begin.items():
        ends = []
        for step in (h, -h):
            end = vines.simulate(p, **{**begin, name: value + step}, phi=0.3, periods=1.3).final
            ends.append(np.array([end["w"], end["w_dot"]]))
        columns.append((ends[0] - ends[1]) / (2 * h))
    Y = tangent_map(run)
    assert pytest.approx(np.column_stack(columns), rel=1e-7, abs=1e-7) == Y
    assert np.linalg.det(Y) == pytest.approx(p.r ** (2 * len(run.impacts)), rel=1e-10)


def test_it_is_the_limit_of_a_light_ball():
    """The 1:1 orbit of a VI-NES whose steady motion has the amplitude B, with a slope of -1.25 mu at this place."""
    B, Omega, r = 0.5, 1.3, 0.5
    U = vines.find_orbit("LR", systems.ImpactPair(B=B, r=r)).w_dot[0]
    assert pytest.approx(1.1899465421635858, abs=1e-13) == U
    gains = []
    for mu in (1e-4, 1e-6):
        response = vines.no_ball(vines.Params(mu=mu, A=1.0, Omega=Omega, r=r))
        p = vines.Params(mu=mu, A=B / response, Omega=Omega, r=r)
        orbits = [o for o in vines.all_orbits("LR", p) if o.symmetric]
        speed = max(abs(o.w_dot[0]) for o in orbits) / Omega
        gains.append((speed - U) / mu)
    assert gains == pytest.approx([-1.25, -1.25], abs=0.01)


def test_what_cannot_be_is_refused():
    p = systems.ImpactPair(B=0.6)
    with pytest.raises(StateError, match="unknown coordinate 'x1'"):
        vines.simulate(p, x1=0.1)
    with pytest.raises(StateError, match="the gap"):
        vines.simulate(p, w=1.5)
    with pytest.raises(ParameterError, match="unknown parameter 'A'"):
        vines.continue_orbit(vines.find_orbit("LR", p), "A", 0.5)
    with pytest.raises(OrbitNotFound):
        vines.find_orbit("LR", systems.ImpactPair(B=0.1, r=0.5))
