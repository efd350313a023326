"""What runs settle to: the four types of Fig. 2, chatter, torus, chaos, no impact, and honest `unsettled`."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from vines.attractors import settle, settle_from
from vines.dynamics import lyapunov_spectrum, no_ball, simulate
from vines.errors import StateError
from vines.model import Params

BASE = Params(mu=0.01, A=0.015)


@pytest.mark.parametrize(
    ("A", "name", "word", "symmetric"),
    [
        (0.015, "1:1", "LR", True),
        (0.020, "1:1", "LR", False),
        (0.021, "2:2/2T", "LRLR/2T", False),
        (0.023, "2:1", "LLR", False),
    ],
)
def test_the_four_types_of_figure_2(A: float, name: str, word: str, symmetric: bool) -> None:
    found = settle(BASE.replace(A=A))
    assert (found.regime, found.settled, found.status) == ("periodic", True, "complete")
    assert (found.name, found.word, found.symmetric) == (name, word, symmetric)
    assert (found.n, found.m) == (word.count("L"), word.count("R"))
    assert found.measures.duration == pytest.approx(found.p * found.params.period)
    assert (found.measures.impacts_left, found.measures.impacts_right) == (found.n, found.m)
    assert found.lyapunov < 0
    assert found.lyapunov_error == found.kinetic_ratio_error == found.max_abs_x1_error == 0.0


def test_a_settled_run_is_within_the_tolerance_of_its_orbit() -> None:
    p = BASE.replace(A=0.02)
    found, later = settle(p), settle(p, settle=5000)
    speeds = [np.sort(a.impacts["w_dot"][-2:]) for a in (found, later)]
    assert np.max(np.abs(speeds[0] - speeds[1])) < 1e-8
    assert found.transient > 400
    assert later.transient == 5000


def test_patience_is_what_settles_a_slow_run() -> None:
    slow = Params(mu=0.05, A=0.1, Omega=1.17)
    p = BASE.replace(A=0.018)
    early = settle(p, patience=0)
    assert (early.regime, early.settled, early.name) == ("unsettled", False, None)
    assert 500 < early.remaining < 20_000
    assert "comes to a periodic orbit" in early.reason
    arrived = settle(p, settle=400 + early.remaining * 1.1, patience=0)
    assert (arrived.regime, arrived.name) == ("periodic", "1:1")
    assert settle(slow).regime in ("periodic", "chaotic", "unsettled")


def test_multipliers_give_the_exponents_that_a_long_run_measures() -> None:
    found = settle(BASE.replace(A=0.023))
    run = simulate(
        found.params,
        **{name: found.final[name] for name in ("x1", "v1", "x2", "v2")},
        phi=found.final["phase"],
        periods=600,
    )
    measured, _ = lyapunov_spectrum(run, skip=100)
    assert np.max(np.abs(np.sort(measured) - np.sort(found.exponents))) < 2e-3
    expected = -found.params.lam + 2 * 3 / found.params.period * math.log(0.65)
    assert found.exponents.sum() == pytest.approx(expected, abs=1e-9)
    assert found.multipliers is not None
    assert abs(np.prod(found.multipliers)) == pytest.approx(math.exp(expected * found.params.period), rel=1e-6)


def _symmetric_orbit(p: Params) -> dict[str, float]:
    """State just before the impact on L of the symmetric 1:1 orbit, in closed form (facts: p odd, here 1)."""
    s, half = complex(-p.lam / 2, math.sqrt(1 - p.lam**2 / 4)), p.period / 2
    q = 1 / (1 + cmath.exp(s * half))
    kappa = (1 + 2 * p.mu - p.r) / (1 + p.r)
    alpha = 2 * p.mu * q.imag / s.imag - half / 2
    beta = (kappa + 2 * p.mu * ((s * q).imag / s.imag - 1)) / p.Omega
    square = alpha**2 + beta**2
    V = (-alpha + math.sqrt(alpha**2 - square * (1 - no_ball(p) ** 2))) / square
    response = p.A * complex(p.lam * p.Omega, -1) / complex(1 - p.Omega**2, p.lam * p.Omega)
    # Re[response e^(i psi)] = 1 + alpha V and its derivative by psi = beta V.
    phase = cmath.phase(complex(1 + alpha * V, -beta * V) / response)
    x1 = 1 - half * V / 2
    return {"x1": x1, "v1": kappa * V, "x2": x1 - 1, "v2": -V, "phase": phase}


def test_the_closed_form_is_where_a_stable_run_settles() -> None:
    orbit = _symmetric_orbit(BASE)
    hits = settle(BASE, settle=2000).impacts
    left = hits[hits["side"] > 0][-1]
    assert [left["x1"], left["v1"], left["v2"]] == pytest.approx([orbit["x1"], orbit["v1"], orbit["v2"]], abs=1e-10)
    assert left["phase"] == pytest.approx(orbit["phase"] % (2 * math.pi), abs=1e-10)


def test_an_unstable_orbit_is_left() -> None:
    # The symmetric 1:1 loses stability at A = .0180; started on it, a run repeats to rounding but is on no attractor.
    p = BASE.replace(A=0.0195)
    found = settle_from(p, _symmetric_orbit(p), settle=4, record=8)
    assert found.reason.startswith("nudged: on an unstable periodic orbit")
    assert (found.regime, found.name, found.symmetric) == ("periodic", "1:1", False)


def test_a_complete_chatter_is_one_contact() -> None:
    p = Params(mu=0.630582, A=0.299886, Omega=1.23057, r=0.287605, lam=0.229229)
    found = settle(p)
    assert (found.regime, found.word) == ("periodic", "L*R*/3T")
    assert found.sticks == pytest.approx(2 / 3)
    assert found.measures.impacts_left > 2
    assert np.isneginf(found.exponents[-1])


def test_no_impact_is_steady_motion_of_the_oscillator_alone() -> None:
    p = BASE.replace(A=0.002)
    found = settle(p, v2=0.0, settle=1000)
    assert (found.regime, found.settled, len(found.impacts)) == ("no_impact", True, 0)
    assert found.measures.max_abs_x1 == pytest.approx(no_ball(p), rel=1e-8)
    drifting = settle(p, v2=1e-4, settle=10, patience=0)
    assert (drifting.regime, drifting.settled) == ("unsettled", False)
    assert "drifts" in drifting.reason


def test_chaos_has_a_positive_exponent_and_errors() -> None:
    found = settle(BASE.replace(A=0.03))
    assert (found.regime, found.settled, found.name) == ("chaotic", True, None)
    assert found.lyapunov > 3 * found.lyapunov_error > 0
    assert found.kinetic_ratio_error > 0
    assert found.max_abs_x1_error > 0


def test_a_torus_is_neither() -> None:
    found = settle(Params(mu=0.418337, A=0.383689, Omega=1.79425, r=0.880595, lam=0.134795))
    assert (found.regime, found.settled) == ("quasiperiodic", True)
    assert abs(found.lyapunov) < 3 * found.lyapunov_error < 0.01


def test_the_mirror_start_gives_the_mirror_word() -> None:
    p = BASE.replace(A=0.023)
    found = settle(p, v2=-0.1, phi=math.pi)
    assert found.word == "LRR"
    assert found.measures.kinetic_ratio == pytest.approx(settle(p).measures.kinetic_ratio, rel=1e-7)


def test_the_result_does_not_depend_on_where_the_window_is_cut() -> None:
    p = BASE.replace(A=0.021)
    names = {settle(p, settle=1000 + cut, record=64 + 0.3 * cut).word for cut in np.linspace(0.0, 1.0, 9)}
    assert names == {"LRLR/2T"}


def test_a_cap_gives_a_status() -> None:
    found = settle(Params(mu=0.0084, A=0.015), max_impacts_per_period=5)
    assert (found.regime, found.settled, found.status) == ("unsettled", False, "impact_cap")
    assert math.isnan(found.remaining)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"x1": 2.0}, "gap w"),
        ({"settle": -1}, "settle is -1 periods"),
        ({"record": 1}, "record is 1 periods"),
        ({"patience": math.nan}, "patience is nan"),
        ({"tolerance": 0.0}, "tolerance is 0"),
    ],
)
def test_bad_options_are_refused(options: dict[str, float], message: str) -> None:
    with pytest.raises(StateError, match=message):
        settle(BASE, **options)  # type: ignore[arg-type]
