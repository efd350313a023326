"""Bifurcations followed in two parameters, each point checked against the same bifurcation located in one."""

import numpy as np
import pytest

from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params
from vines.orbits import (
    continue_orbit,
    curve_rows,
    find_orbit,
    follow_curve,
    switch_branch,
    symmetric_fold,
)

P = Params(mu=0.01, A=0.017)
BOX = {"A": (0.002, 0.2), "mu": (0.001, 0.2)}


@pytest.fixture(scope="module")
def found():
    """Every type of bifurcation, of symmetric and of asymmetric orbits."""
    up = continue_orbit(find_orbit("LR", P), "A", 0.08)
    down = continue_orbit(find_orbit("LR", P), "A", 0.006)
    pair = continue_orbit(switch_branch(up.bifurcations[0])[0], "A", 0.03)
    two = continue_orbit(find_orbit("LLR", P.replace(A=0.023)), "A", 0.0205, within=(0.0205, 0.1), step=0.005)
    return {
        f"{branch.word}{' symmetric' * branch.symmetric} {b.type}": b
        for branch in (down, up, pair, two)
        for b in branch.bifurcations
    }


EVERY = [
    "LR symmetric symmetry_breaking",
    "LR symmetric neimark_sacker",
    "LR symmetric fold",
    "LR symmetric grazing",
    "LR period_doubling",
    "LR grazing",
    "LLR neimark_sacker",
    "LLR fold",
    "LLR grazing",
]


@pytest.fixture(scope="module")
def curves(found):
    return {name: follow_curve(found[name], box=BOX) for name in EVERY}


def target(type_, orbit):
    """What has to vanish, from the orbit alone."""
    m = orbit.multipliers if orbit.half_multipliers is None else orbit.half_multipliers
    if type_ == "fold":
        return abs(m - 1).min()
    if type_ in ("symmetry_breaking", "period_doubling"):
        return abs(m + 1).min()
    if type_ == "neimark_sacker":
        return np.sort(abs(abs(m) - 1))[1]
    return min(abs(orbit.min_clearance), abs(orbit.w_dot).min())


@pytest.mark.parametrize("name", EVERY)
def test_every_point_is_the_bifurcation_it_is_said_to_be(curves, found, name):
    curve = curves[name]
    assert curve.residuals.max() < 1e-10
    assert (curve.type, curve.word) == (found[name].type, found[name].word)
    assert len(curve.orbits) > 40
    # Next to a resonance a pair of multipliers meets, and each is right to half the digits only.
    assert max(target(curve.type, orbit) for orbit in curve.orbits) < 1e-5
    assert np.median([target(curve.type, orbit) for orbit in curve.orbits]) < 1e-10
    assert max(orbit.residual for orbit in curve.orbits) < 1e-12
    start = [found[name].params.A, found[name].params.mu]
    assert np.abs((curve.values - start) / np.ptp(curve.values, axis=0).clip(1e-3)).max(axis=1).min() < 1e-9


@pytest.mark.parametrize("name", ["LR symmetric symmetry_breaking", "LR period_doubling", "LLR fold", "LR grazing"])
def test_a_point_elsewhere_on_the_curve_is_where_one_parameter_finds_it(curves, name):
    curve = curves[name]
    place = int(np.argmin(abs(curve.values[:, 1] - 0.03)))
    (A, _), orbit = curve.values[place], curve.orbits[place]
    near = orbit.params.replace(A=A * 1.002) if curve.type == "fold" else orbit.params.replace(A=A * 0.998)
    start = follow(orbit, near)
    branch = continue_orbit(start, "A", A * 0.99 if curve.type == "fold" else A * 1.01, step=0.05)
    values = [b.value for b in branch.bifurcations if b.type == curve.type]
    assert min(abs(value - A) for value in values) < 1e-10


def follow(orbit, near):
    """An orbit of the same family at nearby parameters; next to a fold on either sheet."""
    free = np.random.default_rng(1)
    for size in (0, 1e-3, 3e-3, 1e-2, 3e-2):
        try:
            return find_orbit(orbit.word, near, guess=orbit.t + size * free.normal(size=len(orbit.t)))
        except OrbitNotFound:
            continue
    raise AssertionError(f"no orbit at {near}")


