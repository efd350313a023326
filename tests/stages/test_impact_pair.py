"""The impact pair in pipelines: tables that hold the check values, power by declared laws, and what is refused."""

import math
import re
from pathlib import Path

import pytest

import vines
from vines.errors import VinesError
from vines.logs import read
from vines.stages import found, load_pipeline, run, verify

PAIR = """
title = "a pair"
system = "impact_pair"
[params]
r = 0.5
[stages.points]
kind = "sweep"
params.G = 0.05
vary.B = [0.6, 0.7]
settle = 200
harvest = { coefficients = [0.0, 0.0, 0.375] }
[stages.run]
kind = "trajectory"
params = { B = 0.65, G = 0.05 }
settle = 200
record = 3
[stages.chain]
kind = "sweep"
params.G = 0.15
vary.B = [0.94, 0.95]
carry = "B"
settle = 200
harvest = { threshold = 1.0, coefficients = [0.0, 0.0, 0.375] }
[stages.ball]
system = "vi_nes"
kind = "sweep"
params = { mu = 0.01 }
vary.A = [0.015]
settle = 50
[stages.diagram]
kind = "figure"
plot = "bifurcation"
panels = ["w_dot", "phase"]
needs = ["points", "doubling"]
[stages.doubling]
kind = "branch"
word = "LR"
points = 5
params.G = 0.05
vary.B = { from = 0.6, to = 1.0 }
"""


@pytest.fixture
def pair(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))

    def declare(text):
        (project.root / "pipelines" / "pair.toml").write_text(text)
        return project

    return declare


