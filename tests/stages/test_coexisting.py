"""Random starts at the points of a sweep, and a basins stage, through the command line."""

import json
import re

import numpy as np
import pytest

import vines
from vines.attractors import random_starts
from vines.dynamics.kernels import room_of
from vines.errors import VinesError
from vines.model import Params
from vines.stages import load_pipeline, run, verify
from vines.systems import ImpactPair, Parallel

DECLARED = """
title = "beside each other"
[params]
mu = 0.01
A = 0.02
[stages.many]
kind = "sweep"
vary.Omega = [1.0]
random = 3
seed = 5
settle = 100
[stages.plane]
kind = "basins"
x = { name = "x2", from = -0.9, to = 0.9, count = 6 }
y = { name = "v2", from = 0.05, to = 0.3, count = 6 }
[stages.picture]
kind = "figure"
plot = "basins"
needs = ["plane"]
"""


def test_coexisting_attractors_are_listed_and_basins_drawn(project):
    (project.root / "pipelines" / "beside.toml").write_text(DECLARED, encoding="utf-8")
    project.vines("run", "beside", "--quiet")
    asked = "select stage, name, fraction from attractors order by stage, attractor"
    told = project.vines("query", asked, "--format", "csv")
    rows = [line.split(",") for line in told.stdout.strip().splitlines()[1:]]
    assert {row[0] for row in rows} == {"many", "plane"}
    many = [row for row in rows if row[0] == "many"]
    assert many[0][1] == "1:1"
    assert sum(float(row[2]) for row in many) == 1.0
    assert list(project.data.glob("results/*/picture.png"))


RANDOM = """
title = "from random starts"
[params]
mu = 0.01
[stages.drawn]
kind = "sweep"
vary.A = { from = 0.022, to = 0.024, count = COUNT }
start = "random"
seed = 3
settle = 200
record = 8
"""


def test_random_starts_follow_from_seed_and_parameters_alone(project):
    drawn = {}
    for count in (3, 5):
        (project.root / "pipelines" / f"drawn_{count}.toml").write_text(RANDOM.replace("COUNT", str(count)))
        project.vines("run", f"drawn_{count}", "--quiet")
        asked = f"select A, x1, v1, x2, v2, seed, carry from points where pipeline = 'drawn_{count}'"
        drawn[count] = json.loads(project.vines("query", asked, "--format", "json").stdout)
    starts = {count: {row["A"]: tuple(row.values()) for row in rows} for count, rows in drawn.items()}
    assert starts[3].items() <= starts[5].items()
    assert len({row["x1"] for row in drawn[5]}) == 5
    assert all(row["seed"] == 3 and row["carry"] is None for row in drawn[5])
    assert all(abs(row["x1"] - row["x2"]) <= 1 for row in drawn[5])


OF_SYSTEMS = """
title = "beside each other, of other systems"
[stages.pair]
system = "impact_pair"
kind = "sweep"
params = { G = 0.05, r = 0.5 }
vary.B = [0.6, 1.0]
random = 8
seed = 1
keep = 4
harvest = { coefficients = [0.0, 0.0, 0.375] }
[stages.plane]
system = "impact_pair"
kind = "basins"
params = { B = 1.0, G = 0.05, r = 0.5 }
x = { name = "w", from = -1, to = 1, count = 8 }
y = { name = "w_dot", from = -2, to = 2, count = 8 }
harvest = { coefficients = [0.0, 0.0, 0.375] }
[stages.balls]
system = "parallel"
kind = "sweep"
params = { mu = [0.01, 0.01], beta = [1.0, 1.0], A = 0.03 }
vary.Omega = [1.0]
start = "random"
random = 6
[stages.cavities]
system = "parallel"
kind = "basins"
params = { mu = [0.01, 0.01], beta = [1.0, 1.0], A = 0.03 }
x = { name = "x1", from = -0.9, to = 0.9, count = 6 }
y = { name = "v1", from = -0.9, to = 0.9, count = 6 }
start = { x2 = [0.0, 0.1] }
"""


