"""The kind `branch` of other systems: all families, what comes out of them, and rows that hold."""

import re

import pytest

import vines
from vines.errors import VinesError
from vines.stages import load_pipeline, run, verify

FAMILIES = """
title = "families of other systems"
[stages.pair]
system = "impact_pair"
kind = "branch"
word = "LR"
params = { r = 0.5 }
vary.B = { from = 0.7, to = 1.0 }
points = 4
families = "all"
seeds = 3
switch = 1
[stages.sticks]
system = "impact_pair"
kind = "branch"
word = "L*R*"
params = { r = 0.3 }
vary.B = { from = 3.0, to = 2.5 }
points = 4
[stages.balls]
system = "parallel"
kind = "branch"
word = "L1L2R1R2"
params = { mu = [0.01, 0.01], beta = [1.0, 1.4] }
vary.A = { from = 0.027, to = 0.03 }
points = 2
families = "all"
seeds = 2
"""


@pytest.mark.long(30)
def test_all_families_of_a_pair_and_of_two_balls(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "families.toml").write_text(FAMILIES, encoding="utf-8")
    run("families")
    branches = {row["branch_id"]: row for row in vines.table("impact_pair_branches").to_pylist()}
    met = vines.table("impact_pair_bifurcations").to_pylist()
    # systems-check-values.md, d2: the symmetric family loses its symmetry at .76924097
    (broken,) = [each for each in met if each["type"] == "symmetry_breaking"]
    assert broken["value"] == pytest.approx(0.7692409694848, abs=1e-10)
    children = [each for each in branches.values() if each["parent"] == broken["branch_id"]]
    assert len(children) == 1
    assert not children[0]["symmetric"]
    assert branches[broken["branch_id"]]["symmetric"]
    (sticks,) = [each for each in branches.values() if each["word"] == "L*R*"]
    (end,) = [each for each in met if each["branch_id"] == sticks["branch_id"]]
    assert (end["type"], sticks["end_to"]) == ("incomplete_chatter", "incomplete_chatter")
    assert len(vines.table("parallel_branches").to_pylist()) >= 1
    found = verify("families", recompute=20)
    assert found.good, [line.first for line in found.lines if line.first]


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (('families = "all"\nseeds = 3', 'families = "few"\nseeds = 3'), "families is 'few'"),
        (('kind = "branch"\nword = "L*R*"', 'kind = "optimum"\nword = "LR"'), "no displacement can be kept small"),
        (('kind = "branch"\nword = "L*R*"', 'kind = "reduced"'), "known in closed form"),
        (
            (
                'kind = "branch"\nword = "L*R*"\nparams = { r = 0.3 }\nvary.B = { from = 3.0, to = 2.5 }\npoints = 4',
                'kind = "curve"\ntype = "fold"\nword = "L*R*"\n'
                "vary.B = { from = 2, to = 3 }\nvary.r = { from = 0, to = 1 }",
            ),
            "'L*R*' sticks, for which this is not made",
        ),
    ],
)
def test_what_a_system_cannot_do_is_refused_in_one_line_that_says_why(project, monkeypatch, change, text):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    assert change[0] in FAMILIES
    declared = FAMILIES.replace(*change)
    (project.root / "pipelines" / "families.toml").write_text(declared, encoding="utf-8")
    with pytest.raises(VinesError, match=re.escape(text)) as caught:
        load_pipeline("families")
    assert "\n" not in str(caught.value)
