"""A ball that slides with friction, against the VI-NES, DOP853 with events, differences and balances of forces."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vines
from vines import systems
from vines.dynamics import decay, tangent_map
from vines.errors import ParameterError
from vines.model import Word

IMPACT, STICK, RELEASE, STOP, SLIDE = 1, 2, 3, 5, 6


def test_without_friction_it_is_the_vi_nes():
    p, same = systems.Friction(mu=0.02, A=0.03), vines.Params(mu=0.02, A=0.03)
    ours, theirs = vines.simulate(p, periods=15), vines.simulate(same, periods=15)
    assert ours.rows == pytest.approx(theirs.rows, abs=1e-12)
    chatters, model = (
        vines.simulate(p.replace(A=2.0, r=0.3), periods=6),
        vines.simulate(same.replace(A=2.0, r=0.3), periods=6),
    )
    assert len(chatters.sticks) == len(model.sticks) > 1
    assert chatters.sticks["t_release"] == pytest.approx(model.sticks["t_release"], abs=1e-11, nan_ok=True)
    light = vines.simulate(p.replace(f=1e-14), periods=15).impacts
    assert light["t"] == pytest.approx(theirs.impacts["t"], abs=1e-9)


def test_with_tilt_it_is_the_ball_in_parallel():
    p = systems.Friction(mu=0.02, A=0.03, G=0.01)
    same = vines.simulate(systems.Parallel(mu=(0.02,), A=0.03, G=0.01), periods=12)
    ours = vines.simulate(p, periods=12)
    assert ours.impacts["t"] == pytest.approx(same.impacts["t"], abs=1e-11)
    assert ours.measures().base_work == pytest.approx(same.measures().base_work, abs=1e-12)


def integrated(p, start, phi, lasts):
    """Return kind, time, x1, v1 of the events of a run by DOP853: the ball stops where friction holds it, or slides."""

    def force(t):
        return p.A * (math.sin(p.Omega * t + phi) + p.lam * p.Omega * math.cos(p.Omega * t + phi))

    def draws(t, y):
        return force(t) - p.lam * y[1] - y[0] + p.G

    held = (1 + p.mu) * p.f
    found, t, y = [], 0.0, np.array(start)
    mode = "slide"
    sense = math.copysign(1.0, y[1] - y[3])
    while t < lasts and len(found) < 24:
        if mode == "slide":

            def rates(t, y, sense=sense):
                return [y[1], force(t) - p.lam * y[1] - y[0] - p.mu * p.f * sense, y[3], p.f * sense - p.G]

            events = [
                lambda t, y, sense=sense: 1 - sense * (y[0] - y[2]),
                lambda t, y, sense=sense: sense * (y[1] - y[3]),
            ]
        else:

            def rates(t, y):
                a = (draws(t, y) - p.G - p.mu * p.G) / (1 + p.mu)
                return [y[1], a, y[1], a]

            events = [lambda t, y: held - draws(t, y), lambda t, y: held + draws(t, y)]
        for event in events:
            event.terminal, event.direction = True, -1
        run = solve_ivp(rates, (t, lasts), y, "DOP853", events=events, rtol=1e-12, atol=1e-13, max_step=0.05)
        t, y = run.t[-1], run.y[:, -1].copy()
        if run.status == 0:
            break
        if mode == "stop":
            found.append((SLIDE, t, y[0], y[1]))
            mode, sense = "slide", math.copysign(1.0, draws(t, y))
            y[3] = y[1] - sense * 1e-15
        elif len(run.t_events[0]):
            found.append((IMPACT, t, y[0], y[1]))
            common, closing = (y[1] + p.mu * y[3]) / (1 + p.mu), y[1] - y[3]
            y[1] = common - p.mu * p.r * closing / (1 + p.mu)
            y[3] = common + p.r * closing / (1 + p.mu)
            y[2] = y[0] - sense
            sense = -sense
        elif abs(draws(t, y)) <= held:
            found.append((STOP, t, y[0], y[1]))
            mode = "stop"
            y[3] = y[1]
        else:
            found.append((SLIDE, t, y[0], y[1]))
            sense = math.copysign(1.0, draws(t, y))
            y[3] = y[1] - sense * 1e-15
    return found


@pytest.mark.parametrize("seed", range(8))
def test_runs_against_dop853_with_events(seed):
    rng = np.random.default_rng(seed)
    f = 10.0 ** rng.uniform(-1.5, -0.2)
    p = systems.Friction(
        mu=rng.uniform(0.01, 0.5),
        A=rng.uniform(0.05, 0.6),
        Omega=rng.uniform(0.6, 1.5),
        r=0.8,
        f=f,
        G=rng.uniform(-0.02, 0.02),
    )
    begin = (0.1, rng.uniform(-1, 1), 0.1 - rng.uniform(-0.5, 0.5), rng.uniform(-1, 1))
    phi = rng.uniform(0, 6)
    run = vines.simulate(p, **dict(zip(("x1", "v1", "x2", "v2"), begin, strict=True)), phi=phi, periods=3)
    ours = [row for row in run.events if row["kind"] in (IMPACT, STOP, SLIDE)]
    sticking = [row["t"] for row in run.events if row["kind"] == STICK]
    until = min([*sticking[:1], run.t_end]) - 0.2
    theirs = [each for each in integrated(p, begin, phi, until) if each[1] < until]
    ours = [each for each in ours if each["t"] < until][: len(theirs)]
    assert [each["kind"] for each in ours] == [each[0] for each in theirs]
    assert len(ours) > 3
    for row, (_, t, x1, v1) in zip(ours, theirs, strict=True):
        assert (row["t"], row["x1"], row["v1"]) == pytest.approx((t, x1, v1), abs=2e-8)
    assert run.measures().balance == pytest.approx(0, abs=1e-12)


def test_a_stop_ends_where_the_frame_pulls_harder_than_friction():
    p = systems.Friction(mu=0.1, A=0.3, f=0.3, G=0.05)
    run = vines.simulate(p, periods=40)
    rows = run.rows
    kinds = rows[:, 0].astype(int)
    stops = np.flatnonzero(kinds == STOP)
    assert len(stops) > 5
    for k in stops[:-1]:
        following = run.events[k + 1]
        assert following["kind"] == SLIDE
        force = p.A * (math.sin(following["phase"]) + p.lam * p.Omega * math.cos(following["phase"]))
        a = (force - p.lam * following["v1"] - following["x1"] - p.mu * p.G) / (1 + p.mu)
        assert abs(a + p.G) == pytest.approx(p.f, abs=1e-12)
        assert following["side"] == math.copysign(1, a + p.G)
        assert rows[k, 11] == pytest.approx(following["x1"] - following["x2"], abs=1e-14)
    assert run.measures().balance == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(("x1", "held"), [(0.05, True), (0.5, False)])
def test_a_ball_at_rest_stays_where_friction_holds_it(x1, held):
    run = vines.simulate(systems.Friction(mu=0.1, A=0.0, f=0.1), x1=x1, v1=0.0, x2=x1 - 0.3, v2=0.0, periods=2)
    assert bool(run.events["kind"][1] == STOP) is held
    if held:
        assert len(run.events) == 3
        assert run.final["x1"] - run.final["x2"] == pytest.approx(0.3, abs=1e-15)
        assert run.measures().travel_loss == 0


@pytest.mark.parametrize(("f", "periods", "begin"), [
    (0.05, 1.3, {"x1": 0.1, "v1": 1.0, "x2": -0.2, "v2": -0.4}),
    (0.45, 2.2, {"x1": 0.1, "v1": 1.0, "x2": -0.2, "v2": -0.4}),
])  # fmt: skip
def test_tangent_map_is_the_derivative_of_the_run(f, periods, begin):
    p = systems.Friction(mu=0.3, A=0.4, f=f, r=0.7)
    run = vines.simulate(p, **begin, phi=0.3, periods=periods)
    kinds = set(run.events["kind"].tolist())
    assert (STOP in kinds) is (f > 0.1)
    assert SLIDE in kinds
    assert STICK not in kinds
    h = 1e-6
    columns = []
    for name, value in begin.items():
        ends = [
            np.array([
                vines.simulate(p, **{**begin, name: value + step}, phi=0.3, periods=periods).final[key] for key in begin
            ])
            for step in (h, -h)
        ]  # fmt: skip
        columns.append((ends[0] - ends[1]) / (2 * h))
    assert tangent_map(run) == pytest.approx(np.column_stack(columns), rel=1e-6, abs=1e-6)


def test_what_it_settles_to_and_the_power_of_friction():
    p = systems.Friction(mu=0.02, A=0.02, f=0.02)
    found = vines.settle(p, settle=300)
    assert (found.regime, found.word) == ("periodic", "LR")
    run = vines.simulate(
        p, **{key: found.final[key] for key in ("x1", "v1", "x2", "v2")}, phi=found.final["phase"], periods=1
    )
    states = run.sample(100_001)
    mean = np.trapezoid(np.abs(states["v1"] - states["v2"]), states["t"])
    assert run.measures().travel_loss == pytest.approx(p.mu * p.f * mean, rel=1e-5)


def test_words_have_a_letter_for_stops():
    word = Word("RsLs")
    assert (str(word), word.sides, word.n, word.m, word.name, word.symmetric) == (
        "LsRs",
        (1, 0, -1, 0),
        1,
        1,
        "1:1",
        True,
    )
    with pytest.raises(ParameterError, match="not a word"):
        Word("LSR")


def test_a_transient_ends_at_rest():
    found = decay(vines.simulate(systems.Friction(mu=0.02, A=0.0, f=0.05), v1=2.0, v2=0.0, periods=40))
    assert found.travel_share > 0.01
    whole = (found.impact_share, found.damper_share, found.travel_share, found.frame_share, found.ball_share)
    assert sum(whole) == pytest.approx(1, abs=1e-12)


def test_chatter_with_friction_ends_on_the_wall_or_beside_it():
    p = systems.Friction(mu=0.05, A=2.0, r=0.4, f=0.2)
    run = vines.simulate(p, periods=12)
    assert len(run.sticks) > 2
    assert run.status == "complete"
    assert run.measures().balance == pytest.approx(0, abs=1e-13 * run.measures().base_work)
    chatters = np.flatnonzero(run.events["kind"] == STICK)
    for spell, row in zip(run.sticks, chatters, strict=True):
        before = run.events[:row]
        hits = np.flatnonzero((before["kind"] == IMPACT) & (before["side"] == spell["side"]))
        assert spell["impacts"] == len(hits[len(hits) - spell["impacts"] :]) >= 1
        own = before[hits[-spell["impacts"] :][0] :]
        assert set(own["kind"].tolist()) <= {IMPACT, SLIDE}
    released = run.events[run.events["kind"] == RELEASE]
    for each in released:
        force = p.A * (math.sin(each["phase"]) + p.lam * p.Omega * math.cos(each["phase"]))
        a = (force - p.lam * each["v1"] - each["x1"]) / (1 + p.mu)
        assert each["side"] * a == pytest.approx(-p.f, abs=1e-10)


def test_orbits_without_friction_are_those_of_the_vi_nes():
    orbit = vines.find_orbit("LR", systems.Friction(mu=0.02, A=0.03))
    model = vines.find_orbit("LR", vines.Params(mu=0.02, A=0.03))
    assert orbit.states == pytest.approx(model.states, abs=1e-12)
    assert orbit.multipliers == pytest.approx(model.multipliers, abs=1e-11)


@pytest.mark.parametrize(("word", "A", "mu", "f"), [("LLsR", 0.2, 0.1, 0.3), ("LsR", 0.3, 0.3, 0.2)])
def test_orbits_with_stops(word, A, mu, f):
    p = systems.Friction(mu=mu, A=A, f=f, r=0.7)
    orbit = vines.find_orbit(word, p)
    assert (str(orbit.word), orbit.stable) == (word, True)
    assert orbit.residual < 1e-11
    assert abs(orbit.energy_imbalance) < 1e-12
    # A stop forgets with which velocity the ball came.
    assert abs(orbit.multipliers[-1]) < 1e-12
    run = vines.simulate(p, **orbit.start(), periods=30)
    kinds = run.rows[np.isin(run.rows[:, 0], (IMPACT, STOP))]
    met = "".join("s" if row[0] == STOP else "L" if row[1] > 0 else "R" for row in kinds[: len(word)])
    assert met == word[1:] + word[0]
    ends = kinds[len(word) - 1 :: len(word)]
    assert np.abs(ends[:, 5] - orbit.states[0, 0]).max() < 1e-9
    late = vines.simulate(p, **{**orbit.start(), "v2": orbit.start()["v2"] + 1e-3}, periods=1 + orbit.word.p * 12)
    assert "s" in word
    assert late.measures(last=1).travel_loss == pytest.approx(orbit.measures.travel_loss, rel=0.05)


def test_a_branch_through_its_symmetry_breaking_by_differences():
    p = systems.Friction(mu=0.02, A=0.028, f=0.02)
    branch = vines.continue_orbit(vines.find_orbit("LR", p), "A", 0.031)
    (broken,) = branch.bifurcations
    assert broken.type == "symmetry_breaking"
    orbit = broken.orbit

    def later(z):
        """Return the mirror image of the state half a period later: the run, not its tangent map."""
        names = ("x1", "v1", "x2", "v2")
        at = dict(zip(names, z, strict=True))
        end = vines.simulate(orbit.params, **at, phi=orbit.phase[0] + 0.7, periods=0.5).final
        return -np.array([end[name] for name in names])

    inside = vines.simulate(orbit.params, **orbit.start(), periods=0.7 / (2 * math.pi)).final
    z = np.array([inside[name] for name in ("x1", "v1", "x2", "v2")])
    assert later(z) == pytest.approx(z, abs=1e-10)
    slope = np.column_stack([(later(z + e) - later(z - e)) / 2e-6 for e in 1e-6 * np.eye(4)])
    assert np.linalg.eigvals(slope).real.min() == pytest.approx(-1, abs=1e-5)


def test_stops_are_of_systems_with_friction():
    with pytest.raises(ParameterError, match="never stops in mid-cavity"):
        vines.find_orbit("LsR", vines.Params(mu=0.02, A=0.03))
    with pytest.raises(ParameterError, match="no impact"):
        vines.find_orbit("ss", systems.Friction(mu=0.02, A=0.03, f=0.3))


def test_a_ball_that_slides_to_and_fro_is_named_and_the_rest_of_it_too():
    p = systems.Friction(mu=0.3, A=0.03, f=0.02, lam=0.1)
    attractor = vines.settle(p, v2=0.02)
    assert (attractor.regime, attractor.name, attractor.settled) == ("no_impact", "0:0", True)
    # Where in the cavity it slides makes no difference.
    assert np.abs(attractor.multipliers - 1).min() < 1e-9
    assert np.sort(np.abs(attractor.multipliers))[-2] < 0.8
    final = attractor.final
    turns = integrated(p, [final[name] for name in ("x1", "v1", "x2", "v2")], final["phase"], 2 * p.period)
    assert [kind for kind, *_ in turns] == [SLIDE] * 4
    for (_, t, x1, v1), (_, later, x, v) in zip(turns[:2], turns[2:], strict=True):
        assert (later - t, x, v) == pytest.approx((p.period, x1, v1), abs=1e-8)
    assert vines.settle(p.replace(f=5.0)).name == "0:0"
    # With a tilt it sinks to the lower end, and hits.
    assert vines.settle(p.replace(G=0.002), v2=0.02).regime != "no_impact"
