"""Collections of pipelines: as a user declares, runs, and asks them."""

import json
import shutil

import pytest

SWEEP = """
title = "{title}"
[params]
mu = {mu}
[stages.up]
kind = "sweep"
vary.A = {{ from = 0.015, to = 0.017, count = 3 }}
settle = 50
record = 16
[stages.figure]
kind = "figure"
plot = "bifurcation"
needs = ["up"]
[stages.checks]
kind = "check"
claims = ["one"]
needs = ["up"]
"""
CLAIM = """
[one]
source = "Fig. 4"
statement = "the attractor at A = 0.015"
published = "1:1"
ours = "select name from points where A = 0.015"
"""
ALL = 'title = "Both"\nsource = "Figs 1, 2"\npipelines = ["second", "first"]\n'


@pytest.fixture
def both(project):
    folder = project.root / "pipelines"
    shipped = (folder / "claims.toml").read_text()
    shutil.rmtree(folder)
    folder.mkdir()
    (folder / "first.toml").write_text(SWEEP.format(title="first", mu=0.01))
    (folder / "second.toml").write_text(SWEEP.format(title="second", mu=0.02).replace('"one"', '"one", "gone"', 1))
    (folder / "claims.toml").write_text(
        shipped + CLAIM + CLAIM.replace("[one]", "[gone]").replace("name from", "nothing from")
    )
    (folder / "pair.toml").write_text(ALL)
    return project


def test_a_failing_pipeline_does_not_stop_the_others(both):
    rows = {row["name"]: row for row in json.loads(both.vines("list", "--json").stdout)}
    assert rows["pair"]["pipelines"] == ["second", "first"]
    assert rows["first"]["pipelines"] == []
    assert "2 pipelines" in both.vines("list").stdout
    dry = both.vines("run", "pair", "--dry-run").stdout
    assert [line.split()[0] for line in dry.splitlines()[1:]] == [
        *("second.up", "second.figure", "second.checks", "first.up", "first.figure", "first.checks")
    ]

    done = both.vines("run", "pair", "--jobs", "1", check=False)
    assert done.returncode == 3
    assert "pair: stage second.checks failed: " in done.stderr
    assert "first.up: done, 3 points" in done.stdout
    assert "1 of 1 published values reproduced" in done.stdout
    assert "data/figures/first." in done.stdout
    assert done.stdout.index("second.up") < done.stdout.index("first.up")

    status = both.vines("status", "pair").stdout
    assert "second    2 of 3" in status
    assert "first     3 of 3        up to date" in status
    plans = json.loads(both.vines("status", "pair", "--json").stdout)
    assert [each["state"] for each in plans["first"]] == ["up_to_date"] * 3
    assert "pair" not in both.vines("status").stdout
    checked = json.loads(both.vines("check", "pair", "--json").stdout)
    assert [(row["pipeline"], row["verdict"]) for row in checked] == [("first", "reproduced")]
    graph = both.vines("graph", "pair").stdout
    assert '    subgraph pipeline_first["first: first"]' in graph
    assert "    stage_first_up --> stage_first_figure" in graph
    assert graph.count("    end\n") == 2
    assert both.vines("gc").stdout.startswith("nothing to remove")


def test_stages_and_values_of_one_member(both):
    done = both.vines("run", "pair", "first.figure", "--set", "first.stages.up.vary.A.count=2", "--jobs", "1")
    assert "first.up: done, 2 points" in done.stdout
    assert "second" not in done.stdout
    again = both.vines("run", "pair", "first.figure", "--set", "first.stages.up.vary.A.count=2")
    assert "nothing to compute, all 2 stages are up to date" in again.stdout
    assert "3 of 3" in both.vines("run", "pair", "first", "--dry-run", "--force").stdout


@pytest.mark.parametrize(
    ("text", "arguments", "said"),
    [
        (ALL, ["run", "pair", "--set", "params.r=0.6"], "the name of a pipeline stands before the key"),
        (ALL, ["run", "pair", "frist"], "collection 'pair' has no pipeline 'frist': did you mean 'first'"),
        (ALL, ["run", "pair", "first.upp"], "pipeline 'first' has no stage 'upp': did you mean 'up'"),
        (ALL.replace("second", "secnd"), ["run", "pair"], "unknown pipeline 'secnd': did you mean 'second'"),
        (ALL.replace("second", "first"), ["status", "pair"], "pipelines names 'first' twice"),
        (ALL.replace("second", "pair"), ["graph", "pair"], "unknown pipeline 'pair'"),
        (ALL + "[params]\nmu = 1", ["run", "pair"], "unknown key 'params' of a collection, which has no stages"),
        (ALL.replace('["second", "first"]', "3"), ["run", "pair"], "pipelines is 3; list names of pipelines"),
        (ALL.replace('"Both"', "3"), ["run", "pair"], "title is 3; a text is needed here"),
    ],
)
def test_a_mistake_is_one_line_and_nothing_is_written(both, text, arguments, said):
    (both.root / "pipelines" / "pair.toml").write_text(text)
    done = both.vines(*arguments, check=False)
    assert done.returncode == 2
    assert said in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (both.data / "results").exists()


def test_a_collection_holds_no_collection_and_is_no_pipeline(both):
    folder = both.root / "pipelines"
    (folder / "more.toml").write_text('pipelines = ["pair"]')
    done = both.vines("run", "more", check=False)
    assert "'pair' is a collection itself; name its pipelines instead" in done.stderr
    from vines.errors import DeclarationError
    from vines.pipeline import load

    with pytest.raises(DeclarationError, match="a collection of pipelines"):
        load(folder / "pair.toml", root=both.root)
