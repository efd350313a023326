"""Balls in parallel cavities: numbers of an independent prototype, DOP853, limits, ties, balances."""

from __future__ import annotations

import math

import numpy as np
import pytest
from llvmlite.binding import get_host_cpu_features
from scipy.integrate import solve_ivp

import vines
from vines.dynamics import tangent_map
from vines.errors import ParameterError, StateError
from vines.systems import Parallel

TWO = Parallel(mu=(0.01, 0.01), beta=(1.0, 1.4), A=0.03)


def ratios(measures):
    return [ball.kinetic_ratio for ball in measures.balls]


@pytest.mark.parametrize(
    ("p", "v2", "word", "kinetic", "largest"),
    [
        (Parallel(mu=(0.01, 0.01), A=0.03), (0.1, -0.3), "L1L2R2R1L2L1R1R2/2T", [0.047662923285] * 2, 0.670138338279),
        (TWO, (0.1, -0.3), "L1L2R1R2", [0.066644811441, 0.103992311198], 0.513485645719),
        (Parallel(mu=(0.01, 0.01), A=0.02), (0.1, -0.3), "L1L2R1R2", [0.267015893511, 0.260509557024], 0.197816680784),
    ],
)
def test_settled_runs_have_the_numbers_of_the_prototype(p, v2, word, kinetic, largest):
    found = vines.settle(p, v2=v2, patience=8000)
    assert (found.regime, found.word) == ("periodic", word)
    assert found.name == ("2:2|2:2/2T" if "/" in word else "1:1|1:1")
    assert sorted(ratios(found.measures)) == pytest.approx(sorted(kinetic), abs=2e-11)
    assert found.measures.max_abs_x1 == pytest.approx(largest, abs=2e-10)
    assert abs(found.measures.balance) < 1e-12
    hits = [p.r[ball - 1] ** 2 for ball in vines.Word(word).balls]
    expected = math.prod(hits) * math.exp(-p.lam * found.p * p.period)
    assert np.prod(found.multipliers).real == pytest.approx(expected, rel=1e-10)


def test_three_balls_of_three_lengths():
    p = Parallel(mu=(0.01, 0.006, 0.004), beta=(1.0, 1.2, 1.4), A=0.03)
    m = vines.simulate(p, v2=(0.1, -0.3, 0.2), periods=1500).measures(last=100)
    assert ratios(m) == pytest.approx([0.059612980750, 0.044944502421, 0.036766643929], abs=1e-11)
    assert m.max_abs_x1 == pytest.approx(0.559914643002, abs=1e-11)
    assert abs(m.balance) < 1e-12


def test_a_tilted_ball():
    """DOP853 gives these to 4e-13; the orbit is no longer its own mirror image."""
    p = Parallel(mu=(0.01,), A=0.02, G=0.01)
    m = vines.simulate(p, v2=0.0, periods=1500).measures(last=100)
    assert m.kinetic_ratio == pytest.approx(0.032446214930, abs=1e-11)
    assert m.max_abs_x1 == pytest.approx(0.920294473734, abs=1e-11)
    orbit = vines.find_orbit("L1R1", p)
    assert orbit.w_dot == pytest.approx([1.57379851321, -1.53533780315], abs=1e-10)
    assert not orbit.symmetric
    assert orbit.measures.kinetic_ratio == pytest.approx(m.kinetic_ratio, abs=1e-11)


@pytest.mark.parametrize(
    ("mu", "A", "Omega"), [(0.01, 0.015, 1.0), (0.1, 0.3, 1.2), (0.0084, 0.015, 1.0), (0.05, 0.1, 1.17)]
)
def test_one_ball_is_the_vi_nes(mu, A, Omega):
    """In these runs to the last bit, where products are fused with sums; docs/dynamics.md, "Several balls"."""
    ours = vines.simulate(Parallel(mu=(mu,), A=A, Omega=Omega), periods=12)
    model = vines.simulate(vines.Params(mu=mu, A=A, Omega=Omega), periods=12)
    n = len(model.impacts)
    assert len(ours.impacts) == n
    if get_host_cpu_features().get("fma"):
        assert np.array_equal(ours.rows[:, : model.rows.shape[1]], model.rows)
    for name in ("t", "side", "x1", "v1", "x2", "v2", "w_dot", "v1_after", "v2_after", "phase"):
        assert ours.impacts[name] == pytest.approx(model.impacts[name], abs=1e-9)
    for name in ("base_work", "damper_loss", "impact_loss", "kinetic_ratio", "max_abs_x1", "rms_x1"):
        assert getattr(ours.measures(), name) == pytest.approx(getattr(model.measures(), name), abs=1e-9)
    assert tangent_map(ours) == pytest.approx(tangent_map(model), rel=1e-6, abs=1e-8)


