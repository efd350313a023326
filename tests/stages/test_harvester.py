"""Curves of systems beside the VI-NES in pipelines, and the chart of the harvester on fewer points."""

import math
import re

import numpy as np
import pytest

import vines
from tests.project import REPOSITORY
from vines.errors import VinesError
from vines.orbits import find_orbit
from vines.stages import load_pipeline, run, verify
from vines.systems import Harvest, ImpactPair

pytestmark = pytest.mark.long(20)

BALLS = """
title = "balls"
system = "parallel"
[params]
mu = [0.01]
[stages.breaking]
kind = "curve"
word = "LR"
type = "symmetry_breaking"
lines = 1
seeds = 2
step = 0.2
vary.A = { from = 0.017, to = 0.019 }
vary.beta_1 = { from = 0.99, to = 1.01 }
"""
LEVEL = """
title = "level"
system = "impact_pair"
[stages.doubling]
kind = "curve"
word = "LR"
type = "period_doubling"
lines = 1
seeds = 3
step = 0.1
vary.B = { from = 0.6, to = 1.1 }
vary.r = { from = 0.49, to = 0.51 }
"""


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    made = tmp_path_factory.mktemp("harvester")
    (made / "pipelines").mkdir()
    text = (REPOSITORY / "pipelines" / "harvester.toml").read_text("utf-8")
    fewer = {
        "count = 161": "count = 7",
        "count = 81": "count = 5",
        "lines = 4": "lines = 1\nseeds = 4",
        "lines = 16": "lines = 2\nseeds = 4",
        "step = 0.01": "step = 0.05",
    }
    for one, other in fewer.items():
        assert one in text
        text = text.replace(one, other)
    # of the curves that are drawn two
    text = re.sub(r"needs = \[.*?\]", 'needs = ["map", "doubling", "one_zero_fold"]', text, flags=re.DOTALL)
    (made / "pipelines" / "harvester.toml").write_text(text)
    (made / "pipelines" / "balls.toml").write_text(BALLS)
    (made / "pipelines" / "level.toml").write_text(LEVEL)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VINES_ROOT", str(made))
        yield made


@pytest.fixture(scope="module")
def harvester(root):
    run("harvester", stages=["map", "doubling", "one_zero_fold", "figure"])
    return root


def rows(table, where):
    return vines.query(f"select * from {table} where {where}").to_pylist()


def test_curves_are_in_the_tables_of_the_system(harvester):
    points = rows("impact_pair_curves", "stage = 'one_zero_fold' and special is null order by point")
    # at the other end the bounces reach the upper end
    assert {points[0]["end"], points[-1]["end"]} == {"box", "grazing"}
    assert max(row["residual"] for row in points) < 1e-12
    for row in points:
        # the fold of bounces on the lower end: B = pi G (1 - r)/(1 + r)
        assert math.isclose(row["B"], math.pi * row["G"] / 3, rel_tol=1e-10)
        assert (row["word"], row["r"], len(row["multipliers_re"])) == ("L", 0.5, 2)
    doubled = rows("impact_pair_curves", "stage = 'doubling' and special is null order by G")
    # the check value of systems.md, between two points of the curve
    B = np.interp(0.05, [row["G"] for row in doubled], [row["B"] for row in doubled])
    assert pytest.approx(0.96031987596, abs=2e-2) == B


def test_points_are_the_orbits_that_the_map_names(harvester):
    named = rows("impact_pair_points", "name = '1:1' and G > 0 and not recurrent_sticking")
    assert len(named) >= 2
    law = Harvest(0.2, (0.0, 0.0, 0.375))
    for row in named:
        orbit = find_orbit("LR", ImpactPair(B=row["B"], G=row["G"], r=row["r"]))
        assert orbit.stable
        power = law.energy(orbit.w_dot).sum() / orbit.period
        assert row["harvested_left"] + row["harvested_right"] == pytest.approx(power, rel=1e-8)


def test_a_level_pair_doubles_where_the_tilted_one_does_without_tilt(harvester):
    # the level one by way of the symmetric orbit and what breaks its symmetry
    run("level")
    level = rows("impact_pair_curves", "pipeline = 'level' and special is null order by r")
    tilted = rows("impact_pair_curves", "stage = 'doubling' and pipeline = 'harvester' and G = 0 and special is null")
    B = np.interp(0.5, [row["r"] for row in level], [row["B"] for row in level])
    assert min(abs(row["B"] - B) for row in tilted) < 1e-4


def test_verify_holds_what_is_stored(harvester):
    found = verify("harvester")
    assert found.good, [line.first for line in found.lines if line.first]
    assert {"critical multiplier", "multiplier product", "energy balance"} <= {line.name for line in found.lines}


def test_the_figure_is_drawn_with_the_curves_on_it(harvester):
    (picture,) = harvester.glob("data/results/*/picture.svg")
    text = picture.read_text("utf-8")
    assert "period doubling, 1:1 asymmetric" in text
    assert "fold, 1:0" in text
    assert "power harvested at both ends" in text


def test_balls_in_parallel_have_curves_in_the_parameters_of_each(root):
    run("balls")
    points = rows("parallel_curves", "special is null")
    # with lengths over b the forcing is A/beta of the VI-NES
    assert [row["A"] / row["beta_1"] for row in points] == pytest.approx([0.0180076065571] * len(points), abs=1e-11)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('type = "fold"', 'type = "symmetry_breaking"', "there is no symmetry to break unless G = 0"),
        ('word = "LLR"', 'word = "L1"', "'L1' is not a word of the system"),
        ("vary.G = { from = 0.0, to = 0.4 }\n\n[stages.doubling]", "\n[stages.doubling]", "followed in two parameters"),
        (
            "vary.B = { from = 0.2, to = 1.4 }\n",
            "vary.mu = { from = 0.2, to = 1.4 }\n",
            "unknown key 'mu': allowed: B, G, r",
        ),
        ('needs = ["map", ', "needs = [", "one sweep over two parameters, and over it stages of kind"),
    ],
)
def test_what_cannot_be_is_refused_before_any_work(root, old, new, said):
    text = (root / "pipelines" / "harvester.toml").read_text("utf-8")
    assert old in text
    (root / "pipelines" / "wrong.toml").write_text(text.replace(old, new, 1))
    with pytest.raises(VinesError, match=re.escape(said)) as caught:
        load_pipeline("wrong")
    assert "\n" not in str(caught.value)
