"""The pipeline quickstart, end to end, as a user runs it."""

import json
import math
import os
import subprocess
import sys

import numpy as np
import pyarrow.parquet as pq
import pytest

import vines
from vines.logs import read


@pytest.fixture(scope="module")
def ask(quickstart):
    """Ask the catalogue of the quickstart in SQL and get plain rows."""

    def rows(sql):
        return json.loads(quickstart.vines("query", sql, "--format", "json").stdout)

    return rows


def test_the_end_of_the_run_says_what_was_found_and_what_next(quickstart):
    shown = (quickstart.root / "said.txt").read_text("utf-8")
    assert "symmetry breaking at A = 0.0180" in shown
    for command in ("vines view quickstart.", "vines query ", "vines check quickstart"):
        assert command in shown


def test_the_four_runs_of_fig_2(ask):
    rows = ask("select stage, name, alias, points.symmetric, settled from points where stage like '%_run' order by A")
    assert [(r["stage"], r["name"], r["symmetric"], r["settled"]) for r in rows] == [
        ("symmetric_run", "1:1", True, True),
        ("asymmetric_run", "1:1", False, True),
        ("doubled_run", "2:2/2T", False, True),
        ("two_one_run", "2:1", False, True),
    ]
    assert rows[2]["alias"] == "1:1/2T"


def test_symmetry_breaks_near_018(ask):
    (row,) = ask("select value, multiplier_re, multiplier_im from bifurcations where type = 'symmetry_breaking'")
    assert row["value"] == pytest.approx(0.0180, abs=5e-5)
    assert row["multiplier_re"] == pytest.approx(1.0, abs=1e-8)
    assert row["multiplier_im"] == 0


def test_simulation_and_closed_form_agree_where_the_orbit_is_stable(ask):
    simulated = ask("select A, side, w_dot from impacts where stage = 'up' and A < 0.0178")
    assert len(simulated) >= 2 * 50
    worst = 0.0
    orbits = {}
    for row in simulated:
        A = row["A"]
        orbits.setdefault(A, vines.find_orbit("LR", vines.Params(mu=0.01, A=A)))
        orbit = orbits[A]
        assert orbit.stable
        theirs = orbit.w_dot[list(orbit.side).index(row["side"])]
        worst = max(worst, abs(row["w_dot"] - theirs))
    assert worst < 1e-10


def test_the_sweep_is_complete_and_says_what_is_not_settled(ask):
    rows = ask("select A, regime, settled, status, remaining, reduction from points where stage = 'up' order by A")
    assert len(rows) == 181
    assert all(r["status"] == "ok" for r in rows)
    assert all(0 < r["reduction"] < 1 for r in rows)
    slow = [r["A"] for r in rows if r["regime"] == "unsettled"]
    assert all(r["remaining"] is None or r["remaining"] > 0 for r in rows if r["regime"] == "unsettled")
    assert len(slow) < 25
    # Only near a bifurcation does an orbit settle slowly: here symmetry breaking and the doublings of the cascade.
    assert all(abs(A - 0.018) < 4e-4 or 0.0204 < A < 0.0222 for A in slow), slow


def test_energy_balances_in_every_settled_row(ask):
    rows = ask("select * from points")
    for r in rows:
        spent = r["damper_loss"] + r["impact_loss_left"] + r["impact_loss_right"] + r["energy_change"]
        assert spent == pytest.approx(r["base_work"], rel=1e-12)
        if r["regime"] == "periodic" and r["settled"]:
            assert abs(r["energy_change"]) < 1e-8 * r["base_work"]


def test_every_file_carries_provenance_and_units(quickstart):
    files = list(quickstart.data.glob("results/*/*.parquet"))
    assert len(files) >= 10
    for file in files:
        schema = pq.read_schema(file)
        told = json.loads(schema.metadata[b"vines"])
        assert told["provenance"]["kind"] in {"trajectory", "sweep", "branch", "check"}
        assert told["provenance"]["key"]
        if "w_dot" in schema.names and file.name == "impacts.parquet":
            assert schema.field("w_dot").metadata[b"unit"] == b"1"
    logs = list(quickstart.data.glob("results/*/logs/*.mcap"))
    assert len(logs) == 4
    for file in logs:
        log = read(file)
        assert log.complete
        assert log.provenance["kind"] == "trajectory"
        states = log.states.to_pandas()
        assert np.abs(states["w"]).max() <= 1 + 1e-12
        assert states["t"].iloc[-1] == pytest.approx(10 * 2 * math.pi)


def test_figure_is_there_in_both_forms(quickstart):
    pins = json.loads((quickstart.data / "pipelines" / "quickstart.pins.json").read_text())
    folder = quickstart.data / "results" / pins["figure"]["result"]
    assert (folder / "picture.png").stat().st_size > 20_000
    assert (folder / "picture.svg").read_text().startswith("<?xml")


def test_a_second_run_computes_nothing_and_says_so(quickstart):
    before = sorted((p, p.stat().st_mtime_ns) for p in quickstart.data.glob("results/*/*"))
    again = quickstart.vines("run", "quickstart")
    assert "nothing to compute" in again.stdout
    assert sorted((p, p.stat().st_mtime_ns) for p in quickstart.data.glob("results/*/*")) == before


def test_a_run_with_nothing_to_do_loads_nothing_heavy(quickstart):
    heavy = ("numba", "numpy", "scipy", "pandas", "pyarrow", "matplotlib", "duckdb", "rerun", "importlib.metadata")
    code = (
        f"import sys\nsys.argv = ['vines', 'run', 'quickstart']\nfrom vines.cli import main\ntry:\n    main()\n"
        f"except SystemExit as end:\n    print([name for name in {heavy} if name in sys.modules], end.code)\n"
    )
    environment = {**os.environ, "VINES_ROOT": str(quickstart.root)}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment, cwd=quickstart.root)
    assert "nothing to compute" in done.stdout
    assert done.stdout.splitlines()[-1] == "[] 0"


def test_check_prints_a_row_a_claim(quickstart):
    done = quickstart.vines("check", "quickstart", "--json", check=False)
    rows = {row["id"]: row for row in json.loads(done.stdout)}
    assert set(rows) == {
        "fig2_a", "fig2_d", "fig2_g", "fig2_j", "fig4_pair_turns_real", "fig4_symmetry_breaking",
    }  # fmt: skip
    assert done.returncode == int(any(row["verdict"] == "differs" for row in rows.values()))
    assert rows["fig4_symmetry_breaking"]["verdict"] == "reproduced"
    for name in ("fig2_a", "fig2_d", "fig2_g", "fig2_j"):
        assert rows[name]["verdict"] == "reproduced", rows[name]


def test_python_surface(quickstart, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(quickstart.root))
    assert vines.run("quickstart").new == 0
    orbits = vines.table("orbits").to_pandas()
    assert list(orbits.columns[:3]) == ["pipeline", "stage", "point_id"]
    assert vines.query("select count(*) as n from points").to_pylist() == [{"n": 185}]