@pytest.mark.long(40)
def test_other_systems_have_the_same_tables_and_every_row_holds(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "beside.toml").write_text(OF_SYSTEMS, encoding="utf-8")
    run("beside")
    found = verify("beside", recompute=60)
    assert found.good, [line.first for line in found.lines if line.first]
    again = {line.name: line.checked for line in found.lines if line.group == "recomputed"}
    assert {f"{name}_{base}" for name in ("impact_pair", "parallel") for base in ("attractors", "basins")} < set(again)
    assert all(again.values())
    asked = "select stage, {0}, sum(fraction) as whole from {1}_attractors group by all"
    for system, parameter in (("impact_pair", "B"), ("parallel", "Omega")):
        rows = vines.query(asked.format(parameter, system)).to_pylist()
        assert [row["whole"] for row in rows] == pytest.approx([1.0] * len(rows))
    found = vines.query("select * from impact_pair_attractors where B = 1.0 and attractor >= 0").to_pylist()
    beside = [row for row in found if row["stage"] == "pair"]
    assert {row["name"] for row in beside} == {"1:1", "2:1", "2:2/2T"}
    # (1 - r²)/2 = .375: the law harvests what impacts lose, of attractors of random starts too
    for row in found:
        assert row["harvested_left"] + row["harvested_right"] == pytest.approx(row["impact_power"], rel=1e-8)
    hits = "select distinct attractor from impact_pair_impacts where stage = 'pair' and B = 1.0"
    assert vines.query(hits).num_rows == len(beside)
    (point,) = vines.query("select seed, x1, v2_1, v2_2, phase from parallel_points").to_pylist()
    assert point["seed"] == point["phase"] == 0
    assert len(set(point.values())) == 4


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (('name = "w"', 'name = "x1"'), "unknown coordinate 'x1' of the grid"),
        (('name = "w_dot"', 'name = "w"'), "x is w, y is w: give two coordinates"),
        (("start = { x2 = [0.0, 0.1] }", "start = { x1 = 0.1 }"), "give two coordinates, not again in start"),
        (("start = { x2 = [0.0, 0.1] }", "start = { x2 = [0.0] }"), "x2 has 1 values at the start"),
        (('start = "random"', 'start = "drawn"'), "start"),
        (("count = 8 }", "count = 80000000 }"), "before they are halved"),
    ],
)
def test_what_a_grid_cannot_be_is_refused(project, monkeypatch, change, text):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    assert change[0] in OF_SYSTEMS
    (project.root / "pipelines" / "beside.toml").write_text(OF_SYSTEMS.replace(*change), encoding="utf-8")
    with pytest.raises(VinesError, match=re.escape(text)) as caught:
        load_pipeline("beside")
    assert "\n" not in str(caught.value)


def test_random_starts_of_one_ball_are_those_of_the_vi_nes():
    for A, G in ((0.001, 0.0), (0.02, 0.0), (0.3, 0.01)):
        p = Parallel(mu=(0.01,), A=A, G=G)
        one, other = (room_of(each).draw(each, np.random.default_rng(3)) for each in (p, Params(mu=0.01, A=A)))
        assert list(one.values()) == list(other.values())
    pair = ImpactPair(B=0.6, G=0.1)
    drawn = random_starts(pair, 200, 1)
    assert np.all(np.abs(drawn[:, 0]) <= 1)
    assert np.array_equal(drawn, random_starts(pair, 200, 1))
    assert not np.array_equal(drawn, random_starts(pair, 200, 2))
    far = Parallel(mu=(0.01, 0.01), beta=(0.5, 2.0), A=0.03)
    at = dict(zip([each.name for each in far.system.state], random_starts(far, 200, 1).T, strict=True))
    assert np.abs(room_of(far).gaps(far, at)).max(axis=0) == pytest.approx([1.0, 1.0], abs=0.03)
