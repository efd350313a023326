"""The kind `optimum` from declaration to table."""

import pytest

import vines
from vines.model import Params
from vines.orbits import optimise
from vines.stages import run

SMALL = """
title = "small"
[params]
mu = 0.01
A = 0.015
[stages.cavity]
kind = "optimum"
word = "LR"
objective = "max_abs_x1"
vary.b = { from = 1.0, to = 1.7 }
[stages.fixed]
kind = "optimum"
word = "LR"
objective = "max_abs_x1"
params.b = 2.0
vary.mu = { from = 0.01, to = 0.02 }
"""


@pytest.fixture
def small(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "small.toml").write_text(SMALL)
    return project


def test_the_row_is_the_optimum_and_the_orbit_comes_with_it(small):
    run("small", stages=["cavity"])
    (row,) = vines.query("select o.*, t, stable from optima o join orbits using (orbit_id)").to_pylist()
    best = optimise("LR", "max_abs_x1", Params(mu=0.01, A=0.015), {"b": (1.0, 1.7)})
    assert row["value"] == best.value
    assert row["b"] == best.b
    assert row["b_above"] == best.margins["b"].above
    assert (row["A_below_type"], row["A_above_type"]) == ("neimark_sacker", "symmetry_breaking")
    assert row["nearest_parameter"] == best.nearest[1]
    assert row["active"] == ""
    assert row["over"] == "b = 1 … 1.7"
    assert row["stable"]
    assert len(row["t"]) == 2


def test_a_cavity_that_is_not_varied_is_refused(small):
    done = small.vines("run", "small", "fixed", check=False)
    assert done.returncode != 0
    assert "vary it or give another A" in " ".join((done.stdout + done.stderr).split())
