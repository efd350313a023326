"""A mass on a cubic spring in pipelines: columns, provenance, logs, what is refused, and what verify says of it."""

import json

import pyarrow.parquet as pq
import pytest

import vines
from vines.errors import VinesError
from vines.logs import read
from vines.stages import run, verify

CUBIC = """
title = "a cubic spring in barriers"
system = "cubic_barriers"
[params]
mu = 0.02
k3 = 1.0
l2 = 0.2
A = 0.03
[stages.points]
kind = "sweep"
settle = 600
record = 16
vary.walls = [1, 0]
[stages.run]
kind = "trajectory"
settle = 100
record = 2
[stages.branch]
kind = "branch"
word = "LR"
points = 3
vary.A = { from = 0.03, to = 0.031 }
[stages.decay]
kind = "transient"
periods = 10
params.V = 2.0
"""


@pytest.mark.long(60)
def test_tables_hold_the_check_values_and_verify_agrees(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "cubic.toml").write_text(CUBIC)
    run("cubic")
    found = vines.query("select * from cubic_barriers_points where stage = 'points' order by walls").to_pylist()
    smooth, struck = found
    assert (smooth["regime"], smooth["name"], smooth["word"]) == ("no_impact", "0:0", None)
    assert (struck["word"], struck["name"]) == ("LR", "1:1")
    # systems-check-values.md, c3
    assert struck["kinetic_ratio"] == pytest.approx(0.103534899209, abs=1e-9)
    assert struck["viscous_power"] == pytest.approx(0.001708869981, abs=1e-10)
    assert struck["impact_power"] == pytest.approx(0.001260341125, abs=1e-10)
    (orbit,) = vines.query("select * from cubic_barriers_orbits where A = 0.03").to_pylist()
    assert orbit["viscous_power"] == pytest.approx(0.001708869981, abs=1e-11)
    (decays,) = vines.table("cubic_barriers_transients").to_pylist()
    assert decays["impact_share"] + decays["damper_share"] + decays["left_share"] == pytest.approx(1, abs=1e-12)
    results = project.root / "data" / "results"
    (log,) = (read(file) for file in results.rglob("*.mcap"))
    assert (log.system, log.attractor) == ("cubic_barriers", "1:1")
    told = [json.loads(pq.read_schema(file).metadata[b"vines"])["provenance"] for file in results.rglob("*.parquet")]
    assert {(each["exact"], each["order"]) for each in told} == {(False, 20)}
    checked = verify("cubic", recompute=20)
    assert checked.good, [line.first for line in checked.lines if line.first]
    assert sum(line.checked for line in checked.lines if line.group == "recomputed") > 5


@pytest.mark.parametrize(("kind", "reason"), [("optimum", "what a spring is worth"), ("reduced", "flies freely")])
def test_what_it_cannot_do_is_refused_before_any_work(project, monkeypatch, kind, reason):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    text = f'title = "x"\nsystem = "cubic_barriers"\n[stages.a]\nkind = "{kind}"\n'
    (project.root / "pipelines" / "no.toml").write_text(text)
    with pytest.raises(VinesError, match=reason):
        run("no")
