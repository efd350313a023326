"""A new study: it runs as its README says, and what editors look for is beside it."""

import json
import re

import pytest

from tests.project import REPOSITORY, Project


@pytest.fixture
def own(tmp_path):
    said = Project(tmp_path).vines("init", "own").stdout
    assert said == "own is ready; next:\n  cd own\n  vines run first\n"
    return Project(tmp_path / "own")


def test_the_starter_runs_and_its_query_answers(own):
    assert sorted(path.name for path in own.root.iterdir()) == ["README.md", "data", "pipelines", "schemas"]
    assert [path.name for path in (own.root / "pipelines").iterdir()] == ["first.toml"]
    done = own.vines("run", "first").stdout
    (sql,) = re.findall(r'^vines query "(.*)"$', (own.root / "README.md").read_text("utf-8"), re.MULTILINE)
    assert f'vines query "{sql}"' in done
    assert "vines view first.motion" in done
    rows = json.loads(own.vines("query", sql, "--format", "json").stdout)
    assert len(rows) == 47  # the sweep and the one motion
    assert {"1:1"} < {row["name"] for row in rows}


def test_the_schema_that_files_name_is_there_and_is_that_of_vines(own):
    first = own.root / "pipelines" / "first.toml"
    named = first.read_text("utf-8").splitlines()[0].removeprefix("#:schema ")
    assert (first.parent / named).read_text("utf-8") == own.vines("schema", "--declaration").stdout


@pytest.mark.parametrize(("start", "copied"), [("quickstart", ["quickstart.toml"]), ("paper", None)])
def test_other_beginnings(tmp_path, start, copied):
    assert "vines run quickstart" in Project(tmp_path).vines("init", "own", "--from", start).stdout
    there = sorted(path.name for path in (tmp_path / "own" / "pipelines").iterdir())
    assert there == (copied or sorted(path.name for path in (REPOSITORY / "pipelines").iterdir()))
    assert Project(tmp_path / "own").vines("status", "quickstart").stdout
    commands = re.findall(r"^vines (\S+) (\S+)", (tmp_path / "own" / "README.md").read_text("utf-8"), re.MULTILINE)
    assert {name for name, _ in commands} == {"run", "view", "query", "report"}
    assert {of.partition(".")[0] for name, of in commands if name != "query"} == {"quickstart"}


def test_nothing_is_overwritten(own, tmp_path):
    (own.root / "README.md").write_text("mine")
    done = Project(tmp_path).vines("init", "own", check=False)
    assert (done.returncode, "exists already; choose another folder" in done.stderr) == (2, True)
    assert (own.root / "README.md").read_text() == "mine"
