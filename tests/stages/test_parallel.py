"""Balls in parallel cavities in pipelines: lists, links, columns of each ball, words and the check values."""

import numpy as np
import pyarrow as pa
import pytest

import vines
from vines.logs import read
from vines.stages import run, verify
from vines.stages.audit._physics import defects
from vines.stages.audit._rows import Rows

SPLIT = """
title = "one mass over two cavities"
system = "parallel"
[params]
A = 0.03
beta = [1.0, 1.4]
[stages.points]
kind = "sweep"
vary.mu_1 = [0.01]
link.mu_2 = "0.02 - mu_1"
start = { v2 = [0.1, -0.3] }
settle = 800
record = 16
[stages.run]
kind = "trajectory"
params.mu = [0.01, 0.01]
start = { v2 = [0.1, -0.3] }
settle = 800
record = 3
[stages.branch]
kind = "branch"
word = "L1L2R1R2"
points = 3
params.mu = [0.01, 0.01]
vary.A = { from = 0.03, to = 0.0305 }
"""

DECAYS = """
title = "decays"
[stages.single]
kind = "transient"
periods = 20
params = { mu = 0.02, V = 2.0 }
[stages.one]
kind = "transient"
system = "parallel"
periods = 20
params = { mu = [0.02], V = 2.0 }
[stages.two]
kind = "transient"
system = "parallel"
periods = 20
params = { mu = [0.01, 0.01], beta = [1.0, 0.5], V = 2.0 }
"""


def tampered(name, column):
    """Return the checks that fail where the first row of a stored table is changed."""
    table = vines.table(name)
    first = table[column][0].as_py()
    changed = [-1.0 - abs(each) for each in first] if isinstance(first, list) else -1.0 - abs(first)
    values = pa.array([changed, *table[column][1:].to_pylist()], table.schema.field(column).type)
    at = table.column_names.index(column)
    found = list(defects(name, Rows(table.set_column(at, table.schema.field(column), values))))
    return {each.name for each in found if each.values[0] > each.allowed}


@pytest.mark.long(60)
def test_a_transient_of_one_ball_is_that_of_the_vi_nes_and_two_share_the_loss(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "decays.toml").write_text(DECAYS)
    run("decays")
    rows = {row["stage"]: row for row in vines.table("parallel_transients").to_pylist()}
    (single,) = vines.table("transients").to_pylist()
    one, two = rows["one"], rows["two"]
    # systems-check-values.md, a-tet
    assert one["impacts"] == single["impacts"] == 54
    for name in ("impact_share", "damper_share", "left_share", "ball_share", "t_tenth"):
        assert one[name] == pytest.approx(single[name], abs=1e-9)
    found = verify("decays", recompute=20)
    assert found.good, [line.first for line in found.lines if line.first]
    again = [(line.name, line.checked) for line in found.lines if line.group == "recomputed"]
    assert dict(again) == {"transients": 1, "parallel_transients": 2}
    assert one["energy"] * one["impact_share"] == pytest.approx(0.718833300114, abs=1e-10)
    assert two["impact_share"] + two["damper_share"] + two["left_share"] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.long(90)
def test_tables_hold_the_check_values_ball_by_ball(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "split.toml").write_text(SPLIT)
    run("split")
    # systems-check-values.md, a3
    (point,) = vines.query("select * from parallel_points where stage = 'points'").to_pylist()
    assert (point["status"], point["word"], point["name"]) == ("ok", "L1L2R1R2", "1:1|1:1")
    assert (point["mu_1"], point["mu_2"], point["beta_2"], point["mu_3"]) == (0.01, 0.01, 1.4, None)
    assert (point["v2_1"], point["v2_2"]) == (0.1, -0.3)
    ratios, powers = ([point[f"{name}_{ball}"] for ball in (1, 2)] for name in ("kinetic_ratio", "impact_power"))
    assert ratios == pytest.approx([0.066644811441, 0.103992311198], abs=1e-10)
    assert powers == pytest.approx([0.001195989198, 0.001866217012], abs=1e-11)
    assert point["max_abs_x1"] == pytest.approx(0.513485645719, abs=1e-10)
    assert point["reduction"] == pytest.approx(0.513485645719 / vines.no_ball(vines.Params(mu=0.01, A=0.03)), rel=1e-9)
    hits = vines.query("select ball, side, w_dot from parallel_impacts order by index").to_pylist()
    assert {(hit["ball"], hit["side"]): round(abs(hit["w_dot"]), 9) for hit in hits} == {
        (1, 1): 1.146405485,
        (2, 1): 1.432041813,
        (1, -1): 1.146405485,
        (2, -1): 1.432041813,
    }
    (file,) = (project.root / "data" / "results").rglob("*.mcap")
    log = read(file)
    assert (log.system, log.attractor, list(log.balls)) == ("parallel", "1:1|1:1", [1, 2])
    assert log.impacts.num_rows == 12
    speeds = zip(log.impacts["ball"].to_pylist(), np.abs(log.impacts["w_dot"].to_numpy()).round(6), strict=True)
    assert set(speeds) == {(1, 1.146405), (2, 1.432042)}
    (named,) = vines.query("select word, name, kinetic_ratio_2 from parallel_points where stage = 'run'").to_pylist()
    assert (named["word"], named["name"]) == ("L1L2R1R2", "1:1|1:1")
    assert named["kinetic_ratio_2"] == pytest.approx(0.103992311198, abs=1e-9)
    orbits = vines.query("select * from parallel_orbits where A = 0.03").to_pylist()
    assert orbits[0]["stable"]
    assert orbits[0]["kinetic_ratio_2"] == pytest.approx(0.103992311198, abs=1e-10)
    found = verify("split", recompute=60)
    assert found.good, [line.first for line in found.lines if line.first]
    again = {line.name: line.checked for line in found.lines if line.group == "recomputed"}
    assert set(again) == {f"parallel_{name}" for name in ("points", "impacts", "orbits", "attractors")}
    assert all(again.values())
    checked = {line.name: line.checked for line in found.lines if line.group == "parallel_orbits"}
    (count,) = vines.query("select count(*) as n from parallel_orbits").to_pylist()
    assert checked["energy balance"] == checked["multiplier product"] == count["n"] > 2
    for name, column, wrong in (
        ("impacts", "w_dot", "impact law"),
        ("impacts", "x2", "contact"),
        ("impacts", "v1", "momentum"),
        ("points", "base_work", "energy balance"),
        ("points", "impact_power_2", "balls"),
        ("points", "x1_locked", "yardsticks"),
        ("orbits", "multipliers_re", "multiplier product"),
        ("orbits", "mu_1", "parameters"),
    ):
        assert wrong in tampered(f"parallel_{name}", column), (name, column)
    both = vines.query("select distinct system, name from all_points union select system, name from all_orbits")
    assert both.to_pylist() == [{"system": "parallel", "name": "1:1|1:1"}]