def test_balls_without_mass_change_nothing():
    p = vines.Params(mu=0.01, A=0.015)
    one = vines.simulate(p, v2=0.1, periods=60)
    two = vines.simulate(Parallel(mu=(0.01, 0.0), A=0.015), v2=(0.1, 0.4), periods=60)
    own = two.impacts[two.impacts["ball"] == 1]
    assert len(own) == len(one.impacts)
    assert own["t"] == pytest.approx(one.impacts["t"], abs=1e-10)
    assert own["w_dot"] == pytest.approx(one.impacts["w_dot"], abs=1e-10)
    assert two.measures().max_abs_x1 == pytest.approx(one.measures().max_abs_x1, abs=1e-10)
    assert two.measures().kinetic_ratio == pytest.approx(one.measures().kinetic_ratio, abs=1e-10)


def test_a_longer_cavity_is_another_amplitude():
    long = vines.simulate(Parallel(mu=(0.02,), beta=1.6, A=0.04), v2=0.16, periods=20)
    unit = vines.simulate(Parallel(mu=(0.02,), A=0.025), v2=0.1, periods=20)
    assert long.impacts["t"] == pytest.approx(unit.impacts["t"], abs=1e-10)
    assert long.impacts["w_dot"] == pytest.approx(1.6 * unit.impacts["w_dot"], abs=1e-10)


def test_equal_balls_that_start_alike_hit_together_and_are_one_ball():
    """By the simultaneous law they are one ball of both masses, as long as the ties last; each is counted."""
    both = vines.simulate(Parallel(mu=(0.01, 0.01), A=0.015), v2=0.1, periods=20)
    one = vines.simulate(vines.Params(mu=0.02, A=0.015), v2=0.1, periods=20)
    hits = both.impacts
    assert np.all(hits["ties"] == 1)
    assert both.measures().ties == len(hits)
    assert hits["t"][::2] == pytest.approx(one.impacts["t"], abs=1e-10)
    assert hits["t"][1::2] == pytest.approx(one.impacts["t"], abs=1e-10)
    assert hits["w_dot"][::2] == pytest.approx(one.impacts["w_dot"], abs=1e-10)
    assert abs(both.measures().balance) < 1e-12


def test_settle_parts_equal_balls_unless_told_not_to():
    p = Parallel(mu=(0.01, 0.01), A=0.02)
    assert vines.settle(p).word == "L1L2R1R2"
    together = vines.settle(p, apart=0.0, ties="together", settle=50, patience=0)
    assert together.measures.ties > 0


def _flown(p, rows, k):
    """Return DOP853's end of the flight from row k to the next, with small steps."""
    row, n = rows[k], p.balls

    def rate(t, y):
        phase = row[4] + p.Omega * t
        force = p.A * (math.sin(phase) + p.lam * p.Omega * math.cos(phase))
        frame = [y[1], force - p.lam * y[1] - y[0]]
        return [*frame, *(each for i in range(n) for each in (y[3 + 2 * i], -p.G))]

    begin = [row[5], row[9], *row[16 : 16 + 2 * n]]
    return solve_ivp(rate, (0, rows[k + 1][3]), begin, "DOP853", rtol=1e-13, atol=1e-14, max_step=0.05)


@pytest.mark.parametrize("seed", range(5))
def test_every_flight_of_random_runs_against_dop853(seed):
    rng = np.random.default_rng(seed)
    p = Parallel(
        mu=rng.uniform(0.005, 0.2, 2), beta=rng.uniform(0.6, 1.6, 2), r=rng.uniform(0.3, 0.9, 2),
        A=rng.uniform(0.05, 0.5), Omega=rng.uniform(0.8, 1.3), G=rng.uniform(-0.02, 0.02),
    )  # fmt: skip
    run = vines.simulate(p, v2=tuple(rng.uniform(-1, 1, 2)), x1=rng.uniform(-0.3, 0.3), periods=5)
    beta = np.array(p.beta)
    flights = 0
    for k in range(len(run.rows) - 1):
        after = run.rows[k + 1]
        if run.rows[k][11] != 0.0 or after[3] < 1e-3:
            continue
        flown = _flown(p, run.rows, k).y
        gaps = np.abs(flown[0] - flown[2::2]) / beta[:, None]
        assert gaps[:, 1:-1].max(initial=0.0) < 1
        ball = int(after[13])
        assert flown[0, -1] == pytest.approx(after[5], abs=1e-11)
        assert flown[1, -1] == pytest.approx(after[6], abs=1e-11)
        assert flown[2 * ball, -1] == pytest.approx(after[7], abs=1e-11)
        assert flown[2 * ball + 1, -1] == pytest.approx(after[8], abs=1e-11)
        if after[0] == 1:
            assert gaps[ball - 1, -1] == pytest.approx(1, abs=1e-11)
        flights += 1
    assert flights > 5
    assert abs(run.measures().balance) < 1e-12