def test_the_fold_of_1_to_1_is_that_of_the_formula(curves):
    for orbit in curves["LR symmetric fold"].orbits[::10]:
        assert pytest.approx(symmetric_fold(orbit.params).A, rel=1e-12) == orbit.params.A


def test_the_small_orbit_ends_without_impact_speed_whatever_the_mass():
    end = continue_orbit(find_orbit("LR", P), "A", 0.006).bifurcations[-1]
    curve = follow_curve(end, box=BOX)
    # The forced response just spans the cavity, and the ball is carried along without impact.
    assert curve.values[:, 0] == pytest.approx(P.lam / np.hypot(1, P.lam), abs=1e-9)
    assert np.ptp(curve.values[:, 1]) > 0.19


def test_grazing_of_the_pair_and_of_2_to_1_is_one_curve(curves):
    ours, theirs = curves["LR grazing"].values, curves["LLR grazing"].values
    on_ours = np.interp(theirs[:, 1], *(ours[np.argsort(ours[:, 1])].T[::-1]))
    assert on_ours == pytest.approx(theirs[:, 0], rel=2e-3)
    assert {tuple(np.round(end, 10)) for end in ours[[0, -1]]} == {tuple(np.round(end, 10)) for end in theirs[[0, -1]]}


def test_fold_and_torus_of_2_to_1_meet_at_a_resonance(curves):
    torus, fold = curves["LLR neimark_sacker"], curves["LLR fold"]
    [end] = torus.special
    [met] = fold.special
    assert end.type == met.type == "resonance_1_1"
    assert torus.ends[0] == "resonance_1_1" or torus.ends[1] == "resonance_1_1"
    assert end.values == pytest.approx(met.values, abs=1e-9)
    assert met.values == pytest.approx((0.0122217, 0.00127723), rel=1e-5)
    assert np.sort(abs(met.orbit.multipliers - 1))[1] < 1e-4


def test_a_symmetric_fold_meets_a_pair_on_the_circle(found):
    box = {"A": (0.001, 0.1), "Omega": (0.8, 1.3)}
    fold = follow_curve(found["LR symmetric fold"], ("A", "Omega"), box=box)
    torus = follow_curve(found["LR symmetric neimark_sacker"], ("A", "Omega"), box=box)
    assert {point.type for point in fold.special} == {"resonance_1_1", "fold_neimark_sacker"}
    for point in torus.special:
        twin = min(fold.special, key=lambda other: np.hypot(*np.subtract(other.values, point.values)))
        assert twin.type == point.type
        assert twin.values == pytest.approx(point.values, abs=1e-8)
    pair = next(point for point in fold.special if point.type == "fold_neimark_sacker").orbit.half_multipliers
    assert np.sort(abs(abs(pair) - 1))[2] < 1e-5


def test_a_doubling_curve_meets_a_fold_curve_and_ends_at_grazing(found):
    box = {"mu": (0.001, 0.1), "r": (0.2, 0.95)}
    doubling = follow_curve(found["LR period_doubling"], ("mu", "r"), box=box)
    [end] = doubling.special
    assert "grazing" in doubling.ends
    assert abs(end.orbit.min_clearance) < 1e-10
    assert abs(end.orbit.multipliers + 1).min() < 1e-8
    grazing = follow_curve(found["LR grazing"], ("mu", "r"), box=box)
    [flip] = grazing.special
    assert flip.type == "grazing_flip"
    assert abs(flip.orbit.multipliers + 1).min() < 1e-7
    # Where its weak impact loses its speed the fold of 2:1 ends, on the grazing of 1:1.
    fold = follow_curve(found["LLR fold"], ("mu", "r"), box=box)
    [corner] = fold.special
    assert corner.type == "grazing"
    assert "grazing" in fold.ends
    assert 0 < min(corner.orbit.side * corner.orbit.w_dot) < 1.01e-3
    assert all(orbit.admissible for orbit in fold.orbits)
    assert np.hypot(*(grazing.values - corner.values).T).min() < 0.01


