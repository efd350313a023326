"""Beside a bifurcation a run is called unsettled, with about the transient that is left, and not misnamed."""

from __future__ import annotations

import math

import pytest

from vines.attractors import classify_many, settle, settle_from
from vines.model import Params
from vines.orbits import Orbit, all_orbits

TOLERANCE = 1e-10

CASES = {
    # Fig. 11: a pair that turns fast and shrinks slowly.
    "Fig. 11": (Params(mu=0.05, A=0.1, Omega=1.17), "LR", 0.9974164),
    # Symmetry breaks at A = .0180076: symmetric below, the asymmetric pair above.
    "below symmetry breaking": (Params(mu=0.01, A=0.018), "LR", 0.9954669),
    "above symmetry breaking": (Params(mu=0.01, A=0.01801), "LR", 0.9973187),
    # The period doubles at A = .0204744.
    "period doubling": (Params(mu=0.01, A=0.02047), "LR", 0.9969150),
    # A torus is born (or dies) at A = .0212400.
    "Neimark-Sacker": (Params(mu=0.01, A=0.02125), "LLR", 0.9960989),
}


def _beside(word: str, p: Params, off: float) -> tuple[Orbit, dict[str, float]]:
    """Return the stable orbit of a word and a state at a distance from it."""
    orbit = next(orbit for orbit in all_orbits(word, p) if orbit.stable)
    state = dict(orbit.start())
    state["phase"] = p.Omega * state.pop("t") % (2 * math.pi)
    state["v2"] += off
    return orbit, state


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("off", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("watch", [128, 512])
def test_beside_a_bifurcation_the_rest_of_the_transient_is_estimated(case: str, off: float, watch: float) -> None:
    p, word, multiplier = CASES[case]
    orbit, start = _beside(word, p, off)
    assert orbit.max_multiplier == pytest.approx(multiplier, abs=1e-6)
    early = settle_from(p, start, settle=20, patience=0, watch=watch)
    assert (early.regime, early.settled, early.name) == ("unsettled", False, None)
    assert "comes to a periodic orbit" in early.reason
    # An independent value: the linear law from the start on, whose amplitude is known to a factor of a few.
    law = math.log(off / TOLERANCE) / -math.log(multiplier)
    assert early.remaining == pytest.approx(law, abs=2.5 / -math.log(multiplier))
    run = early.transient + early.recorded
    for share, arrived in ((0.75, False), (1.25, True)):
        later = settle_from(p, start, settle=run + share * early.remaining, patience=0, watch=watch)
        assert later.settled is arrived
        assert later.name == (orbit.name if arrived else None)
        assert later.regime == ("periodic" if arrived else "unsettled")


@pytest.mark.parametrize("case", CASES)
def test_many_at_once_say_the_same(case: str) -> None:
    p, word, _ = CASES[case]
    _, start = _beside(word, p, 1e-4)
    many = classify_many(p, {name: [value] for name, value in start.items()}, settle=20, patience=0)
    alone = settle_from(p, start, settle=20, patience=0)
    assert (many.regime[0], many.reason[0]) == ("unsettled", alone.reason)
    assert many.remaining[0] == pytest.approx(alone.remaining, rel=0.1)


@pytest.mark.parametrize(
    "p", [Params(mu=0.00373, A=0.943), Params(mu=0.00885, A=0.0178), Params(mu=0.00513, A=0.0206)], ids=str
)
def test_a_window_too_short_for_the_difference_to_halve_tells_how_long_a_run_still_needs(p: Params) -> None:
    # The first sticks once a period, after 34 impacts: no closing equations hold there.
    early = classify_many(p, settle=100, patience=0).attractor(0)
    assert (early.regime, early.recorded) == ("unsettled", 16)
    assert "comes to a periodic orbit" in early.reason
    run = early.transient + early.recorded
    for share, arrived in ((0.75, False), (1.25, True)):
        assert settle(p, settle=run + share * early.remaining, patience=0).settled is arrived


def test_all_along_the_way_next_to_a_doubling_nothing_is_misnamed() -> None:
    """Where the last differences are near the tolerance a doubled name would come out if one looked at 2T alone."""
    p, word, _ = CASES["period doubling"]
    _, start = _beside(word, p, 1e-4)
    told = {settle_from(p, start, settle=k, patience=0).name for k in range(3000, 5200, 20)}
    assert told == {None, "1:1"}


def test_patience_is_used_up_before_a_run_is_given_up() -> None:
    p, word, _ = CASES["below symmetry breaking"]
    orbit, start = _beside(word, p, 1e-2)
    assert settle_from(p, start, settle=20, patience=5000).name == orbit.name
    late = settle_from(p, start, settle=20, patience=2000)
    assert (late.regime, late.settled) == ("unsettled", False)
    assert 500 < late.remaining + late.transient < 5000


def test_a_ball_at_rest_for_long_in_chaos_is_not_said_to_be_on_a_torus() -> None:
    # Without the ball's impacts the mass stays off the walls, so a ball that has come nearly to rest drifts for long.
    p = Params(mu=0.0124458, A=0.0635328, Omega=1.11182, r=0.40324)
    found = settle_from(p, {"x1": 0.0, "v1": 0.0, "x2": 0.0, "v2": 3e-6, "phase": 0.0}, settle=400, watch=64)
    assert (found.regime, found.settled) == ("unsettled", False)
    assert "drifts" in found.reason or "at rest" in found.reason
    assert found.remaining > 1000