def test_balls_that_ride_together_are_let_go_together():
    p = Parallel(mu=(0.05, 0.02), beta=(1.0, 1.2), A=0.02, r=0.4)
    run = vines.simulate(p, x2=(-1.0, -1.2), v2=(0.0, 0.0), phi=1.0, periods=30)
    assert run.status == "complete"
    spells = run.sticks
    assert len(spells) > 2
    for side in (1, -1):
        own = spells[spells["side"] == side]
        for one in own[own["ball"] == 1]:
            other = own[(own["ball"] == 2) & (own["t_start"] < one["t_release"]) & (own["t_release"] > one["t_start"])]
            if len(other):
                assert other["t_release"][0] == pytest.approx(one["t_release"], abs=1e-12)
    assert abs(run.measures().balance) < 1e-12


def test_a_group_that_rides_is_struck_by_what_hits_the_other_wall():
    """The pair impact comes first; the group leaves with r times the velocity that it gave the frame."""
    p = Parallel(mu=(0.1, 0.2), beta=1.0, r=(0.5, 0.8), A=0.0, lam=0.0)
    # At x1 = -1 the spring pushes the frame, and with it ball 2 on L, to the right wall that ball 1 flies to.
    run = vines.simulate(p, x1=-0.5, v1=0.0, x2=(0.4, -1.5), v2=(0.5, 0.0), periods=0.3)
    rows = run.rows
    assert [int(kind) for kind in rows[1:4, 0]] == [2, 1, 1]
    assert rows[2:4, 13].tolist() == [1.0, 2.0]
    first, second = rows[2], rows[3]
    w = first[6] - first[8]
    kick = -0.1 * 1.5 * w / 1.1
    assert first[9] - first[6] == pytest.approx(kick, abs=1e-13)
    assert second[6] - second[8] == pytest.approx(kick, abs=1e-13)
    assert second[9] - second[10] == pytest.approx(-0.8 * kick, abs=1e-13)
    assert abs(run.measures().balance) < 1e-13


def test_samples_stay_in_the_cavities_and_meet_the_events():
    run = vines.simulate(TWO, v2=(0.1, -0.3), periods=20)
    at = run.sample(2000)
    assert np.abs(at["w_1"]).max() <= 1 + 1e-12
    assert np.abs(at["w_2"]).max() <= 1.4 + 1e-12
    hit = run.sample(times=run.impacts["t"])
    own = np.where(run.impacts["ball"] == 1, hit["w_1"], hit["w_2"] / 1.4)
    assert own == pytest.approx(run.impacts["side"], abs=1e-12)
    assert hit["x1"] == pytest.approx(run.impacts["x1"], abs=1e-12)


@pytest.mark.parametrize("p", [TWO, Parallel(mu=(0.01, 0.01, 0.004), r=(0.3, 0.65, 0.5), A=0.02, G=0.01)])
def test_samples_at_events_close_the_energy_balance(p):
    run = vines.simulate(p, v2=(0.1, -0.3, 0.1)[: p.balls], periods=20)
    at = run.sample(per_period=20, at_events=True)
    balls = range(1, p.balls + 1)
    stored = at["kinetic_1"] + at["potential"] + sum(at[f"kinetic_2_{k}"] + at[f"potential_2_{k}"] for k in balls)
    rest = at["base_work"] - at["damper_loss"] - at["impact_loss"] - (stored - stored[0])
    assert np.abs(rest).max() < 1e-13
    m = run.measures()
    ends = [at[name][-1] for name in ("base_work", "damper_loss", "impact_loss")]
    assert ends == pytest.approx([m.base_work, m.damper_loss, m.impact_loss], abs=1e-14)
    assert (np.diff(at["t"]) >= 0).all()
    for k in balls:
        own = run.impacts[run.impacts["ball"] == k]
        alone = own[[(run.events["t"] == t).sum() == 1 for t in own["t"]]]
        assert len(alone) > 20
        hits = np.searchsorted(at["t"], alone["t"])
        assert at["t"][hits] == pytest.approx(alone["t"], abs=0)
        assert at[f"w_dot_{k}"][hits] == pytest.approx(alone["w_dot"], abs=1e-15)
        assert at[f"w_dot_{k}"][hits + 1] == pytest.approx(alone["v1_after"] - alone["v2_after"], abs=1e-15)
        assert at[f"w_{k}"][hits] == pytest.approx(alone["side"] * p.beta[k - 1], abs=1e-14)
    riding = [(at[f"stuck_{k}"] != 0).any() for k in balls]
    assert riding == [(run.sticks["ball"] == k).any() for k in balls]
    for name in ("start", "release"):
        left = np.isfinite(run.sticks[f"t_{name}"])
        turned = run.sticks[f"phase_{name}"][left] - p.Omega * run.sticks[f"t_{name}"][left]
        assert np.abs(np.sin(turned / 2)).max(initial=0.0) < 1e-12


