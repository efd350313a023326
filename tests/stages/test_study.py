"""Two studies in one process: each has its own pipelines and results, and none leaves a trace in the process."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from click.testing import CliRunner

import vines
from vines.cli._app import app
from vines.errors import FileMissingError, UnknownNameError
from vines.stages import diff, export, list_pipelines, verify


def declare(root: Path, name: str, m: float) -> vines.Study:
    (root / "pipelines").mkdir(parents=True)
    text = f'[stages.table_1]\nkind = "dimensionless"\nparams = {{ m = {m}, E = 0.000225, omega = 55.39 }}\n'
    (root / "pipelines" / f"{name}.toml").write_text(text, encoding="utf-8")
    return vines.study(root)


@pytest.fixture
def two(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[vines.Study, vines.Study]:
    monkeypatch.delenv("VINES_ROOT", raising=False)
    monkeypatch.delenv("VINES_DATA", raising=False)
    monkeypatch.chdir(tmp_path)
    return declare(tmp_path / "one", "same", 0.032), declare(tmp_path / "other", "same", 0.064)


def test_they_run_at_the_same_time_and_know_nothing_of_each_other(two, tmp_path: Path) -> None:
    before = dict(os.environ)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda each: each.run("same", jobs=1), two))
    masses = [each.table("same.table_1").column("mu").to_pylist() for each in two]
    assert masses == [[pytest.approx(mu, rel=1e-3)] for mu in (0.0084057, 0.0168115)]
    assert all(plan.state == "up_to_date" for each in two for plan in each.status("same"))
    heavy = "select mu > 0.01 as heavy from dimensionless"
    assert [each.query(heavy).to_pylist() for each in two] == [[{"heavy": False}], [{"heavy": True}]]
    assert os.environ == before
    assert not (tmp_path / "data").exists()
    assert verify(study=two[0]).good
    assert diff("same.table_1", "same.table_1", study=two[1]).same
    assert any(each.endswith("same.toml") for each in export(tmp_path / "out", study=two[1]))


def test_the_current_one_is_that_of_the_folder(two, monkeypatch: pytest.MonkeyPatch) -> None:
    two[0].run("same", jobs=1)
    monkeypatch.chdir(two[0].root)
    assert vines.table("same.table_1").num_rows == 1
    monkeypatch.chdir(two[1].root)
    with pytest.raises(UnknownNameError):
        vines.table("same.table_1")
    names = [row["name"] for row in list_pipelines(study=two[0])]
    assert "same" in names


def test_the_command_line_passes_it_on_and_sets_no_variable(two) -> None:
    before = dict(os.environ)
    two[1].run("same", jobs=1)
    said = CliRunner().invoke(app, ["--root", str(two[1].root), "query", "select mu from dimensionless"])
    assert said.exit_code == 0, said.output
    assert "0.0168" in said.output
    said = CliRunner().invoke(app, ["--root", str(two[0].root), "query", "select mu from dimensionless"])
    assert said.exit_code == 0
    assert "0.0168" not in said.output
    assert {k: v for k, v in os.environ.items() if k != "RERUN_ANALYTICS"} == {
        k: v for k, v in before.items() if k != "RERUN_ANALYTICS"
    }


def test_data_may_lie_elsewhere(two, tmp_path: Path) -> None:
    apart = vines.study(two[0].root, data=tmp_path / "results")
    apart.run("same", jobs=1)
    assert (tmp_path / "results" / "results").is_dir()
    assert not (two[0].root / "data").exists()


def test_a_folder_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(FileMissingError, match=r"there is no such folder; 'vines init"):
        vines.study(tmp_path / "nowhere")
