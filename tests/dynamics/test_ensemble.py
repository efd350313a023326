"""Ensembles in lanes: flight by flight as the scalar kernel, the same however many cores, small, and refused kindly."""

from __future__ import annotations

import itertools
import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vines.dynamics import _advance as col
from vines.dynamics import ensemble, lyapunov_spectrum, no_ball, simulate
from vines.dynamics._advance import advance, new_state, set_state
from vines.dynamics._room import constants
from vines.errors import ParameterError, StateError
from vines.model import Params

BASE = Params(mu=0.01, A=0.02)


def _flights_off(p: Params, starts: dict[str, np.ndarray], periods: float) -> tuple[int, float]:
    """Check every flight of an ensemble against the scalar kernel; return how many there were and the worst."""
    many = ensemble(p, starts, periods=periods, record="impacts", max_impacts_per_period=400)
    c, flights, worst = constants(p), 0, 0.0
    rows = np.zeros((1, col.ROW))
    hits = many.impacts
    assert hits is not None
    for a, b in itertools.pairwise(hits):
        # Hops of a chatter lower than the rounding of the forced motion are beyond doubles, in lanes and out of them.
        unresolved = (a["v1_after"] - a["v2_after"]) ** 2 < 1e-10 * (1.0 + no_ball(p))
        if a["run"] != b["run"] or unresolved:
            continue
        state = new_state()
        set_state(state, a["x1"], a["v1_after"], a["x2"], a["v2_after"], a["phase"], 0.0)
        advance(c, state, b["t"] - a["t"] + 1.0, 1000, rows, 0)
        row = rows[0]
        if row[col.KIND] != col.IMPACT:  # a chatter that ends here
            continue
        flights += 1
        assert row[col.SIDE] == b["side"]
        closing = abs(row[col.V1] - row[col.V2])
        size = 1.0 + abs(a["x1"]) + abs(a["x2"]) + no_ball(p)
        worst = max(worst, abs(row[col.TAU] - (b["t"] - a["t"])) * closing / size)
    return flights, worst


