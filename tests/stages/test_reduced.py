"""The kind `reduced` from declaration to table and figure."""

import pytest

import vines
from vines.model import Params
from vines.orbits import reduced_orbits, symmetric_orbits
from vines.stages import run

SMALL = """
title = "small"
[params]
Omega = 1.0
[stages.map]
kind = "reduced"
vary.mu = [0.005, 0.01, 0.02]
vary.A = { from = 0.006, to = 0.03, count = 9 }
[stages.figure]
kind = "figure"
plot = "reduced"
needs = ["map"]
[stages.line]
kind = "reduced"
params.mu = 0.01
vary.A = [0.015]
"""


@pytest.fixture
def small(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "small.toml").write_text(SMALL)
    return project


def test_rows_hold_both_and_their_errors(small):
    run("small", stages=["figure"])
    rows = vines.query("select * from reduced where stage = 'map' order by mu, A").to_pylist()
    assert len(rows) == 27
    seen = set()
    for row in rows:
        p = Params(**{name: row[name] for name in ("mu", "A", "Omega", "r", "lam")})
        responses, orbits = reduced_orbits(p), symmetric_orbits(p)
        assert (row["responses"], row["exact_orbits"]) == (len(responses), len(orbits))
        assert row["status"] == "ok"
        assert row["stable_from"] < row["stable_to"]
        if not orbits:
            assert row["exact_stable"] is None
            continue
        assert row["exact_stable"] == orbits[0].stable
        assert row["exact_max_abs_x1"] == orbits[0].measures.max_abs_x1
        if responses:
            assert row["error_max_abs_x1"] == row["max_abs_x1"] / row["exact_max_abs_x1"] - 1
            assert abs(row["error_phase"]) < 0.5
            seen.add((row["stable"], row["exact_stable"]))
    assert {(True, True), (False, False)} <= seen
    (picture,) = small.data.glob("results/*/picture.png")
    assert picture.stat().st_size > 20_000


def test_a_figure_needs_two_axes(small):
    (small.root / "pipelines" / "small.toml").write_text(SMALL.replace('needs = ["map"]', 'needs = ["line"]'))
    done = small.vines("run", "small", check=False)
    assert done.returncode != 0
    assert "an error map needs stages of kind 'reduced' that vary two" in " ".join((done.stdout + done.stderr).split())
