"""A ball with a mass on a spring beside it in pipelines: columns, provenance, logs, what is refused, verify."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest

import vines
from vines.errors import VinesError
from vines.logs import read
from vines.stages import run, verify
from vines.viewer._recording import write_recording

HYBRID = """
title = "a ball and a mass on a spring"
system = "hybrid"
[params]
mu = 0.01
mu_n = 0.01
k3 = 1.0
l2 = 0.2
A = 0.03
[stages.points]
kind = "sweep"
settle = 300
record = 8
random = 1
vary.A = [0.028, 0.03]
[stages.run]
kind = "trajectory"
settle = 100
record = 2
[stages.branch]
kind = "branch"
word = "LR"
points = 2
vary.A = { from = 0.03, to = 0.031 }
[stages.decay]
kind = "transient"
periods = 10
params.V = 2.0
"""


@pytest.mark.long(60)
def test_tables_hold_what_each_of_the_two_takes_and_verify_agrees(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "hybrid.toml").write_text(HYBRID)
    run("hybrid")
    found = vines.query("select * from hybrid_points where stage = 'points' order by A").to_pylist()
    (orbit,) = vines.query("select * from hybrid_orbits where A = 0.03").to_pylist()
    row = found[1]
    assert (row["word"], row["name"], row["regime"]) == ("LR", "1:1", "periodic")
    for name in ("kinetic_ratio_ball", "kinetic_ratio_mass", "viscous_power", "impact_power"):
        assert row[name] == pytest.approx(orbit[name], abs=1e-9)
    assert row["kinetic_ratio_ball"] + row["kinetic_ratio_mass"] == pytest.approx(row["kinetic_ratio"], rel=1e-12)
    assert len(orbit["x3"]) == len(orbit["v3"]) == 2
    (decays,) = vines.table("hybrid_transients").to_pylist()
    assert decays["impact_share"] + decays["damper_share"] + decays["left_share"] == pytest.approx(1, abs=1e-12)
    assert decays["energy"] == pytest.approx(2, abs=1e-12)
    hits = vines.table("hybrid_impacts").to_pylist()
    assert {hit["ball"] for hit in hits} == {0}
    assert all(hit["x3"] is not None for hit in hits)
    results = project.root / "data" / "results"
    (log,) = (read(file) for file in results.rglob("*.mcap"))
    assert (log.system, log.attractor) == ("hybrid", "1:1")
    beside = log.nes.to_pydict()
    assert beside["t"] == log.states["t"].to_pylist()
    energies = (*(log.states[name].to_numpy() for name in ("kinetic_1", "kinetic_2", "potential")), beside["kinetic_3"])
    given, taken, struck = (log.states[name].to_numpy() for name in ("base_work", "damper_loss", "impact_loss"))
    assert np.ptp(np.sum(energies, axis=0) - given + taken + struck) < 1e-12
    write_recording([log], project.root / "run.rrd")
    assert (project.root / "run.rrd").stat().st_size > 10_000
    told = [json.loads(pq.read_schema(file).metadata[b"vines"])["provenance"] for file in results.rglob("*.parquet")]
    assert {(each["exact"], each["order"]) for each in told} == {(False, 20)}
    checked = verify("hybrid", recompute=8)
    assert checked.good, [line.first for line in checked.lines if line.first]
    assert sum(line.checked for line in checked.lines if line.group == "recomputed") > 5


@pytest.mark.parametrize(("kind", "reason"), [("optimum", "what a spring beside"), ("reduced", "no mass on a spring")])
def test_what_it_cannot_do_is_refused_before_any_work(project, monkeypatch, kind, reason):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    text = f'title = "x"\nsystem = "hybrid"\n[stages.a]\nkind = "{kind}"\n'
    (project.root / "pipelines" / "no.toml").write_text(text)
    with pytest.raises(VinesError, match=reason):
        run("no")