def test_a_curve_can_begin_where_the_family_ends_that_came_out(found):
    pair = switch_branch(found["LR symmetric symmetry_breaking"])[0]
    joint = continue_orbit(pair, "A", 0.017).bifurcations[-1]
    box = {"A": (0.015, 0.02), "mu": (0.008, 0.012)}
    one = follow_curve(joint, box=box)
    other = follow_curve(found["LR symmetric symmetry_breaking"], box=box)
    assert one.symmetric
    np.testing.assert_allclose(one.values[[0, -1]], other.values[[0, -1]], atol=1e-11)


def test_rows_are_plain(curves):
    curve = curves["LLR fold"]
    rows = curve_rows(curve)
    assert len(rows) == len(curve.orbits) + len(curve.special)
    assert [row["special"] for row in rows if row["special"]] == ["resonance_1_1"]
    assert {type(value) for row in rows for value in row.values()} <= {str, int, float, bool, list, type(None)}
    assert rows[0]["curve_id"] == curve.curve_id


@pytest.mark.parametrize(
    ("parameters", "box", "options", "said"),
    [
        (("A", "nu"), {"A": (0, 1), "nu": (0, 1)}, {}, "unknown parameter 'nu'"),
        (("A", "A"), {"A": (0, 1)}, {}, "two different ones"),
        (("A", "mu"), {"A": (0, 1)}, {}, "ranges of A and mu"),
        (("A", "mu"), {"A": (0.5, 1), "mu": (0.001, 1)}, {}, "has to hold the bifurcation"),
        (("A", "mu"), BOX, {"step": 2}, "step is 2; give a finite number > 0 and <= 1"),
    ],
)
def test_bad_calls_are_refused_in_one_line(found, parameters, box, options, said):
    with pytest.raises(ParameterError, match=said) as caught:
        follow_curve(found["LLR fold"], parameters, box=box, **options)
    assert "\n" not in str(caught.value)


WIDE = {"A": (1e-4, 2.0), "mu": (1e-6, 2.0), "Omega": (0.05, 4.0), "r": (0.0, 1.0), "lam": (0.0, 1.999)}
"""All of the domain but what is out of any use."""


@pytest.mark.parametrize(
    "name", ["LR symmetric fold", "LR symmetric grazing", "LR period_doubling", "LLR neimark_sacker"]
)
@pytest.mark.parametrize("names", [("A", "lam"), ("mu", "lam"), ("lam", "r"), ("A", "r"), ("Omega", "lam")])
def test_a_curve_ends_at_the_border_of_the_domain_and_keeps_its_points(found, name, names):
    curve = follow_curve(found[name], names, box={each: WIDE[each] for each in names}, max_points=120)
    assert len(curve.orbits) > 5
    assert curve.residuals.max() < 1e-6
    low, high = zip(*(WIDE[each] for each in names), strict=True)
    assert ((curve.values >= low) & (curve.values <= high)).all()
    assert "lost" not in curve.ends


def test_the_grazing_over_damping_of_the_report_is_followed():
    p = Params(mu=0.01, A=0.09, lam=0.02)
    [end] = continue_orbit(find_orbit("LR", p), "A", 0.12).bifurcations
    assert end.value == pytest.approx(0.1020379, abs=1e-7)
    curve = follow_curve(end, ("A", "lam"), box={"A": (0.01, 1.0), "lam": (0.0, 0.2)})
    assert "box" in curve.ends
    assert curve.residuals.max() < 1e-6
    assert np.ptp(curve.values[:, 1]) > 0.15


@pytest.mark.parametrize(("parameter", "stop"), [("r", 1.0), ("r", 0.3), ("lam", 1.9), ("mu", 1e-9), ("Omega", 2.0)])
def test_a_branch_goes_to_the_border_of_what_a_parameter_may_be(parameter, stop):
    branch = continue_orbit(find_orbit("LR", P), parameter, stop)
    assert branch.ends[1] in ("range", "grazing")
    assert len(branch.orbits) > 3
