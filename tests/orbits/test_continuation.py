import math

import numpy as np
import pytest

from vines.errors import ParameterError
from vines.model import Params
from vines.orbits import (
    bifurcation_row,
    branch_row,
    continue_orbit,
    find_orbit,
    orbit_row,
    symmetric_fold,
    symmetric_orbits,
)

P = Params(mu=0.01, A=0.015)


@pytest.fixture(scope="module")
def up():
    return continue_orbit(find_orbit("LR", P), "A", 0.024)


@pytest.fixture(scope="module")
def down():
    return continue_orbit(find_orbit("LR", P), "A", 0.006)


def bisect(outside, low, high):
    """The parameter at which a yes or no changes, by bisection to the last digits."""
    assert outside(low) != outside(high)
    while high - low > 1e-13:
        middle = (low + high) / 2
        low, high = (middle, high) if outside(middle) == outside(low) else (low, middle)
    return (low + high) / 2


def large(A):
    return symmetric_orbits(P.replace(A=A))[0]


def test_symmetry_breaks_where_the_paper_says(up):
    [breaking] = up.bifurcations
    assert breaking.type == "symmetry_breaking"
    assert breaking.value == pytest.approx(0.0180, abs=5e-5)
    assert breaking.half_multiplier == pytest.approx(-1, abs=1e-11)
    assert breaking.multiplier == pytest.approx(1, abs=1e-11)
    assert breaking.value == pytest.approx(bisect(lambda A: large(A).stable, 0.0175, 0.0185), abs=1e-10)
    assert up.ends == ("range", "range")
    assert up.values[0] == 0.015
    assert up.values[-1] == 0.024


def test_a_pair_turns_real_near_where_the_paper_says(up):
    [event] = up.events
    assert event.type == "pair_turns_real"
    assert event.value == pytest.approx(0.0172, abs=2e-4)
    real = bisect(lambda A: bool(np.abs(large(A).multipliers.imag).min() > 0), 0.0171, 0.0175)
    assert event.value == pytest.approx(real, abs=1e-10)


def test_stability_changes_only_at_bifurcations(up, down):
    for branch in (up, down):
        marks = [b.orbit for b in branch.bifurcations]
        for before, after in zip(branch.orbits, branch.orbits[1:], strict=False):
            if before in marks or after in marks:
                continue
            assert before.stable == after.stable


def test_the_fold_is_that_of_the_formula(down):
    fold = next(b for b in down.bifurcations if b.type == "fold")
    assert fold.value == pytest.approx(symmetric_fold(P).A, abs=1e-12)
    assert fold.half_multiplier == pytest.approx(1, abs=1e-7)
    assert down.values.min() == pytest.approx(fold.value, abs=1e-12)


def test_the_large_orbit_gains_stability_at_a_neimark_sacker_point(down):
    assert [b.type for b in down.bifurcations] == ["neimark_sacker", "fold", "grazing"]
    torus = down.bifurcations[0]
    assert abs(torus.multiplier) == pytest.approx(1, abs=1e-11)
    assert abs(torus.multiplier.imag) > 0.1
    assert torus.value == pytest.approx(bisect(lambda A: large(A).stable, 0.009, 0.01), abs=1e-10)


def test_beyond_the_fold_the_branch_comes_back_on_the_other_sheet(down):
    impact = np.array([orbit.w_dot[0] for orbit in down.orbits])
    assert np.all(np.diff(impact) < 0)
    assert down.ends == ("range", "grazing")
    assert down.orbits[-1].admissible
    beyond = continue_orbit(find_orbit("LR", P), "A", 0.006, beyond_grazing=True)
    assert not beyond.orbits[-1].admissible


@pytest.mark.parametrize(
    ("parameter", "stop"),
    [("Omega", 0.9), ("Omega", 1.2), ("mu", 0.3), ("mu", 0.001), ("r", 0.05), ("r", 1.0), ("lam", 0.3), ("lam", 1e-4)],
)
def test_every_parameter_can_be_followed(parameter, stop):
    branch = continue_orbit(find_orbit("LR", P.replace(A=0.017)), parameter, stop)
    assert len(branch.orbits) > 20
    assert max(orbit.residual for orbit in branch.orbits) < 1e-12
    low, high = sorted((getattr(P.replace(A=0.017), parameter), stop))
    assert branch.values.min() >= low
    assert branch.values.max() <= high
    assert branch.ends[1] in ("range", "grazing")
    for b in branch.bifurcations:
        m = b.half_multiplier
        if b.type == "fold":
            assert m == pytest.approx(1, abs=1e-7)
        elif b.type == "symmetry_breaking":
            assert m == pytest.approx(-1, abs=1e-10)
        elif b.type == "neimark_sacker":
            assert abs(m) == pytest.approx(1, abs=1e-10)
        else:
            assert b.type == "grazing"
            assert math.isnan(m.real)
    changes = sum(a.stable != b.stable for a, b in zip(branch.orbits, branch.orbits[1:], strict=False))
    assert changes <= len(branch.bifurcations)


def test_wanted_values_are_met_exactly_on_every_sheet():
    wanted = [0.008, 0.009, 0.010, 0.011, 0.014]
    branch = continue_orbit(find_orbit("LR", P), "A", 0.006, at=wanted)
    values = branch.values.tolist()
    assert [values.count(A) for A in wanted] == [2, 2, 2, 2, 1]


def test_a_finer_step_changes_no_bifurcation(up):
    fine = continue_orbit(find_orbit("LR", P), "A", 0.024, step=0.005)
    assert len(fine.orbits) > 2 * len(up.orbits)
    assert [b.type for b in fine.bifurcations] == [b.type for b in up.bifurcations]
    assert fine.bifurcations[0].value == pytest.approx(up.bifurcations[0].value, abs=1e-13)


@pytest.mark.parametrize(
    ("parameter", "stop", "options", "said"),
    [
        ("Amega", 1, {}, "did you mean 'Omega'"),
        ("A", 0.015, {}, "give another value"),
        ("r", 1.5, {}, "0 <= r <= 1"),
        ("A", 0.02, {"step": 0}, "0 < step <= 1"),
    ],
)
def test_bad_calls_are_refused_in_one_line(parameter, stop, options, said):
    with pytest.raises(ParameterError, match=said) as caught:
        continue_orbit(find_orbit("LR", P), parameter, stop, **options)
    assert "\n" not in str(caught.value)


def test_rows_are_plain_and_the_same_every_time(up):
    again = continue_orbit(find_orbit("LR", P), "A", 0.024)
    rows = [orbit_row(orbit, up.branch_id) for orbit in up.orbits]
    assert repr(rows) == repr([orbit_row(orbit, again.branch_id) for orbit in again.orbits])
    assert len({row["orbit_id"] for row in rows}) == len(rows)
    assert {type(value) for row in rows for value in row.values()} <= {str, int, float, bool, list}
    assert {type(item) for row in rows for value in row.values() if isinstance(value, list) for item in value} <= {
        int,
        float,
    }
    row = branch_row(up)
    assert (row["from"], row["to"], row["end_from"], row["end_to"]) == (0.015, 0.024, "range", "range")
    assert row["branch_id"] == again.branch_id
    found = bifurcation_row(up.bifurcations[0], up.branch_id)
    assert found["type"] == "symmetry_breaking"
    assert found["A"] == found["value"]
    assert found["t"][0] == 0
    assert found["orbit_id"] in {row["orbit_id"] for row in rows}
