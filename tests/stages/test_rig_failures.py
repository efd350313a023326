"""Runs that cannot be reconstructed are rows with the reason, and undecidable, while the others go on."""

import json
import shutil

import pytest

from vines.rig.synth import RigSettings, make_run

LIGHT = {"rate": 12800.0, "settle": 0.0}
FREE = RigSettings(
    run_id="free", protocol="ringdown", ball=False, E=0.0, duration=8.0, start=(0.012, 0.0, 0.0, 0.0), **LIGHT
)
STILL = RigSettings(run_id="still", duration=4.0, E=2e-5, ringdown=("free",), start=(0.0, 0.0, 0.0, 0.0), **LIGHT)

PIPELINE = """
title = "a ball that does not move"
[stages.ingest]
kind = "ingest"
folder = "runs"
[stages.reconstruct]
kind = "reconstruct"
needs = ["ingest"]
[stages.compare]
kind = "compare"
needs = ["reconstruct"]
[stages.waits]
kind = "figure"
plot = "rig_waits"
needs = ["compare"]
[stages.branches]
kind = "figure"
plot = "rig_branches"
needs = ["reconstruct"]
"""


def test_a_run_without_impacts_is_a_row_that_says_so(project):
    make_run(project.root / "runs" / "free", FREE, 1)
    # The oscillator moves by two millimetres at most in four seconds, the ball is met by no end.
    make_run(project.root / "runs" / "still", STILL, 2)
    (project.root / "pipelines" / "still.toml").write_text(PIPELINE)
    project.vines("run", "still", "--jobs", "2")

    def rows(sql):
        return json.loads(project.vines("query", sql, "--format", "json").stdout)

    (row,) = rows("select * from reconstructions")
    assert (row["run_id"], row["status"], row["accepted"], row["ringdown"]) == ("still", "failed", False, "free")
    assert "impacts, allowed are 6 and more" in row["reason"]
    assert row["r"] is None
    (told,) = rows("select * from comparisons")
    assert (told["verdict"], told["basis"], told["branch"]) == ("undecidable", "measured", None)
    assert told["reason"] == f"not reconstructed: {row['reason']}"
    assert rows("select count(*) as n from rig_impacts") == [{"n": 0}]
    assert "all hold" in project.vines("verify", "still").stdout
    assert len(list(project.data.glob("results/*/picture.png"))) == 2


GOOD = RigSettings(run_id="good", duration=8.0, settle=20.0, rate=12800.0, ringdown=("free",))


def _cell(run, column, value):
    head, *rows = [line.split("\t") for line in (run / "channels.tsv").read_text().splitlines()]
    rows[-1][head.index(column)] = value
    (run / "channels.tsv").write_text("\n".join("\t".join(row) for row in [head, *rows]) + "\n")


def _raw(run):
    return run / "raw" / "run.tdms"


def _as_folder(run):
    _raw(run).unlink()
    _raw(run).mkdir()


FAULTS = {
    "missing": (lambda run: _raw(run).unlink(), "run.tdms is missing"),
    "a_folder": (_as_folder, "run.tdms is missing"),
    "empty": (lambda run: _raw(run).write_bytes(b""), "the file is empty"),
    "damaged": (lambda run: _raw(run).write_bytes(b"TDSm" + bytes(range(200))), "no channel with samples"),
    "foreign": (lambda run: _raw(run).write_bytes(b"\x00\x01" * 900), "run.tdms"),
    "unit": (lambda run: _cell(run, "unit", "mm"), "the file says V"),
    "role": (lambda run: _cell(run, "role", "n/a"), "no role"),
    "dialect": (lambda run: _cell(run, "dialect", "separator=comma"), "which has none"),
    "no_table": (lambda run: (run / "channels.tsv").unlink(), "channels.tsv is missing"),
    "no_form": (lambda run: (run / "run.json").unlink(), "run.json is missing"),
    "no_json": (lambda run: (run / "run.json").write_text("{"), "is not JSON"),
    "not_text": (lambda run: (run / "channels.tsv").write_bytes(b"\xff\xfe\x00name"), "is not UTF-8"),
    "same_name": (lambda run: None, "another run is called 'good' too"),
}
"""What may be wrong with one run of a campaign, and a part of the reason."""


