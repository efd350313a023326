"""Runs that cannot be reconstructed are rows with the reason, and undecidable, while the others go on."""

import json

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
