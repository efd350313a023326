"""A ball that slides in pipelines: tables with stops in words and the power of friction, a log, and what is refused."""

import math

import pytest

import vines
from vines.errors import VinesError
from vines.stages import load_pipeline, run, verify
from vines.systems import Friction

FRICTION = """
title = "friction"
system = "friction"
[params]
mu = 0.1
r = 0.7
f = 0.3
[stages.run]
kind = "trajectory"
params.A = 0.2
settle = 150
record = 2
[stages.branch]
kind = "branch"
word = "LLsR"
points = 2
vary.A = { from = 0.2, to = 0.201 }
[stages.gone]
kind = "transient"
periods = 20
vary.V = [2.0]
"""


@pytest.fixture
def slid(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))

    def declare(text):
        (project.root / "pipelines" / "slid.toml").write_text(text)

    return declare


@pytest.mark.long(30)
def test_tables_hold_stops_and_the_power_of_friction(slid):
    slid(FRICTION)
    run("slid")
    found = verify("slid", recompute=2)
    assert found.good, [line.first for line in found.lines if line.first]
    (point,) = vines.table("friction_points").to_pylist()
    assert (point["word"], point["name"], point["regime"]) == ("LLsR", "2:1", "periodic")
    orbit = vines.find_orbit("LLsR", Friction(mu=0.1, A=0.2, r=0.7, f=0.3))
    power = orbit.measures.travel_loss / orbit.measures.duration
    assert math.isclose(point["friction_power"], power, rel_tol=1e-8)
    first = vines.query("select * from friction_orbits order by A").to_pylist()[0]
    assert math.isclose(first["friction_power"], power, rel_tol=1e-8)
    assert first["side"] == [1, 1, 0, -1]


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        (
            'kind = "branch"\nword = "LLsR"\npoints = 2\nvary.A = { from = 0.2, to = 0.201 }',
            'kind = "curve"\ntype = "incomplete_chatter"\nword = "L*sR"\nvary.A = { from = 0.2, to = 0.201 }\n'
            "vary.f = { from = 0.2, to = 0.3 }",
            "where orbits that stick end is followed for the system 'vi_nes' only",
        ),
        ('system = "friction"', 'system = "drag"', "'LLsR' is not a word of the system 'drag'"),
    ],
)
def test_what_cannot_be_is_refused_before_any_work(slid, old, new, text):
    slid(FRICTION.replace(old, new).replace("f = 0.3", "delta = 0.3") if "drag" in new else FRICTION.replace(old, new))
    with pytest.raises(VinesError, match=text):
        load_pipeline("slid")
