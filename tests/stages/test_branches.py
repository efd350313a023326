"""The kind `branch` with all families and what comes out of them, and the figures that are drawn from it."""

import numpy as np
import pytest

import vines
from vines.stages import run
from vines.stages.plots._diagram import _threaded

SMALL = """
title = "small"
[params]
mu = 0.01
[stages.one_one]
kind = "branch"
word = "LR"
families = "all"
seeds = 3
switch = 2
points = 20
vary.A = { from = 0.012, to = 0.022 }
[stages.two_one]
kind = "branch"
word = "LLR"
families = "all"
seeds = 4
points = 20
vary.A = { from = 0.012, to = 0.024 }
[stages.plain]
kind = "branch"
word = "LR"
points = 5
vary.A = { from = 0.015, to = 0.017 }
[stages.empty]
kind = "branch"
word = "LLR"
families = "all"
seeds = 2
vary.A = { from = 0.015, to = 0.017 }
[stages.picture]
kind = "figure"
plot = "bifurcation"
window = [0.015, 0.022]
mirror = true
needs = ["one_one", "two_one"]
[stages.moduli]
kind = "figure"
plot = "multipliers"
panels = ["1:1 symmetric", "1:1 asymmetric"]
needs = ["one_one"]
"""


MODULI = 'plot = "multipliers"\npanels = ["1:1 symmetric", "1:1 asymmetric"]'


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    root = tmp_path_factory.mktemp("branches")
    (root / "pipelines").mkdir()
    (root / "pipelines" / "small.toml").write_text(SMALL)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VINES_ROOT", str(root))
        run("small", stages=["one_one", "two_one", "plain", "picture", "moduli"], jobs=2)
        yield root


def test_generations_are_linked(small):
    rows = vines.query("select * from branches where stage = 'one_one'").to_pylist()
    names = {row["branch_id"]: (row["word"], row["symmetric"]) for row in rows}
    links = [(names[row["branch_id"]], names.get(row["parent"])) for row in rows]
    assert links == [
        (("LR", True), None),
        (("LR", False), ("LR", True)),
        (("LRLR/2T", False), ("LR", False)),
    ]


def test_the_values_behind_section_5_1(small):
    found = vines.query(
        "select stage, word, type, value from bifurcations where type <> 'pair_turns_real' order by value"
    ).to_pylist()
    values = {(row["stage"], row["word"], row["type"]): row["value"] for row in found}
    assert values["one_one", "LR", "symmetry_breaking"] == pytest.approx(0.0180076065571, abs=1e-9)
    assert values["one_one", "LR", "period_doubling"] == pytest.approx(0.0204743800565, abs=1e-9)
    assert values["one_one", "LRLR/2T", "grazing"] == pytest.approx(0.0216679118003, abs=1e-9)
    assert values["two_one", "LLR", "fold"] == pytest.approx(0.0209753593572, abs=1e-9)
    assert values["two_one", "LLR", "neimark_sacker"] == pytest.approx(0.0212400310486, abs=1e-9)
    assert values["two_one", "LLR", "grazing"] == pytest.approx(0.0233192119434, abs=1e-9)


def test_a_range_that_begins_before_the_family_is_no_obstacle(small):
    (row,) = vines.query("select * from branches where stage = 'two_one'").to_pylist()
    assert (row["end_from"], row["end_to"]) == ("grazing", "range")
    (stable,) = vines.query(
        "select min(A) as low, max(A) as high from orbits where stage = 'two_one' and stable"
    ).to_pylist()
    assert 0.02124 < stable["low"] < stable["high"] == 0.024


def test_by_default_one_orbit_is_followed_from_end_to_end(small):
    (row,) = vines.query("select * from branches where stage = 'plain'").to_pylist()
    assert (row["from"], row["to"], row["end_from"], row["end_to"]) == (0.015, 0.017, "range", "range")
    assert row["symmetric"]
    assert row["parent"] is None
    values = vines.query("select A from orbits where stage = 'plain'").column("A").to_pylist()
    assert set(np.linspace(0.015, 0.017, 5)) <= set(values)


def test_both_pictures_are_drawn(small):
    assert len(list(small.glob("data/results/*/picture.png"))) == 2


def test_where_there_is_no_family_it_is_said(small):
    with pytest.raises(vines.errors.VinesError, match="no admissible LLR orbit at any of 2 values"):
        run("small", stages=["empty"])


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("switch = 2", "switch = -1", "switch >= 0"),
        ("seeds = 3", "seeds = 1", "seeds >= 2"),
        ("window = [0.015, 0.022]", "window = [0.022, 0.015]", "lower end first"),
        (MODULI, 'plot = "chart"', "a chart draws stages of kind 'curve'"),
        (
            'plot = "multipliers"',
            'plot = "chart"',
            "unknown key 'panels': allowed: kind, look, needs, plot, title, width",
        ),
        ('plot = "multipliers"', 'plot = "multiplier"', "plot: unknown plot 'multiplier': did you mean 'multipliers'"),
        ('plot = "multipliers"', "", "'plot' is missing; allowed: basins, best, bifurcation"),
    ],
)
def test_senseless_declarations_are_refused_before_anything_runs(small, old, new, said):
    file = small / "pipelines" / "wrong.toml"
    file.write_text(SMALL.replace(old, new, 1))
    with pytest.raises(vines.errors.VinesError, match=said):
        run("wrong")
    file.unlink()


def test_a_line_follows_one_impact_though_the_first_one_changes():
    smooth = np.array([[1.0, -1.0, 2.0, -2.0], [1.1, -1.1, 2.1, -2.1], [1.2, -1.2, 2.2, -2.2]])
    stored = smooth.copy()
    stored[1] = np.roll(stored[1], 2)
    values = _threaded({"w_dot": stored, "dt": stored, "x1": stored}, (0, 2))
    assert all(np.array_equal(matrix, smooth) for matrix in values.values())