def test_orbits_are_found_and_followed():
    orbit = vines.find_orbit("L1L2R1R2", TWO)
    assert orbit.symmetric
    assert orbit.admissible
    assert orbit.w_dot == pytest.approx([1.14640548516, 1.43204181301, -1.14640548516, -1.43204181301], abs=1e-10)
    assert ratios(orbit.measures) == pytest.approx([0.066644811441, 0.103992311198], abs=1e-11)
    assert abs(orbit.measures.balance) < 1e-13
    start = orbit.start()
    run = vines.simulate(TWO, **start, periods=1 + 1e-9)
    assert run.impacts["t"] - start["t"] == pytest.approx([*(orbit.t[1:] - orbit.t[0]), TWO.period], abs=1e-11)
    assert run.impacts["w_dot"] == pytest.approx(np.roll(orbit.w_dot, -1), abs=1e-11)
    branch = vines.continue_orbit(orbit, "beta_2", 1.3)
    last = branch.orbits[-1]
    assert last.params.beta == (1.0, 1.3)
    again = vines.find_orbit("L1L2R1R2", last.params, guess=last)
    assert again.w_dot == pytest.approx(last.w_dot, abs=1e-11)


def test_an_orbit_on_which_equal_balls_change_roles():
    """Shifted by T it is itself with the balls exchanged, so that its least period is 2T."""
    p = Parallel(mu=(0.01, 0.01), A=0.03)
    orbit = vines.find_orbit("L1L2R2R1L2L1R1R2/2T", p)
    assert orbit.admissible
    assert orbit.stable
    assert np.sort(orbit.w_dot) == pytest.approx(
        np.repeat([-1.28394614, -1.25183721, 1.26502784, 1.27075552], 2), abs=1e-8
    )
    assert np.prod(orbit.multipliers).real == pytest.approx(0.65**16 * math.exp(-p.lam * 2 * p.period), rel=1e-10)


def test_one_ball_breaks_its_symmetry_where_the_vi_nes_does():
    orbit = vines.find_orbit("L1R1", Parallel(mu=(0.01,), A=0.016))
    model = vines.find_orbit("LR", vines.Params(mu=0.01, A=0.016))
    assert np.abs(orbit.multipliers) == pytest.approx(np.abs(model.multipliers), abs=1e-10)
    assert orbit.min_clearance == pytest.approx(model.min_clearance, abs=1e-12)
    branch = vines.continue_orbit(orbit, "A", 0.02)
    broken = [each.value for each in branch.bifurcations if each.type == "symmetry_breaking"]
    assert broken == pytest.approx([0.0180076066], abs=1e-9)


def test_words_are_those_of_the_system():
    one = Parallel(mu=(0.01,), A=0.016)
    assert vines.settle(one).word == "LR"
    assert str(vines.find_orbit("L1R1", one).word) == "LR"
    assert str(vines.find_orbit("L2L1R2R1", Parallel(mu=(0.01, 0.01), A=0.02)).word) == "L1L2R1R2"
    with pytest.raises(ParameterError, match="each hits"):
        vines.find_orbit("L1R1", TWO)
    with pytest.raises(ParameterError, match="without number"):
        vines.find_orbit("LR", TWO)


def test_what_cannot_be_is_refused():
    with pytest.raises(StateError, match="v2 has 3 values"):
        vines.simulate(TWO, v2=(0.1, 0.2, 0.3))
    with pytest.raises(StateError, match="unknown coordinate 'w'"):
        vines.simulate(TWO, w=0.1)
    with pytest.raises(StateError, match="the gap"):
        vines.simulate(TWO, x2=(0.0, 1.5))
