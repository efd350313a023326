"""An export: whole or not at all, the same bytes each time, and open to DuckDB, pandas and polars without vines."""

import csv
import errno
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import frictionless
import pytest
from datacite import schema45
from filelock import FileLock

from tests.made_once import own_copy
from tests.project import Project

OTHERS = """
import importlib.util, json, os, sys
assert importlib.util.find_spec("vines") is None
import duckdb, pandas, polars
folder = sys.argv[1]
connection = duckdb.connect()
quoted = folder.replace("'", "''")
connection.execute(f"SET file_search_path = '{quoted}'")
connection.execute(open(os.path.join(folder, "load.sql")).read())
one = lambda sql: connection.sql(sql).fetchall()
table = os.path.join(folder, "tables", "quickstart.up.points.parquet")
frame = pandas.read_parquet(table)
lazy = polars.scan_parquet(table).filter(polars.col("A").is_between(0.02, 0.0201)).collect()
orbits = polars.read_parquet(os.path.join(folder, "tables", "quickstart.symmetric.orbits.parquet"))
print(json.dumps({
    "counts": one("select pipeline, stage, count(*) from points group by all order by stage"),
    "stage": one('select count(*), min(A) from "quickstart.up"'),
    "unquoted": one("select count(*) from quickstart.up"),
    "other": one('select count(*) from "quickstart.up.impacts"'),
    "lists": one("select word, len(t) from orbits where t[1] >= 0 limit 1"),
    "empty": one("select count(*) from basins"),
    "logs": one("select path, len(sha256) from logs order by path"),
    "pandas": [len(frame), float(frame["A"].min()), frame["name"].iloc[0]],
    "polars": [lazy.height, orbits.schema["multipliers_re"] == polars.List(polars.Float64)],
}))
"""


@pytest.fixture(scope="session")
def exported(quickstart, tmp_path_factory):
    """Give an export of the quickstart with its logs, in a folder whose name needs quoting."""
    folder = tmp_path_factory.mktemp("it's here") / "results"
    told = quickstart.vines("export", folder, "quickstart", "--logs", "--json").stdout
    return folder, json.loads(told)


def without_vines(tmp_path, *arguments):
    """Run Python in another folder, with the packages of this environment but vines."""
    packages = tmp_path / "packages"
    packages.mkdir()
    for path in Path(sysconfig.get_path("purelib")).iterdir():
        if "vines" not in path.name and path.suffix not in (".pth", ".egg-link"):
            (packages / path.name).symlink_to(path)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    done = subprocess.run(
        [sys.executable, "-S", *arguments],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**environment, "PYTHONPATH": str(packages)},
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_others_open_it_in_another_folder_without_vines(exported, tmp_path):
    folder, _ = exported
    found = json.loads(without_vines(tmp_path, "-c", OTHERS, str(folder)))
    assert ["quickstart", "up", 181] in found["counts"]
    assert found["stage"] == [[181, 0.015]]
    assert found["unquoted"] == [[181]]
    assert found["other"][0][0] > 181
    assert found["lists"] == [["LR", 2]]
    assert found["empty"] == [[0]]
    assert next(path.split("/")[:2] for path, _ in found["logs"]) == ["logs", "quickstart.asymmetric_run"]
    assert found["pandas"] == [181, 0.015, "1:1"]
    assert found["polars"] == [3, True]


def test_checksums_and_dictionary_cover_everything(exported):
    folder, told = exported
    lines = (folder / "SHA256SUMS").read_text().splitlines()
    summed = dict(reversed(line.split("  ", 1)) for line in lines)
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert set(summed) == there - {"SHA256SUMS"} == set(told["files"]) - {"SHA256SUMS"}
    assert all(hashlib.sha256((folder / name).read_bytes()).hexdigest() == sha for name, sha in summed.items())
    rows = list(csv.DictReader((folder / "dictionary.csv").read_text().splitlines()))
    units = {(row["table"], row["column"]): row["unit"] for row in rows}
    assert units["points", "phase"] == "rad"
    package = json.loads((folder / "datapackage.json").read_text())
    for resource in package["resources"]:
        assert summed[resource["path"]] == resource["hash"].removeprefix("sha256:")
        assert all((resource["path"].split(".")[-2], field["name"]) in units for field in resource["schema"]["fields"])
    regime = next(r for r in rows if (r["table"], r["column"]) == ("points", "regime"))
    assert "chaotic" in regime["allowed"]
    assert (folder / "LICENSE").read_text().strip()
    assert "cff-version" in (folder / "CITATION.cff").read_text()
    assert (folder / "declarations" / "quickstart.toml").is_file()