@pytest.fixture
def campaign(project):
    """Return the folder of a good run, its ring-down, one that gives no omega0, and a run with each fault."""
    runs = project.root / "runs"
    make_run(runs / "free", FREE, 1)
    make_run(runs / "good", GOOD, 3)
    for name, (spoil, _) in FAULTS.items():
        shutil.copytree(runs / "good", runs / name)
        form = json.loads((runs / name / "run.json").read_text())
        if name != "same_name":
            (runs / name / "run.json").write_text(json.dumps({**form, "run_id": name}))
        spoil(runs / name)
    # A recording of a rig at rest, and a run that names it.
    resting = make_run(runs / "resting", STILL, 4)
    form = json.loads((runs / "resting" / "run.json").read_text())
    told = {"run_id": "resting", "protocol": "ringdown", "f_cmd": None, "E_cmd": None, "ball": False, "ringdown": []}
    (runs / "resting" / "run.json").write_text(json.dumps({**form, **told}))
    assert resting.rows
    shutil.copytree(runs / "good", runs / "by_rest")
    form = json.loads((runs / "good" / "run.json").read_text())
    (runs / "by_rest" / "run.json").write_text(json.dumps({**form, "run_id": "by_rest", "ringdown": ["nothing"]}))
    return runs


def test_one_bad_run_is_a_row_with_its_reason_and_the_others_go_on(project, campaign):
    (project.root / "pipelines" / "bad.toml").write_text(PIPELINE.partition("[stages.compare]")[0])
    project.vines("run", "bad", "--jobs", "1")

    def rows(sql):
        return {row["run_id"]: row for row in json.loads(project.vines("query", sql, "--format", "json").stdout)}

    read = rows("select * from rig_runs")
    assert {name for name, row in read.items() if row["status"] == "ok"} == {"good", "free", "resting", "by_rest"}
    for name, (_, reason) in FAULTS.items():
        assert read[name]["status"] == "failed"
        assert reason in read[name]["reason"]
        assert "\n" not in read[name]["reason"]
    found = rows("select * from reconstructions")
    assert found["good"]["status"] == "ok"
    assert found["good"]["ringdown"] == "free"
    assert found["good"]["r"] == pytest.approx(0.65, abs=0.05)
    for name in FAULTS:
        assert found[name]["reason"] == f"not ingested: {read[name]['reason']}"
    assert found["resting"]["reason"].startswith("no omega0: ")
    assert "names the ring-down 'nothing', which is not at hand" in found["by_rest"]["reason"]
    assert "all hold" in project.vines("verify", "bad").stdout

    # By hand the same.
    said = project.vines("rig", "ingest", "runs", check=False)
    assert said.returncode == 1
    assert "4 runs ingested" in said.stdout
    assert all(f"{name} refused: " in said.stdout for name in FAULTS)
    said = project.vines("rig", "reconstruct", "runs", "--json", check=False)
    assert said.returncode == 1
    told = {row["run_id"]: row for row in json.loads(said.stdout)}
    assert told["good"]["status"] == "ok"
    for name, (_, reason) in FAULTS.items():
        # By hand a run stands for itself, whatever others are called.
        assert name == "same_name" or reason in told[name]["reason"]


def test_a_change_in_any_of_several_runs_is_seen(project):
    """Files of run folders have the same names; each counts in the key."""
    for name in ("a", "b"):
        make_run(project.root / "runs" / name, RigSettings(run_id=name, duration=2.0, settle=0.5, rate=12800.0), 1)
    assert "2 runs ingested" in project.vines("rig", "ingest", "runs").stdout
    assert "nothing to do" in project.vines("rig", "ingest", "runs").stdout
    form = json.loads((project.root / "runs" / "a" / "run.json").read_text())
    (project.root / "runs" / "a" / "run.json").write_text(json.dumps({**form, "temperature_after": 21.0}))
    assert "2 runs ingested" in project.vines("rig", "ingest", "runs").stdout
