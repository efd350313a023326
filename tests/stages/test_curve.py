"""The kind `curve` from declaration to table and chart."""

import numpy as np
import pytest

import vines
from vines.stages import run

SMALL = """
title = "small"
[stages.breaking]
kind = "curve"
word = "LR"
type = "symmetry_breaking"
lines = 2
seeds = 3
step = 0.1
vary.A = { from = 0.01, to = 0.03 }
vary.mu = { from = 0.008, to = 0.012 }
[stages.doubling]
kind = "curve"
word = "LR"
type = "period_doubling"
lines = 1
seeds = 3
step = 0.1
vary.A = { from = 0.01, to = 0.03 }
vary.mu = { from = 0.008, to = 0.012 }
[stages.fold]
kind = "curve"
word = "LLR"
type = "fold"
lines = 1
seeds = 4
step = 0.05
vary.A = { from = 0.011, to = 0.014 }
vary.mu = { from = 0.0008, to = 0.002 }
[stages.nothing]
kind = "curve"
word = "LLR"
type = "symmetry_breaking"
lines = 1
seeds = 2
vary.A = { from = 0.021, to = 0.024 }
vary.mu = { from = 0.0099, to = 0.0101 }
[stages.sticking]
kind = "curve"
word = "L*R*"
type = "incomplete_chatter"
lines = 1
seeds = 2
step = 0.2
vary.A = { from = 0.2, to = 0.4 }
vary.mu = { from = 0.009, to = 0.011 }
[stages.figure]
kind = "figure"
plot = "chart"
needs = ["breaking", "doubling"]
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    root = tmp_path_factory.mktemp("curves")
    (root / "pipelines").mkdir()
    (root / "pipelines" / "small.toml").write_text(SMALL)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VINES_ROOT", str(root))
        run("small", stages=["breaking", "doubling", "fold", "sticking", "figure"])
        yield root


def rows(stage, where="special is null"):
    return vines.query(f"select * from curves where stage = '{stage}' and {where} order by curve_id, point").to_pylist()


def test_one_curve_though_two_lines_meet_it(small):
    points = rows("breaking")
    assert len({row["curve_id"] for row in points}) == 1
    assert [row["point"] for row in points] == list(range(len(points)))
    assert [row["end"] for row in points if row["end"]] == ["box", "box"]
    assert {points[0]["mu"], points[-1]["mu"]} == {0.008, 0.012}
    assert all(row["symmetric"] and row["admissible"] for row in points)
    assert max(row["residual"] for row in points) < 1e-10
    A = np.interp(0.01, *zip(*sorted((row["mu"], row["A"]) for row in points), strict=True))
    assert pytest.approx(0.0180076065571, rel=1e-3) == A


def test_the_doubling_of_the_pair_is_found_by_way_of_the_symmetric_orbit(small):
    points = rows("doubling")
    assert len(points) > 5
    assert not any(row["symmetric"] for row in points)
    multipliers = np.array([row["multipliers_re"] for row in points]) + 1j * np.array(
        [row["multipliers_im"] for row in points]
    )
    assert np.abs(multipliers + 1).min(axis=1).max() < 1e-6


def test_special_points_are_rows_of_their_own(small):
    (point,) = rows("fold", "special is not null")
    assert point["special"] == "resonance_1_1"
    assert point["point"] is None
    assert (point["A"], point["mu"]) == pytest.approx((0.0122217, 0.00127723), rel=1e-5)


def test_a_bound_of_orbits_that_stick_is_a_curve(small):
    points = rows("sticking")
    assert {(row["type"], row["word"], row["name"]) for row in points} == {("incomplete_chatter", "L*R*", "1:1")}
    assert [row["end"] for row in points if row["end"]] == ["box", "box"]
    A = np.interp(0.01, *zip(*sorted((row["mu"], row["A"]) for row in points), strict=True))
    # Where the family ends that is followed in A alone.
    inside = vines.find_orbit("L*R*", vines.Params(mu=0.01, A=0.3))
    assert vines.continue_orbit(inside, "A", 0.1).bifurcations[-1].value == pytest.approx(A, rel=1e-3)


def test_the_chart_is_drawn(small):
    (picture,) = small.glob("data/results/*/picture.svg")
    assert picture.stat().st_size > 10_000


def test_where_there_is_none_it_is_said(small):
    with pytest.raises(vines.errors.VinesError, match="no symmetry_breaking of LLR on 1 lines along A"):
        run("small", stages=["nothing"])


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("vary.mu = { from = 0.008, to = 0.012 }\n", "params.mu = 0.01\n", "followed in two parameters"),
        ("lines = 2", "lines = 0", "lines >= 1"),
        ("step = 0.1", "step = 0.0", "step > 0"),
        ('needs = ["breaking", "doubling"]', "needs = []", "draws other stages"),
        ('type = "fold"', 'type = "tear"', "tear"),
        ('type = "fold"', 'type = "incomplete_chatter"', "'LLR' does not; give a word with a star"),
    ],
)
def test_senseless_declarations_are_refused_before_anything_runs(small, old, new, said):
    file = small / "pipelines" / "wrong.toml"
    file.write_text(SMALL.replace(old, new, 1))
    with pytest.raises(vines.errors.VinesError, match=said):
        run("wrong")
    file.unlink()


@pytest.mark.parametrize("asks", ['word = "L*R"\ntype = "fold"', 'word = "LR"\ntype = "release_tangency"'])
def test_of_other_systems_no_orbits_that_stick_are_followed(small, asks):
    file = small / "pipelines" / "wrong.toml"
    ranges = "vary.B = { from = 0.5, to = 0.8 }\nvary.r = { from = 0.4, to = 0.6 }\n"
    file.write_text(f'title = "wrong"\n[stages.curve]\nsystem = "impact_pair"\nkind = "curve"\n{asks}\n{ranges}')
    with pytest.raises(vines.errors.VinesError, match=r"for the system 'vi_nes' only|for which this is not made"):
        run("wrong")
    file.unlink()
