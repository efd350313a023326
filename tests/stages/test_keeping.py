"""Graph, gc, diff, the schema for editors, and results on another machine: as a user calls them."""

import json
import shutil
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
SMALL = """
[params]
mu = 0.01
[stages.up]
kind = "sweep"
vary.A = { from = 0.015, to = 0.017, count = 3 }
settle = 50
record = 16
"""


def declare(project, text=SMALL, name="small"):
    shutil.rmtree(project.root / "pipelines")
    (project.root / "pipelines").mkdir()
    (project.root / "pipelines" / f"{name}.toml").write_text(text)


def test_the_committed_schema_is_current(project):
    said = project.process("schema", "--declaration").stdout  # other tests have kinds of their own here
    committed = (REPOSITORY / "schemas" / "pipeline.schema.json").read_text("utf-8")
    assert said == committed, "run: vines schema --declaration > schemas/pipeline.schema.json"


def test_diff_gc_graph_and_a_store_that_was_moved(project):
    declare(project)
    project.vines("run", "small", "--quiet", "--jobs", "1")
    first = json.loads((project.data / "pipelines" / "small.pins.json").read_text())["up"]["result"]
    assert project.vines("gc").stdout.startswith("nothing to remove")
    project.vines("run", "small", "--quiet", "--jobs", "1", "--set", "params.r=0.6")
    different = project.vines("diff", first[:8], "small.up", check=False)
    assert different.returncode == 1
    assert "asked for: r 0.65 → 0.6" in different.stdout
    assert "points: 3 rows in both" in different.stdout
    assert "  kinetic_ratio: 3 differ, largest difference" in different.stdout
    assert "first at A = 0.015, row 1" in different.stdout
    assert project.vines("diff", "small.up", str(project.data / "results" / first), "--rtol", "10").returncode == 0
    assert json.loads(project.vines("diff", first[:8], first[:10], "--json").stdout)["same"] is True
    wrong = project.vines("diff", "small.upp", first[:8], check=False)
    assert "did you mean 'small.up'" in wrong.stderr

    # declared is r = 0.65 again: its points are wanted, its result is not pinned
    found = json.loads(project.vines("gc", "--json").stdout)
    assert [(each["what"], each["key"]) for each in found["found"]] == [("result", first)]
    assert "would be removed" in project.vines("gc").stdout
    assert "MB removed" in project.vines("gc", "--yes").stdout
    assert not (project.data / "results" / first).exists()
    assert "flowchart LR\n    stage_up[" in project.vines("graph", "small").stdout
    again = project.vines("run", "small")
    assert "everything is computed, the result has to be put together" in again.stdout

    moved = project.root / "another machine" / "data"
    moved.parent.mkdir()
    shutil.copytree(project.data, moved)
    shutil.rmtree(project.data)
    shutil.copytree(project.root / "pipelines", moved.parent / "pipelines")
    from vines.store import Store

    store = Store(moved)
    result = store.result(store.pins("small")["up"]["result"])
    assert result.damage() == []
    assert str(project.root) not in (result.folder / "manifest.json").read_text()
    project.root = moved.parent
    assert "nothing to compute" in project.vines("run", "small").stdout
    assert "3" in project.vines("query", "select count(*) from small.up").stdout
    with (result.folder / "points.parquet").open("r+b") as stream:
        stream.seek(50)
        stream.write(b"x")
    assert result.damage() == ["points.parquet is damaged: its checksum differs from that of what was written"]
