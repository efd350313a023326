"""Families with friction: where they end, by what runs settle to beside the end; curves, by the VI-NES and by runs."""

from __future__ import annotations

import numpy as np
import pytest

import vines
from vines import find_orbit
from vines.errors import OrbitNotFound
from vines.orbits import all_orbits, continue_orbit, follow_curve, switch_branch
from vines.systems import Friction

PLAIN = {"lam": 0.05}
ENDS = {
    "a turn becomes a stop": (
        Friction(mu=0.188, A=0.29, Omega=0.97, r=0.56, f=0.154, **PLAIN), "LR", 0.285, "crossing_sliding", "LsRs",
    ),
    "a ball stops on its way": (
        Friction(mu=0.021, A=0.18, Omega=0.87, r=0.63, f=0.037, G=0.03, **PLAIN), "LR", 0.19, "grazing_sliding", "LsR",
    ),
    "a stop no longer": (
        Friction(mu=0.017, A=0.141, Omega=1.2, r=0.5, f=0.185, G=0.03, **PLAIN), "LLs/4T", 0.143, "grazing_sliding",
        "LL/4T",
    ),
    "a stop becomes an impact": (
        Friction(mu=0.064, A=0.086, Omega=1.31, r=0.41, f=0.081, G=0.03, **PLAIN), "Ls", 0.08, "grazing", "LLs",
    ),
    "an impact is gone": (
        Friction(mu=0.106, A=0.124, Omega=0.77, r=0.44, f=0.105, G=0.03, **PLAIN), "LLss", 0.13, "grazing", "Lss",
    ),
}  # fmt: skip
"""Parameters, word, how far to follow it in A, the end there, and the word of runs beyond it."""


@pytest.mark.parametrize(
    ("p", "word", "stop", "end", "beyond"),
    [
        pytest.param(*case, id=name, marks=() if k == 1 else pytest.mark.full)
        for k, (name, case) in enumerate(ENDS.items())
    ],
)
def test_a_family_ends_where_runs_take_another_word(p, word, stop, end, beyond):
    branch = continue_orbit(find_orbit(word, p), "A", stop, step=0.3)
    assert branch.ends == ("range", end)
    found, last = branch.bifurcations[-1], branch.orbits[-1]
    assert found.type == end
    assert np.isnan(found.multiplier)
    at = {name: value for name, value in last.start().items() if name != "t"}
    ahead = np.sign(stop - p.A) * 1e-6 * p.A
    words = [
        vines.settle(
            p.replace(A=found.value + move), settle=400, phi=last.phase[0], lyapunov=False, errors=False, **at
        ).word
        for move in (-ahead, ahead)
    ]
    assert words == [word, beyond]


def test_the_loss_of_symmetry_of_an_orbit_that_turns_in_two_parameters():
    branch = continue_orbit(find_orbit("LR", Friction(mu=0.01, A=0.0178, f=0.002)), "A", 0.0182, step=0.3)
    [broken] = branch.bifurcations
    assert broken.type == "symmetry_breaking"
    curve = follow_curve(broken, ("A", "f"), box={"A": (0.0175, 0.0185), "f": (0.0, 0.003)}, step=0.3)
    assert (curve.type, curve.symmetric, curve.ends) == ("symmetry_breaking", True, ("box", "box"))
    without, most = (curve.orbits[int(k)] for k in (np.argmin(curve.values[:, 1]), np.argmax(curve.values[:, 1])))
    # Check value of the VI-NES.
    assert pytest.approx(0.0180076066, abs=5e-11) == without.params.A
    assert np.abs(most.half_multipliers + 1).min() < 1e-9
    before = find_orbit("LR", most.params.replace(A=0.0179), guess=branch.orbits[0])
    [again] = continue_orbit(before, "A", 0.0182, step=0.3).bifurcations
    assert again.value == pytest.approx(most.params.A, abs=1e-12)
    pair = switch_branch(again)
    assert [(str(orbit.word), orbit.symmetric, orbit.stable) for orbit in pair] == [("LR", False, True)] * 2


@pytest.mark.full
def test_a_doubling_in_two_parameters_and_the_family_that_comes_out():
    branch = continue_orbit(find_orbit("LR", Friction(mu=0.01, A=0.0215, f=0.05)), "A", 0.022, step=0.3)
    [doubling] = branch.bifurcations
    assert doubling.type == "period_doubling"
    [doubled] = switch_branch(doubling)
    at = {name: value for name, value in doubled.start().items() if name != "t"}
    attractor = vines.settle(doubled.params, phi=doubled.phase[0], lyapunov=False, errors=False, **at)
    assert (attractor.word, str(doubled.word)) == ("LRLR/2T", "LRLR/2T")
    assert attractor.measures.kinetic_ratio == pytest.approx(doubled.measures.kinetic_ratio, rel=1e-9)
    curve = follow_curve(doubling, ("A", "f"), box={"A": (0.02, 0.023), "f": (0.0, 0.06)}, step=0.3)
    without = curve.orbits[int(np.argmin(curve.values[:, 1]))]
    asymmetric = next(orbit for orbit in all_orbits("LR", vines.Params(mu=0.01, A=0.0203)) if not orbit.symmetric)
    model = continue_orbit(asymmetric, "A", 0.0206).bifurcations
    assert [each.type for each in model] == ["period_doubling"]
    assert pytest.approx(model[0].value, abs=1e-12) == without.params.A


@pytest.mark.full
def test_a_fold_of_an_orbit_that_stops_and_where_its_curve_ends():
    p = Friction(mu=0.1, A=0.22, r=0.7, f=0.3)
    branch = continue_orbit(find_orbit("LLsR", p), "A", 0.23, step=0.3)
    fold, end = branch.bifurcations
    assert (fold.type, end.type) == ("fold", "grazing_sliding")
    curve = follow_curve(fold, ("A", "f"), box={"A": (0.22, 0.23), "f": (0.29, 0.31)}, step=0.3)
    for orbit in (curve.orbits[0], curve.orbits[-1]):
        assert np.abs(orbit.multipliers - 1).min() < 1e-6
        assert abs(orbit.multipliers[-1]) < 1e-12
    with pytest.raises(OrbitNotFound, match="are followed, not of grazing_sliding: locate it on branches"):
        follow_curve(end, ("A", "f"), box={"A": (0.2, 0.23), "f": (0.2, 0.4)})