@pytest.mark.long(60)
def test_tables_hold_the_check_values(pair):
    project = pair(PAIR)
    run("pair")
    pictures = [path.name for path in (project.root / "data" / "results").rglob("picture.svg")]
    assert pictures == ["picture.svg"]
    # systems-check-values.md, d3, d4, d5: w', mean impact power, share of the lower end, period doubling
    (log,) = (project.root / "data" / "results").rglob("*.mcap")
    kept = read(log)
    assert kept.system == "impact_pair"
    assert (kept.parameters, kept.impacts.num_rows) == ({"B": 0.65, "G": 0.05, "r": 0.5}, 6)
    verified = verify("pair", recompute=60)
    assert verified.good, [line.first for line in verified.lines if line.first]
    again = {line.name: line.checked for line in verified.lines if line.group == "recomputed"}
    assert {f"impact_pair_{name}" for name in ("points", "impacts", "orbits", "bifurcations")} < set(again)
    assert all(again.values())
    first = vines.query('select * from "pair.points" where B = 0.6').to_pylist()[0]
    assert (first["name"], first["word"], first["ties"]) == ("1:1", "LR", 0)
    assert math.isclose(first["impact_power"], 0.197859747453, abs_tol=1e-11)
    # the law of the mechanical bound, (1 - r²)/2 = .375, harvests all that impacts lose
    assert math.isclose(first["harvested_left"] + first["harvested_right"], first["impact_power"], rel_tol=1e-9)
    assert math.isclose(first["harvested_left"] / first["impact_power"], 0.5810679551, abs_tol=1e-9)
    hits = vines.query("select w_dot, w, side, ball from impact_pair_impacts where B = 0.6 order by w").to_pylist()
    assert [round(hit["w_dot"], 9) for hit in hits] == [-1.178487055, 1.387926565]
    assert [(round(hit["w"], 12), hit["side"], hit["ball"]) for hit in hits] == [(-1.0, -1, 0), (1.0, 1, 0)]
    second = vines.query('select * from "pair.chain" where B = 0.95').to_pylist()[0]
    assert (second["name"], second["carry"]) == ("2:1", "B")
    assert math.isclose(second["impact_power"], 0.345298986768, abs_tol=1e-10)
    # above the threshold are one impact on each end
    strong = 0.375 * 1.707169110110**2 / (2 * math.pi), 0.375 * 1.609274437273**2 / (2 * math.pi)
    assert math.isclose(second["harvested_left"], strong[0], abs_tol=1e-9)
    assert math.isclose(second["harvested_right"], strong[1], abs_tol=1e-9)
    met = vines.query("select * from impact_pair_bifurcations where type != 'pair_turns_real'").to_pylist()
    assert [(each["type"], each["parameter"]) for each in met] == [("period_doubling", "B")]
    assert math.isclose(met[0]["value"], 0.96031987596, abs_tol=1e-10)
    orbits = vines.query("select w, w_dot, impact_power, B from impact_pair_orbits order by B").to_pylist()
    assert orbits[0]["w"] == pytest.approx([-1.0, 1.0]) or orbits[0]["w"] == pytest.approx([1.0, -1.0])
    assert math.isclose(orbits[0]["impact_power"], 0.197859747453, abs_tol=1e-11)
    shared = vines.query(
        "select system, A, B, name, impact_power, ties from all_points where B = 0.6 or A > 0"
    ).to_pylist()
    (ball,) = vines.table("points").to_pylist()
    power = (ball["impact_loss_left"] + ball["impact_loss_right"]) / ball["duration"]
    assert sorted(map(tuple, (each.values() for each in shared))) == [
        ("impact_pair", None, 0.6, "1:1", first["impact_power"], 0),
        ("vi_nes", 0.015, None, "1:1", power, 0),
    ]
    assert vines.query("select count(*) as n from all_orbits where system = 'impact_pair'").to_pylist() == [
        {"n": vines.table("impact_pair_orbits").num_rows}
    ]
    screen = found("pair")
    assert [line for line in screen if not line.startswith(" ")] == ["Found", "", "Files", "", "Next"]
    assert "  2 points: 2 1:1  (points)" in screen
    assert "  asymmetric 1:1 at B = 0.65  (run)" in screen
    assert any("select B, name, impact_power from impact_pair_points" in line for line in screen)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (("r = 0.5", "r = 1.5"), "r is 1.5, allowed is 0 <= r <= 1"),
        (("r = 0.5", "nu = 0.5"), "params: unknown key 'nu'"),
        (("settle = 200", "settle = 200\nstart = { x1 = 0 }"), "unknown coordinate 'x1' of a start"),
        (("settle = 200", "settle = 200\nstart = { w = 2 }"), "w is 2 at the start, allowed is -1 <= w <= 1"),
        (('panels = ["w_dot", "phase"]', 'panels = ["x1"]'), "unknown panel 'x1'"),
        (('needs = ["points", "doubling"]', 'needs = ["points", "ball"]'), "one and the same parameter"),
        (("threshold = 1.0", "threshold = -1.0"), "threshold"),
        (('kind = "branch"', 'kind = "reduced"'), "the kind 'reduced' cannot do the system 'impact_pair'"),
        (
            ('kind = "branch"\nword = "LR"\npoints = 5', 'kind = "curve"\nword = "LR"\ntype = "fold"'),
            "a curve is followed in two parameters, this one varies B",
        ),
        (
            ('kind = "branch"\nword = "LR"\npoints = 5', 'kind = "transient"'),
            "cannot do the system 'impact_pair': its capsule moves as it is driven, so nothing decays; it can do",
        ),
        (('word = "LR"', 'word = "L1"'), "'L1' is not a word of the system"),
    ],
)
def test_what_cannot_be_is_refused_before_any_work(pair, change, text):
    pair(PAIR.replace(*change))
    with pytest.raises(VinesError, match=re.escape(text)) as caught:
        load_pipeline("pair")
    assert "\n" not in str(caught.value)


def test_si_units_with_the_tilt_in_degrees(pair):
    si = "[physical]\nhalf_length = 0.1\nomega = 15.7\ntilt = 10.0\n[stages.points]"
    text = PAIR.replace("[stages.points]", si)
    for given in ("params.G = 0.05\n", "params.G = 0.15\n", ", G = 0.05"):
        text = text.replace(given, "")
    pair(text)
    stage = load_pipeline("pair").stages["points"]
    assert stage.params["G"] == vines.systems.ImpactPair.from_physical(half_length=0.1, omega=15.7, tilt=10.0, B=1.0).G


def test_the_pipeline_of_the_page_is_one(pair):
    page = Path(__file__).resolve().parents[2] / "docs" / "systems.md"
    (text,) = re.findall(r"^```toml\n(title = .*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    pair(text)
    stages = load_pipeline("pair").stages
    assert {name: stage.kind.system for name, stage in stages.items()} == dict.fromkeys(stages, "impact_pair")
    assert stages["power"].params["G"] == stages["doubling"].params["G"] > 0