@settings(max_examples=25, deadline=None)
@given(
    mu=st.floats(-6, 1),
    A=st.sampled_from([0.0, 1e-3, 0.02, 0.3, 3.0, 10.0]),
    Omega=st.one_of(st.floats(0.05, 5.0), st.floats(0.98, 1.02)),
    r=st.sampled_from([0.0, 0.3, 0.65, 0.99, 1.0]),
    lam=st.sampled_from([1e-3, 0.012, 0.2, 1.5]),
    seed=st.integers(0, 1000),
)
def test_every_flight_is_that_of_the_scalar_kernel(
    mu: float, A: float, Omega: float, r: float, lam: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    x1, w = rng.uniform(-1, 1, 70), rng.uniform(-1, 1, 70)
    starts = {"x1": x1, "v1": rng.uniform(-1, 1, 70), "x2": x1 - w, "v2": rng.uniform(-2, 2, 70)}
    starts["phase"] = rng.uniform(0, 2 * math.pi, 70)
    p = Params(mu=10**mu, A=A, Omega=Omega, r=r, lam=lam)
    _, worst = _flights_off(p, starts, 4.0)
    # A long flight adds up more roundings; times are read off the phase.
    assert worst < 1e-11


def test_final_states_and_measures_are_those_of_simulate() -> None:
    v2 = np.linspace(0.05, 0.2, 70)
    p = BASE.replace(A=0.0084)
    many = ensemble(p, {"v2": v2}, periods=4.5, record="measures")
    for k in (0, 17, 69):
        run = simulate(p, v2=float(v2[k]), periods=4.5)
        m = run.measures()
        assert many.counts[k] == len(run.impacts)
        for name in ("x1", "v1", "x2", "v2", "phase"):
            assert many.final[name][k] == pytest.approx(run.final[name], abs=1e-9)
        assert many.measures is not None
        for name in many.measures.dtype.names or ():
            if not name.endswith("_error"):
                assert many.measures[name][k] == pytest.approx(getattr(m, name), rel=1e-7, abs=1e-9)


def test_measures_in_lanes_are_those_of_simulate_over_the_range_of_parameters() -> None:
    # Integrals in lanes come from free motion and steady response: near resonance they lose up to five digits.
    rng, compared = np.random.default_rng(8), 0
    for _ in range(24):
        Omega = float(rng.choice([1.0, rng.uniform(0.2, 4.0)]))
        p = Params(
            mu=10 ** rng.uniform(-3, 0), A=10 ** rng.uniform(-2, 0.5), Omega=Omega, lam=10 ** rng.uniform(-3, -0.1)
        )
        v2 = rng.uniform(0.05, 1.0, 4)
        many = ensemble(p, {"v2": v2}, periods=2.7, record="measures", max_impacts_per_period=300)
        assert many.measures is not None
        for k in range(4):
            run = simulate(p, v2=float(v2[k]), periods=2.7, max_impacts_per_period=300)
            same = many.counts[k] == len(run.impacts) and abs(many.final["x1"][k] - run.final["x1"]) < 1e-9
            if run.status != "complete" or not same:
                continue
            compared += 1
            m = run.measures()
            for name in many.measures.dtype.names or ():
                if not name.endswith("_error"):
                    size = 1e-10 * (m.max_abs_x1**2 + m.duration) if name in ("base_work", "energy_change") else 1e-12
                    assert many.measures[name][k] == pytest.approx(getattr(m, name), rel=1e-8, abs=size), (name, p)
    assert compared > 60


def test_a_chatter_merges_at_the_same_impact_in_lanes() -> None:
    merges = 0
    for mu, A in ((0.0084, 0.015), (0.05, 0.015), (0.3, 0.05)):
        p, v2 = Params(mu=mu, A=A), np.linspace(0.05, 0.15, 60)
        many = ensemble(p, {"v2": v2}, periods=12, record="impacts").impacts
        assert many is not None
        for k in range(60):
            run = simulate(p, v2=float(v2[k]), periods=12)
            if not len(run.sticks):
                continue
            # Up to the first merge, whose hops are the smallest, nothing but rounding differs.
            merges += 1
            ours = many["t"][many["run"] == k]
            n = int(np.sum(run.impacts["t"] <= run.events["t"][run.events["kind"] == 2][0]))
            assert ours[:n] == pytest.approx(run.impacts["t"][:n], abs=1e-6)
            assert len(ours) == n or ours[n] - ours[n - 1] > 1e-3
    assert merges >= 10


def test_chatter_and_sticking_are_the_same_in_lanes() -> None:
    p = Params(mu=0.0084, A=0.015)
    many = ensemble(p, periods=10, record="measures")
    run = simulate(p, periods=10)
    m = run.measures()
    assert many.counts[0] == len(run.impacts)
    assert many.measures is not None
    assert many.measures["sticks_right"][0] == m.sticks_right == 1
    assert many.measures["impact_loss_right"][0] == pytest.approx(m.impact_loss_right, rel=1e-8)
    assert many.final["x1"][0] == pytest.approx(run.final["x1"], abs=1e-8)


def test_results_do_not_depend_on_cores_or_neighbours() -> None:
    A = np.linspace(0.01, 0.1, 300)
    one = ensemble({"mu": 0.01, "A": A}, periods=40, record="measures", lyapunov=True, threads=1)
    two = ensemble({"mu": 0.01, "A": A}, periods=40, record="measures", lyapunov=True, threads=2)
    alone = ensemble({"mu": 0.01, "A": A[123]}, periods=40, record="measures", lyapunov=True)
    assert one.measures is not None
    assert two.measures is not None
    assert alone.measures is not None
    assert one.exponents is not None
    assert two.exponents is not None
    assert np.array_equal(one.final, two.final)
    assert one.measures.tobytes() == two.measures.tobytes()
    assert np.array_equal(one.exponents, two.exponents)
    assert one.measures[123].tobytes() == alone.measures[0].tobytes()


def test_energy_balances_in_every_trajectory() -> None:
    rng = np.random.default_rng(5)
    n = 200
    table = {"mu": 10 ** rng.uniform(-3, 0, n), "A": 10 ** rng.uniform(-2, 0.5, n), "Omega": rng.uniform(0.1, 4, n)}
    table |= {"r": rng.uniform(0, 1, n), "lam": rng.uniform(0.001, 0.5, n)}
    m = ensemble(table, settle=3.3, periods=7.7, record="measures", max_impacts_per_period=500).measures
    assert m is not None
    balance = m["base_work"] - m["damper_loss"] - m["impact_loss_left"] - m["impact_loss_right"] - m["energy_change"]
    scale = np.abs(m["base_work"]) + m["damper_loss"] + m["impact_loss_left"] + m["max_abs_x1"] ** 2 + table["A"] ** 2
    assert np.max(np.abs(balance) / scale) < 1e-11


def test_exponents_are_those_of_one_run_and_obey_the_sum_rule() -> None:
    p = BASE.replace(A=0.03)
    many = ensemble(p, {"v2": [0.1, 0.11]}, periods=400, record="impacts", lyapunov=True)
    assert many.exponents is not None
    assert many.impacts is not None
    hits = np.bincount(many.impacts["run"])
    sums = -p.lam + 2 * hits / (400 * p.period) * math.log(p.r)
    assert many.exponents.sum(axis=1) == pytest.approx(sums, abs=1e-8)
    alone, errors = lyapunov_spectrum(simulate(p, periods=400))
    assert abs(many.exponents[0, 0] - alone[0]) < 5 * errors[0]


def test_standard_errors_are_the_scatter_between_runs() -> None:
    # Chaos: the measures of independent runs scatter as the errors that each run gives by itself, where it gives any.
    p = BASE.replace(A=0.03)
    many = ensemble(p, {"v2": np.linspace(0.05, 0.2, 128)}, settle=200, periods=1200, record="measures", lyapunov=True)
    m = many.measures
    assert m is not None
    assert many.exponents is not None
    assert many.exponent_errors is not None
    for name in ("kinetic_ratio", "rms_x1"):
        z = (m[name] - np.mean(m[name])) / m[f"{name}_error"]
        told = np.isfinite(z)
        assert np.mean(told) > 0.4
        assert 0.7 < np.mean(z[told] ** 2) < 1.4
        assert np.mean(np.abs(z[told]) > 3) < 0.03
    z = (many.exponents[:, 0] - np.mean(many.exponents[:, 0])) / many.exponent_errors[:, 0]
    assert np.mean(np.isfinite(z)) > 0.95
    assert 0.5 < np.nanmean(z**2) < 1.4
    assert np.all(np.diff(many.exponents, axis=1) <= 0)
    # The largest displacement of chaos grows with the time: from inside it there is no error.
    assert np.isnan(m["max_abs_x1_error"]).all()


def test_exponents_have_errors_where_a_part_of_the_time_is_without_impacts() -> None:
    # Twelve impacts or so in 40 periods: most of the 32 parts have none.
    rng = np.random.default_rng(2)
    n = 200
    points = {
        "mu": 10 ** rng.uniform(-2.5, 0.5, n),
        "A": 10 ** rng.uniform(-2, 0, n),
        "Omega": rng.uniform(0.5, 1.5, n),
    }
    many = ensemble({**points, "r": rng.uniform(0.3, 0.9, n), "lam": 0.1}, settle=50, periods=40, lyapunov=True)
    assert many.exponents is not None
    assert many.exponent_errors is not None
    struck = many.counts > 60
    assert np.mean(np.isfinite(many.exponent_errors[struck, 0])) > 0.9


def test_standard_errors_vanish_on_a_periodic_orbit_and_are_nan_for_a_run_cut_short() -> None:
    p = BASE.replace(A=0.015)
    m = ensemble(p, {"v2": [0.1]}, settle=3000, periods=16, record="measures").measures
    assert m is not None
    for name in ("kinetic_ratio", "max_abs_x1", "rms_x1"):
        assert m[f"{name}_error"][0] < 1e-8 * m[name][0]
    cut = ensemble(Params(mu=0.0084, A=0.015), periods=20, record="measures", max_impacts_per_period=8).measures
    assert cut is not None
    assert math.isnan(cut["kinetic_ratio_error"][0])


def test_a_stable_orbit_in_lanes_keeps_its_impact_velocity_to_1e_12() -> None:
    many = ensemble(
        BASE.replace(A=0.015), {"v2": np.linspace(0.09, 0.11, 64)}, settle=20_000, periods=2, record="impacts"
    )
    assert many.impacts is not None
    speed = np.abs(many.impacts["w_dot"])
    assert np.ptp(speed) < 1e-12


def test_a_ball_nearly_at_rest_for_thousands_of_periods_is_the_same_in_lanes() -> None:
    # A flight of 664 periods and more, after which nothing is left of the oscillator's free motion.
    p = Params(mu=0.3223336297, A=0.0598649267, Omega=0.7890678871, r=0.5555934577, lam=0.2778472002)
    start = {"x1": -0.0429024104, "v1": 0.1055075145, "x2": 0.5297496496, "v2": -6.4191e-5}
    alone = simulate(p, **start, periods=4000)
    many = ensemble(p, {name: [value] for name, value in start.items()}, periods=4000, record="measures", lyapunov=True)
    assert np.diff(alone.impacts["t"], prepend=0.0).max() > 1000 * p.period
    assert np.isfinite(many.final["x1"]).all()
    assert many.measures is not None
    assert many.measures["duration"][0] == pytest.approx(4000 * p.period)
    # No closer: chaos follows the long flight.
    assert many.measures["rms_x1"][0] == pytest.approx(alone.measures().rms_x1, rel=0.05)
    rest = ensemble(p, {name: [value] for name, value in start.items()}, periods=1000)
    assert rest.final["x1"][0] == pytest.approx(alone.sample(times=[1000 * p.period])["x1"][0], abs=1e-9)


def test_caps_are_statuses() -> None:
    many = ensemble(Params(mu=0.0084, A=0.015), {"v2": [0.1, 0.1]}, periods=20, max_impacts_per_period=8)
    assert many.status.tolist() == ["impact_cap", "impact_cap"]
    assert np.isfinite(many.final["x1"]).all()


def test_no_more_memory_than_its_arrays() -> None:
    n = 20_000
    starts = {"v2": np.linspace(0.0, 0.2, n)}
    ensemble(BASE, {"v2": [0.1]}, periods=0.1, record="measures")
    tracemalloc.start()
    ensemble(BASE, starts, periods=0.2, record="measures")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak / n < 900, "bytes a trajectory; 1e6 of them in less than 1 GB"


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (({"mu": 0.01, "A": [0.1, -1.0]},), ParameterError, "A is -1, allowed is 0 <= A <= 10000"),
        (({"mu": 0.01},), ParameterError, "'A' is missing"),
        (({"mu": 0.01, "A": 0.1, "omega": 1},), ParameterError, "unknown parameter 'omega': did you mean 'Omega'"),
        (({"mu": [0.1, 0.2], "A": [1, 2, 3]},), ParameterError, "different lengths"),
        ((BASE, {"x2": [0.0, 1.5]}), StateError, "gap w = x1 - x2 is -1.5 at start 1"),
        ((BASE, {"v2": [math.nan]}), StateError, "start 0 is not finite"),
        ((BASE, {"v3": [1.0]}), StateError, "unknown start 'v3'"),
        (([],), ParameterError, "params is empty"),
    ],
)
def test_bad_input_is_refused_in_one_line(arguments: tuple, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message) as caught:
        ensemble(*arguments)
    assert "\n" not in str(caught.value)


def test_bad_options_are_refused() -> None:
    with pytest.raises(StateError, match="record is 'all'"):
        ensemble(BASE, record="all")  # type: ignore[arg-type]
    with pytest.raises(StateError, match="periods is 0"):
        ensemble(BASE, periods=0)
