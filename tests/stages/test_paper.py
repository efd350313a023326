"""The paper as a whole: every figure is a member, and a coarse version of all of them runs from end to end."""

import json
import shutil
import tomllib
from pathlib import Path

import pytest

from tests.project import Project

pytestmark = [pytest.mark.long(25), pytest.mark.usefixtures("coarse_look")]

PIPELINES = Path(__file__).resolve().parents[2] / "pipelines"
FIGURES = [f"fig{k}" for k in range(2, 12)]
MEMBERS = tomllib.loads((PIPELINES / "paper.toml").read_text("utf-8"))["pipelines"]
SHORT = {"settle": 60, "record": 32, "watch": 64, "random": 1}
COUNT = 5


def coarse(member):
    """Yield what makes a pipeline quick: short runs, few points, but those that other stages start from."""
    stages = tomllib.loads((PIPELINES / f"{member}.toml").read_text("utf-8"))["stages"]
    carried = [stage["carry"] for stage in stages.values() if isinstance(stage.get("carry"), dict)]
    starts = {carry["start"]["from"] for carry in carried if "start" in carry}
    for name, stage in stages.items():
        place = f"{member}.stages.{name}"
        if stage["kind"] in ("sweep", "trajectory"):
            yield from (f"{place}.{key}={value}" for key, value in SHORT.items() if stage.get(key, 0) > value)
        if stage["kind"] == "sweep" and name not in starts:
            for axis, form in stage.get("vary", {}).items():
                if isinstance(form, dict):
                    ends = f"from = {form['from']}, to = {form['to']}"
                    yield f"{place}.vary.{axis}={{ {ends}, count = {COUNT} }}"
        if stage["kind"] == "branch":
            yield f"{place}.points=13"
        if stage["kind"] == "figure":
            yield f'{place}.look.formats=["png"]'


@pytest.fixture(scope="module")
def paper(tmp_path_factory):
    """Return a project in which the coarse paper has been run once; not to be changed."""
    root = tmp_path_factory.mktemp("paper")
    shutil.copytree(PIPELINES, root / "pipelines")
    project = Project(root)
    settings = [part for member in MEMBERS for text in coarse(member) for part in ("--set", text)]
    project.first = project.vines("run", "paper", "--quiet", "--jobs", "1", *settings, check=False)
    return project


def test_the_paper_has_all_figures():
    assert [name for name in MEMBERS if name in FIGURES] == FIGURES


def test_every_figure_is_made(paper):
    for name in MEMBERS:
        stages = tomllib.loads((PIPELINES / f"{name}.toml").read_text("utf-8"))["stages"]
        pins = json.loads((paper.data / "pipelines" / f"{name}.pins.json").read_text())
        # Claims are about the full grids; whether one finds its rows in the coarse ones is no matter.
        assert {stage for stage in stages if stages[stage]["kind"] != "check"} <= set(pins), paper.first.stderr
        for stage, pin in pins.items():
            folder = paper.data / "results" / pin["result"]
            if pin["kind"] == "figure":
                assert (folder / "picture.png").stat().st_size > 10_000, f"{name}.{stage}"
                assert [path.name for path in folder.glob("picture.*")] == ["picture.png"]


def test_figures_share_their_points(paper):
    manifests = {
        name: json.loads((paper.data / "pipelines" / f"{name}.pins.json").read_text())["frequency_up"]["ingredients"]
        for name in ("fig3", "fig7", "fig9")
    }
    assert len({json.dumps({**form, "vary": 0}, sort_keys=True) for form in manifests.values()}) == 1
    count = "select count(*), count(distinct point_id) from points where stage = 'frequency_up' and pipeline != 'fig6'"
    rows, distinct = json.loads(paper.vines("query", count, "--format", "json").stdout)[0].values()
    assert rows == (2 + 4 + 6) * COUNT
    assert distinct == rows - (2 + 1) * COUNT  # those of fig3, and the first of fig7, are in fig9


def test_every_energy_point_has_its_yardsticks(paper):
    sql = """
    select count(*) as n, count(*) filter (x1_no_ball > 0 and x1_locked > 0 and reduction > 0) as known
    from points where pipeline in ('fig3', 'fig7', 'fig8', 'fig9')
    """
    (row,) = json.loads(paper.vines("query", sql, "--format", "json").stdout)
    assert row["n"] == row["known"] > 0


def test_coexisting_attractors_have_impacts(paper):
    sql = """
    select count(*) as n from attractors as a where a.pipeline = 'fig7' and a.attractor > 0 and a.impacts_per_period > 0
    and not exists (select 1 from impacts as i where i.pipeline = 'fig7' and i.stage = a.stage
                    and i.point_id = a.point_id and i.attractor = a.attractor)
    """
    (row,) = json.loads(paper.vines("query", sql, "--format", "json").stdout)
    assert row["n"] == 0


@pytest.mark.full
def test_the_paper_in_full(project):
    done = project.process("run", "paper", "--quiet", timeout=1800)
    assert "stages are up to date" in project.vines("run", "paper").stdout
    assert done.returncode == 0
