"""Faults in every file that the store writes: each command names them or mends them, and none is ever wrong."""

import json
import random
import shutil

import pytest

from tests.project import Project

pytestmark = pytest.mark.long(18)

DECLARED = """
[params]
mu = 0.01
[stages.up]
kind = "sweep"
vary.A = [0.015]
settle = SETTLE
record = 16
[stages.run]
kind = "trajectory"
vary.A = [0.0155]
settle = 20
record = 4
"""
SQL = "select pipeline, stage, A, kinetic_ratio, name from points where pipeline = 'small' order by stage, A"
OTHER = "select A, kinetic_ratio, name from other.up order by A"


def delete(path, twin):
    path.unlink()


def truncate(path, twin):
    path.write_bytes(path.read_bytes()[: random.Random(path.name).choice((0, path.stat().st_size // 2))])


def flip(path, twin):
    data = bytearray(path.read_bytes())
    place = random.Random(path.name).randrange(len(data))
    data[place] ^= 1 << random.Random(len(data)).randrange(7)
    path.write_bytes(bytes(data))


def replace(path, twin):
    path.write_bytes(twin.read_bytes())


FAULTS = (delete, truncate, flip, replace)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Return a project with two pipelines that were run."""
    made = Project(tmp_path_factory.mktemp("whole"))
    (made.root / "pipelines").mkdir()
    for name, settle in (("small", 50), ("other", 60)):
        (made.root / "pipelines" / f"{name}.toml").write_text(DECLARED.replace("SETTLE", str(settle)))
        made.vines("run", name, "--quiet", "--jobs", "1")
    return made


def files_of(project):
    """Return what the store wrote for the pipeline small, each with a file of the same kind that is another's."""
    mine, others = (json.loads((project.data / "pipelines" / f"{n}.pins.json").read_text()) for n in ("small", "other"))
    found = {"pipelines/small.pins.json": "pipelines/other.pins.json"}
    for stage, pin in mine.items():
        for folder, key in (("results", "result"), ("points", "pool")):
            here = project.data / folder / pin[key]
            there = sorted(path for path in (project.data / folder / others[stage][key]).rglob("*") if path.is_file())
            for path in sorted(here.rglob("*")):
                twins = [each for each in there if each.suffix == path.suffix and each.name != path.name] or there
                same = [each for each in there if each.name == path.name] or twins
                if path.is_file():
                    found[str(path.relative_to(project.data))] = str(same[-1].relative_to(project.data))
        found[f"cache/whole/{pin['result']}.json"] = f"cache/whole/{others[stage]['result']}.json"
    found["cache/code.json"] = next(each for each in found if each.startswith("cache/whole/"))
    return found


def contents(project, name="small"):
    pins = json.loads((project.data / "pipelines" / f"{name}.pins.json").read_text())
    return {
        (stage, str(path.relative_to(project.data / "results" / pin["result"]))): path.read_bytes()
        for stage, pin in pins.items()
        for path in sorted((project.data / "results" / pin["result"]).rglob("*"))
        if path.is_file() and path.name != "manifest.json"
    }


def named(said):
    """Whether a command that could not do all it should said so in lines, without a traceback."""
    return said.returncode in (1, 2, 3) and "vines: " in said.stderr and "Traceback" not in said.stderr


def test_every_file_of_the_store_has_a_fault(whole, tmp_path):
    """Each file one of the faults, each fault some of the files; the full tests give every file every fault."""
    inject(whole, tmp_path, lambda number: FAULTS[number % len(FAULTS)])


@pytest.mark.full
@pytest.mark.parametrize("fault", FAULTS, ids=lambda each: each.__name__)
def test_every_file_of_the_store_has_every_fault(whole, tmp_path, fault):
    inject(whole, tmp_path, lambda number: fault)


def inject(whole, tmp_path, fault_of):
    right, answers = (
        contents(whole),
        {sql: whole.vines("query", sql, "--format", "json").stdout for sql in (SQL, OTHER)},
    )
    table = []
    for number, (name, twin) in enumerate(files_of(whole).items()):
        fault = fault_of(number)
        project = Project(tmp_path / f"{number}")
        shutil.copytree(whole.root, project.root)
        before = (project.data / name).read_bytes()
        fault(project.data / name, project.data / twin)
        if not (project.data / name).exists() or (project.data / name).read_bytes() != before:
            table.append(f"{fault.__name__} {name}: {outcome(project, name, right, answers)}")
        shutil.rmtree(project.root)
    print("\n".join(table))


def outcome(project, name, right, answers):
    """See what each command does, and return it in words."""
    said = {}
    status = project.vines("status", "small")
    said["status"] = "up to date" if all("up to date" in line for line in status.stdout.splitlines()[1:]) else "named"
    query = project.vines("query", SQL, "--format", "json", check=False)
    forgotten = not (project.data / "pipelines" / "small.pins.json").exists()  # as who removes it wants
    wanted = "[]\n" if forgotten else answers[SQL]
    assert query.stdout == wanted if query.returncode == 0 else named(query), (name, query)
    said["query"] = "right" if query.returncode == 0 else "named"
    assert project.vines("query", OTHER, "--format", "json").stdout == answers[OTHER], name
    verify = project.vines("verify", "small", check=False)
    stored = name.partition("/")[0] in ("results", "points") and not name.endswith("pool.json")
    assert verify.returncode == 1 if stored else verify.returncode in (0, 1, 2), (name, verify)
    assert "Traceback" not in verify.stderr
    said["verify"] = "named" if verify.returncode else "whole"
    gc = project.vines("gc", "--json", check=False)
    if gc.returncode:
        assert named(gc), (name, gc)
    else:
        removable = {each["key"] for each in json.loads(gc.stdout)["found"] if each["what"] == "points"}
        assert not removable, name
    export = project.vines("export", str(project.root / "exported"), "small", check=False)
    if export.returncode:
        assert named(export), (name, export)
    else:
        for (stage, file), data in right.items():
            copy = project.root / "exported" / "tables" / f"small.{stage}.{file}"
            assert not file.endswith(".parquet") or copy.read_bytes() == data, name
    said["export"] = "named" if export.returncode else "right"
    run = project.vines("run", "small", "--jobs", "1")
    assert contents(project) == right, name
    said["run"] = "nothing to do" if "nothing to compute" in run.stdout else "mended"
    assert project.vines("query", SQL, "--format", "json").stdout == answers[SQL], name
    if project.vines("verify", "small", check=False).returncode:  # a part that no result needs now
        project.vines("run", "small", "--force", "--quiet", "--jobs", "1")
        assert contents(project) == right, name
        assert project.vines("verify", "small").returncode == 0, name
    assert "nothing to compute" in project.vines("run", "small").stdout
    return ", ".join(f"{command} {what}" for command, what in said.items())