def test_the_bytes_do_not_depend_on_when_and_where(exported, quickstart, tmp_path):
    folder, _ = exported
    quickstart.vines("export", tmp_path / "again", "quickstart", "--logs")
    assert (tmp_path / "again" / "SHA256SUMS").read_text() == (folder / "SHA256SUMS").read_text()
    text = "".join(path.read_text() for path in folder.rglob("*.json")) + (folder / "load.sql").read_text()
    assert str(quickstart.root) not in text
    assert '"host"' not in text


def test_it_is_written_as_a_whole_or_not_at_all(quickstart, tmp_path):
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("mine")
    for folder, words in ((tmp_path / "full", "not an empty folder"), (tmp_path / "no" / "such", "does not exist")):
        done = quickstart.vines("export", folder, check=False)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert words in done.stderr
    done = quickstart.vines("export", tmp_path / "new", "--licence", tmp_path / "none", check=False)
    assert "becomes LICENSE" in done.stderr
    done = quickstart.vines("export", tmp_path / "new", "quikstart", check=False)
    assert "did you mean 'quickstart'" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["full"]
    (tmp_path / "empty").mkdir()
    told = quickstart.vines("export", tmp_path / "empty").stdout
    assert "begin with" in told
    assert "no [study] is declared" in told
    assert not (tmp_path / "empty" / "logs").exists()
    assert "not part of this export" in (tmp_path / "empty" / "README.md").read_text()


def test_two_exports_to_one_place_and_what_a_killed_one_left(quickstart, tmp_path):
    target = tmp_path / "out"
    left = tmp_path / ".out.export.lock.0123456789ab"
    (left / "tables").mkdir(parents=True)
    (tmp_path / ".out.export.lock").touch()
    with FileLock(tmp_path / ".out.export.lock"):
        done = quickstart.vines("export", target, "quickstart", check=False)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert f"another export is writing {target}" in done.stderr
    assert left.exists()
    quickstart.vines("export", target, "quickstart")
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_full_disk_leaves_nothing_and_is_told_with_the_place(quickstart, tmp_path, monkeypatch):
    def full(source, target):
        Path(target).write_bytes(b"half")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(source))  # as shutil tells it: of the source

    monkeypatch.setattr(shutil, "copyfile", full)
    done = quickstart.vines("export", tmp_path / "out", "quickstart", check=False)
    assert done.returncode == 2
    assert done.stderr == f"vines: {tmp_path / 'out'} cannot be written: No space left on device; " + (
        "nothing of the export is there\n"
    )
    assert not [*tmp_path.iterdir()]


