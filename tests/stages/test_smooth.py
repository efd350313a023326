"""Orbits without impacts in pipelines: their tables, curves, logs, and what verify says of them."""

import pytest

import vines
from tests.stages.test_sheet import inputs
from vines import systems
from vines.logs import read
from vines.stages import orbit_log, run, verify
from vines.stages.plots._diagram import diagram_parts

SMOOTH = """
title = "a cubic sink without barriers"
system = "cubic_barriers"
[params]
mu = 0.05
k3 = 3.0
l2 = 0.05
lam = 0.01
walls = 0
[stages.branch]
kind = "branch"
word = "-"
points = 2
switch = 1
vary.A = { from = 0.101, to = 0.104 }
"""

CURVE = """
[stages.curve]
kind = "curve"
word = "0:0"
type = "symmetry_breaking"
lines = 1
seeds = 2
step = 0.5
vary.A = { from = 0.101, to = 0.104 }
vary.l2 = { from = 0.0495, to = 0.0505 }
"""


@pytest.mark.long(60)
@pytest.mark.parametrize("recompute", [0, pytest.param(5, marks=pytest.mark.full)])
def test_tables_have_the_state_at_phase_0_and_verify_solves_them_again(project, monkeypatch, recompute):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "smooth.toml").write_text(SMOOTH + CURVE * (recompute > 0))
    run("smooth")
    branches = vines.query("select word, name, end_from from cubic_barriers_branches").to_pylist()
    assert [(each["word"], each["name"], each["end_from"]) for each in branches] == [
        ("-", "0:0", "range"),
        ("-", "0:0", "symmetry_breaking"),
    ]
    first = vines.query("select * from cubic_barriers_orbits where A = 0.101").to_pylist()[0]
    assert (first["t"], first["side"], first["phase"]) == ([0.0], [0], [0.0])
    assert (first["n"], first["m"], first["p"], first["impact_power"]) == (0, 0, 1, 0.0)
    p = systems.CubicBarriers(mu=0.05, A=0.101, k3=3.0, l2=0.05, lam=0.01, walls=False)
    orbit = vines.find_orbit("-", p, guess=[first[name][0] for name in ("x1", "v1", "x2", "v2")])
    assert orbit.measures.max_abs_x1 == pytest.approx(first["max_abs_x1"], rel=1e-12)
    (met,) = vines.query("select * from cubic_barriers_bifurcations where type = 'symmetry_breaking'").to_pylist()
    assert met["value"] == pytest.approx(0.10258468777, abs=1e-10)
    if recompute:
        assert {each["word"] for each in vines.table("cubic_barriers_curves").to_pylist()} == {"-"}
    _, lines, _ = diagram_parts(list(inputs(project.root, "smooth", ["branch"]).values()), mirror=True)
    assert {(line.side, line.stop, line.label.endswith(", at phase 0")) for line in lines} == {(0, False, True)}
    log = read(orbit_log(orbit, project.root / "orbit.mcap"))
    assert (log.kind, log.word, log.impacts.num_rows) == ("orbit", "-", 0)
    checked = verify("smooth", recompute=recompute)
    assert checked.good, [line.first for line in checked.lines if line.first]
