"""A Duffing frame with a ball in pipelines: columns, provenance, logs, what is refused, and what verify says of it."""

import json

import pyarrow.parquet as pq
import pytest

import vines
from vines.dynamics import no_ball
from vines.errors import VinesError
from vines.logs import read
from vines.stages import run, verify
from vines.systems import Duffing

DUFFING = """
title = "a ball in a Duffing oscillator"
system = "duffing"
[params]
mu = 0.02
alpha = 0.5
A = 0.03
Omega = 1.05
[stages.points]
kind = "sweep"
settle = 600
record = 16
vary.Omega = [1.05]
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
def test_tables_tell_of_it_and_verify_agrees(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "duffing.toml").write_text(DUFFING)
    run("duffing")
    found = vines.query("select * from duffing_points where stage = 'points' order by Omega").to_pylist()
    assert (found[0]["word"], found[0]["name"]) == ("LR", "1:1")
    for row in found:
        free = no_ball(Duffing(**{name: row[name] for name in ("mu", "A", "Omega", "r", "lam", "alpha")}))
        assert row["x1_no_ball"] == pytest.approx(free, rel=1e-12)
        assert row["reduction"] == pytest.approx(row["max_abs_x1"] / free, rel=1e-12)
    (orbit,) = vines.query("select * from duffing_orbits where A = 0.03").to_pylist()
    # Two 1:1 attract here: the frame swings little, or much.
    assert found[0]["max_abs_x1"] > 4 * orbit["max_abs_x1"]
    (decays,) = vines.table("duffing_transients").to_pylist()
    assert decays["impact_share"] + decays["damper_share"] + decays["left_share"] == pytest.approx(1, abs=1e-12)
    assert "viscous_power" not in vines.table("duffing_points").column_names
    results = project.root / "data" / "results"
    (log,) = (read(file) for file in results.rglob("*.mcap"))
    assert (log.system, log.attractor) == ("duffing", "1:1")
    told = [json.loads(pq.read_schema(file).metadata[b"vines"])["provenance"] for file in results.rglob("*.parquet")]
    assert {(each["exact"], each["order"]) for each in told} == {(False, 20)}
    checked = verify("duffing", recompute=2)
    assert checked.good, [line.first for line in checked.lines if line.first]
    assert sum(line.checked for line in checked.lines if line.group == "recomputed") == 2


@pytest.mark.parametrize(("kind", "reason"), [("optimum", "what a ball is worth"), ("reduced", "a linear oscillator")])
def test_what_it_cannot_do_is_refused_before_any_work(project, monkeypatch, kind, reason):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "no.toml").write_text(
        f'title = "x"\nsystem = "duffing"\n[stages.a]\nkind = "{kind}"\n'
    )
    with pytest.raises(VinesError, match=reason):
        run("no")
