"""What users call from Python, away from the quickstart."""

import json

import pytest

import vines
from vines.errors import StateError, StoreError, UnknownNameError
from vines.stages import checks, find_logs, init_study, list_pipelines, run, status, status_of_each


@pytest.fixture
def root(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    return project.root


SMALL = """
title = "small"
[params]
mu = 0.01
[stages.up]
kind = "sweep"
vary.A = { from = 0.015, to = 0.016, count = 5 }
settle = 60
record = 8
"""


def test_set_changes_a_value_and_shares_points(root):
    (root / "pipelines" / "small.toml").write_text(SMALL)
    assert run("small").stages[0].new == 5
    again = run("small", overrides={"stages.up.vary.A.count": 9})
    assert again.stages[0].new == 4
    (plan,) = status("small")
    assert plan.state == "stale"
    assert "9" in plan.reason
    assert "5" in plan.reason


def test_force_computes_again(root):
    (root / "pipelines" / "small.toml").write_text(SMALL)
    run("small")
    assert run("small").new == 0
    assert run("small", force=True).stages[0].new == 5


def test_a_file_anywhere_is_a_pipeline(root, tmp_path):
    (tmp_path / "elsewhere.toml").write_text(SMALL)
    run(str(tmp_path / "elsewhere.toml"))
    assert vines.query("select count(*) as n from points where pipeline = 'elsewhere'").to_pylist() == [{"n": 5}]


def test_a_status_of_all_reads_each_text_and_each_source_once(root, monkeypatch):
    import tomllib
    from collections import Counter

    from vines.pipeline import _code, _include
    from vines.stages.bodies import _claims

    _include._loads.cache_clear()
    _claims._claims.cache_clear()
    texts, sources = Counter(), Counter()
    loads, read, read_once = tomllib.loads, _code.read_source, _code.read_source_once

    def counted_loads(text, **options):
        texts[text] += 1
        return loads(text, **options)

    def counted(function):
        def inner(module, *about):
            sources[module] += 1
            return function(module, *about)

        return inner

    monkeypatch.setattr(tomllib, "loads", counted_loads)
    monkeypatch.setattr(_code, "read_source", counted(read))
    monkeypatch.setattr(_code, "read_source_once", counted(read_once))
    plans, unreadable = status_of_each()
    assert len(plans) > 10
    assert not unreadable
    assert texts[(root / "pipelines" / "claims.toml").read_text()] == 1
    assert texts[(root / "pipelines" / "quickstart.toml").read_text()] == 1
    assert set(texts.values()) == {1}
    assert "vines.stages.plots._figure" in sources
    assert set(sources.values()) == {1}


def test_a_value_that_is_set_stays_out_of_what_others_read(root):
    (root / "pipelines" / "small.toml").write_text(SMALL)
    assert status("small", overrides={"stages.up.vary.A.count": 9, "params.mu": 0.02})[0].wanted == 9
    assert status("small")[0].wanted == 5


def test_lists_and_their_errors(root):
    assert "quickstart" in {row["name"] for row in list_pipelines()}
    with pytest.raises(UnknownNameError, match="nothing has been checked"):
        checks()
    with pytest.raises(
        UnknownNameError, match=r"quickstart\.up is declared but not computed; 'vines run quickstart up'"
    ):
        find_logs("quickstart.up")
    with pytest.raises(UnknownNameError, match="points"):
        vines.table("piont")


def test_a_study_of_ones_own(tmp_path, monkeypatch):
    init_study(tmp_path / "mine", "paper")
    assert (tmp_path / "mine" / "pipelines" / "quickstart.toml").is_file()
    assert (tmp_path / "mine" / "data" / ".gitignore").read_text().startswith("*")
    with pytest.raises(StoreError, match="exists already"):
        init_study(tmp_path / "mine")
    monkeypatch.chdir(tmp_path / "mine")
    monkeypatch.delenv("VINES_ROOT", raising=False)
    assert status("quickstart")[0].state == "never"


def test_start_outside_the_cavity():
    with pytest.raises(StateError, match=r"\|w\|"):
        vines.simulate(vines.Params(mu=0.01, A=0.02), x1=1.5)


def test_json_output_is_json(project):
    assert json.loads(project.vines("list", "--json").stdout)[0]["name"]
    assert json.loads(project.vines("status", "quickstart", "--json").stdout)["quickstart"]
    assert json.loads(project.vines("schema", "points", "--json").stdout)["table"] == "points"
    assert json.loads(project.vines("tables", "--json").stdout)


def test_a_study_declared_in_python_runs_and_shares_its_points_with_the_file(root):
    from vines.pipeline import Declaration, span

    (root / "pipelines" / "small.toml").write_text(SMALL)
    run("small")
    study = Declaration("mine", params={"mu": 0.01})
    study.stage("up", "sweep", vary={"A": span(0.015, 0.016, 5)}, settle=60, record=8)
    assert [(stage.state, stage.new) for stage in vines.run(study).stages] == [("computed", 0)]
    assert vines.query("select count(*) as n from mine.up").to_pylist() == [{"n": 5}]
