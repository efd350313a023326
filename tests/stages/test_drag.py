"""A ball in a coil in pipelines: tables with the power of the coil, the plot of both measures, and what is refused."""

import math

import pytest

import vines
from vines.errors import VinesError
from vines.figures._front import front_of
from vines.logs import read
from vines.stages import load_pipeline, run, verify
from vines.systems import Drag

DRAG = """
title = "a coil"
system = "drag"
[params]
mu = 0.02
r = 0.9
[stages.points]
kind = "sweep"
params.A = 0.02
vary.delta = [0.1, 0.15]
settle = 200
random = 1
[stages.run]
kind = "trajectory"
params = { A = 0.02, delta = 0.15 }
settle = 100
record = 2
[stages.branch]
kind = "branch"
word = "LR"
points = 3
params.A = 0.02
vary.delta = { from = 0.1, to = 0.15 }
[stages.gone]
kind = "transient"
params.delta = 0.05
periods = 20
vary.V = [2.0]
[stages.front]
kind = "figure"
plot = "front"
most = "electric_power"
needs = ["points"]
"""


@pytest.fixture
def coil(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))

    def declare(text):
        (project.root / "pipelines" / "coil.toml").write_text(text)
        return project

    return declare


@pytest.mark.long(30)
def test_tables_hold_the_power_of_the_coil(coil):
    project = coil(DRAG)
    run("coil")
    assert len(list((project.root / "data" / "results").rglob("picture.svg"))) == 1
    found = verify("coil", recompute=20)
    assert found.good, [line.first for line in found.lines if line.first]
    (log,) = (project.root / "data" / "results").rglob("*.mcap")
    assert read(log).system == "drag"
    points = {row["delta"]: row for row in vines.query('select * from "coil.points"').to_pylist()}
    orbit = vines.find_orbit("LR", Drag(mu=0.02, A=0.02, r=0.9, delta=0.1))
    power = orbit.measures.travel_loss / orbit.measures.duration
    assert math.isclose(points[0.1]["electric_power"], power, rel_tol=1e-8)
    shared = vines.query("select electric_power from all_orbits order by electric_power").to_pylist()
    assert math.isclose(shared[0]["electric_power"], power, rel_tol=1e-9)
    (gone,) = vines.table("drag_transients").to_pylist()
    shares = [gone[f"{name}_share"] for name in ("impact", "damper", "electric", "left")]
    assert math.isclose(sum(shares), 1, abs_tol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ('kind = "branch"', 'kind = "reduced"', "the kind 'reduced' cannot do the system 'drag'"),
        ("mu = 0.02", "mu = 7.0", "mu is 7, allowed is 0 <= mu <= 4"),
        ('most = "electric_power"', 'most = "electric"', "has no column 'electric' of numbers: did you mean"),
        ('most = "electric_power"', 'colours = ["mu"]', "points does not vary mu; it varies delta"),
        ('needs = ["points"]', 'needs = ["gone"]', "gone is of kind 'transient'; a front is of sweeps"),
        ('word = "LR"', 'word = "LsR"', "LsR"),
    ],
)
def test_what_cannot_be_is_refused_before_any_work(coil, old, new, text):
    coil(DRAG.replace(old, new))
    with pytest.raises(VinesError, match=text.replace("*", r"\*")):
        load_pipeline("coil")


def test_the_front_holds_what_nothing_beats_in_both():
    import numpy as np

    rng = np.random.default_rng(1)
    least, most = rng.uniform(size=(2, 300)).round(2)
    best = front_of(least, most)
    for k in range(300):
        beaten = (least <= least[k]) & (most >= most[k]) & ((least < least[k]) | (most > most[k]))
        alike = [j for j in best if (least[j], most[j]) == (least[k], most[k])]
        assert bool(alike) is not bool(beaten.any())