def test_the_place_may_be_a_link_and_not_the_store(quickstart, tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to("real")
    quickstart.vines("export", tmp_path / "link", "quickstart")
    assert (tmp_path / "real" / "SHA256SUMS").is_file()
    done = quickstart.vines("export", quickstart.data / "results" / "mine", "quickstart", check=False)
    assert done.returncode == 2
    assert "name another folder" in done.stderr


def test_what_is_declared_otherwise_now_is_said(quickstart, tmp_path):
    project = Project(own_copy(quickstart.root, tmp_path / "project"))
    assert project.vines("export", tmp_path / "same", "quickstart").stderr == ""
    assert "Not as declared" not in (tmp_path / "same" / "README.md").read_text()
    declared = project.root / "pipelines" / "quickstart.toml"
    declared.write_text(declared.read_text().replace("settle = 400", "settle = 401", 1))
    said = project.vines("export", tmp_path / "other", "quickstart").stderr
    assert "is stale: settle 400 → 401" in said
    assert "the export holds what is stored" in said
    readme = (tmp_path / "other" / "README.md").read_text()
    assert "is stale: settle 400 → 401" in readme.partition("## Not as declared")[2]


STUDY = """
[study]
title = "What a ball takes: settled impacts"
creators = [{ name = "Doe, Alex", orcid = "0000-0002-1825-0097", affiliation = "A laboratory" }, { name = "A group" }]
keywords = ["vibro-impact", "nonlinear energy sink"]
description = "A sweep of the forcing amplitude."
version = "1.2.0"
licence = "CC-BY-4.0"
publisher = "A repository"
year = 2026
doi = "10.1234/example"
related = [{ doi = "10.1234/paper", relation = "IsSupplementTo" }]
"""
SMALL = """
title = "Small"
[params]
mu = 0.01
[stages.up]
kind = "sweep"
vary.A = [0.015, 0.016]
settle = 50
record = 16
"""


@pytest.fixture(scope="module")
def deposit(tmp_path_factory):
    """Give an export of a small pipeline that says who made it."""
    project = Project(tmp_path_factory.mktemp("deposit"))
    (project.root / "pipelines").mkdir()
    (project.root / "pipelines" / "small.toml").write_text(SMALL)
    project.vines("run", "small", "--jobs", "1")
    before = {path.name for path in (project.data / "results").iterdir()}
    (project.root / "pipelines" / "small.toml").write_text(STUDY + SMALL.replace('title = "Small"\n', ""))
    assert "nothing to compute" in project.vines("run", "small").stdout  # who made it counts in no key
    assert {path.name for path in (project.data / "results").iterdir()} == before
    project.vines("export", project.root / "out", "small")
    return project, project.root / "out"


def test_the_data_package_is_one_to_frictionless(deposit):
    _, folder = deposit
    descriptor = json.loads((folder / "datapackage.json").read_text("utf-8"))
    package = frictionless.Package.from_descriptor(descriptor, basepath=str(folder))
    assert list(frictionless.Package.metadata_validate(descriptor)) == []
    assert (package.title, package.version) == ("What a ball takes: settled impacts", "1.2.0")
    assert package.licenses == [{"name": "CC-BY-4.0", "path": "https://creativecommons.org/licenses/by/4.0/"}]
    assert [each["title"] for each in package.contributors] == ["Alex Doe", "A group"]
    assert package.keywords == ["vibro-impact", "nonlinear energy sink"]
    tables = ("attractors", "impacts", "points")
    assert {resource.name for resource in package.resources} == {f"small.up.{name}" for name in tables}


def test_the_fields_of_datacite_are_valid(deposit):
    _, folder = deposit
    told = json.loads((folder / "datacite.json").read_text("utf-8"))
    assert schema45.validate(told)
    assert told["creators"][0]["nameIdentifiers"][0]["nameIdentifier"] == "https://orcid.org/0000-0002-1825-0097"
    assert told["rightsList"][0]["rightsIdentifier"] == "CC-BY-4.0"
    assert told["relatedIdentifiers"][0]["relationType"] == "IsSupplementTo"


def test_the_licence_is_that_of_the_data_and_the_citation_names_the_creators(deposit):
    _, folder = deposit
    assert "Creative Commons Attribution 4.0" in (folder / "LICENSE").read_text("utf-8")
    assert "BSD" not in (folder / "LICENSE").read_text("utf-8")
    cited = (folder / "CITATION.cff").read_text("utf-8")
    assert '  - family-names: "Doe"\n    given-names: "Alex"' in cited
    assert "type: dataset" in cited
    readme = (folder / "README.md").read_text("utf-8")
    assert "datacite.json" in readme
    assert readme.startswith("# What a ball takes: settled impacts\n\nDoe, Alex; A group. Version 1.2.0.\n")
    assert "Creative Commons Attribution 4.0" in readme


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ('licence = "BSD-3-Clause"', "which is none for data; allowed: CC-BY-4.0"),
        ('creators = [{ name = "Doe, A.", orcid = "0000-0002-1825-0098" }]', r"orcid is .*check digit"),
        ("creators = []", "creators"),
        ("keyword = ['a']", "unknown key 'keyword': did you mean 'keywords'"),
        ("year = 26", "year is 26, allowed is year >= 1990"),
        ('doi = "https://doi.org/10.1/a"', "doi is"),
    ],
)
def test_what_a_repository_would_refuse_is_one_line(deposit, wrong, told):
    project, _ = deposit
    key = wrong.split()[0]
    kept = "".join(line + "\n" for line in STUDY.splitlines() if not line.startswith(f"{key} ="))
    (project.root / "pipelines" / "wrong.toml").write_text(kept + wrong + SMALL.replace('title = "Small"\n', ""))
    done = project.vines("status", "wrong", check=False)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert re.search(told, done.stderr), done.stderr
