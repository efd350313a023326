"""Faults in every file that the store writes: each command names them or mends them, and none is ever wrong.

``python -m benchmarks.faults`` writes what each command does to docs/damage.md.
"""

import json
import random
import re
import shutil
from pathlib import Path

import pytest

from tests.project import Project

pytestmark = [pytest.mark.long(14), pytest.mark.usefixtures("coarse_look")]

DECLARED = """
[params]
mu = 0.01
[stages.up]
kind = "sweep"
vary.A = [0.015, 0.016]
settle = SETTLE
record = 16
[stages.run]
kind = "trajectory"
vary.A = [0.0155]
settle = SETTLE
record = 4
[stages.picture]
kind = "figure"
plot = "bifurcation"
panels = ["x1"]
width = 3.0
needs = ["up"]
"""
SQL = "select pipeline, stage, A, kinetic_ratio, name from points where pipeline = 'small' order by stage, A"
OTHER = "select A, kinetic_ratio, name from other.up order by A"


def delete(path, twin):
    path.unlink()


def truncate(path, twin):
    path.write_bytes(path.read_bytes()[: random.Random(path.name).choice((0, path.stat().st_size // 2))])


def flip(path, twin):
    data = bytearray(path.read_bytes() or b"\0")  # the lock is empty
    place = random.Random(path.name).randrange(len(data))
    data[place] ^= 1 << random.Random(len(data)).randrange(7)
    path.write_bytes(bytes(data))


def replace(path, twin):
    path.write_bytes(twin.read_bytes())


def misshape(path, twin):
    path.write_text("{}")


def loop(path, twin):
    path.unlink()
    path.symlink_to(path.name)


FAULTS = (delete, truncate, flip, replace)
MORE = (misshape, loop)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Return a project with two pipelines that were run."""
    return run_two(tmp_path_factory.mktemp("whole"))


def run_two(folder):
    """Return a project in a folder with two pipelines that were run."""
    made = Project(folder)
    (made.root / "pipelines").mkdir(parents=True)
    for name, settle in (("small", 50), ("other", 60)):
        (made.root / "pipelines" / f"{name}.toml").write_text(DECLARED.replace("SETTLE", str(settle)))
        made.vines("run", name, "--quiet", "--jobs", "1")
    return made


def files_of(project):
    """Return what was written below data/ for the pipeline small, each with a file of the same kind of another's."""
    mine, others = (json.loads((project.data / "pipelines" / f"{n}.pins.json").read_text()) for n in ("small", "other"))
    found = {"pipelines/small.pins.json": "pipelines/other.pins.json"}
    for stage, pin in mine.items():
        for folder, key in (("results", "result"), ("points", "pool")):
            if key not in pin:
                continue
            here = project.data / folder / pin[key]
            there = sorted(path for path in (project.data / folder / others[stage][key]).rglob("*") if path.is_file())
            for path in sorted(here.rglob("*")):
                twins = [each for each in there if each.suffix == path.suffix and each.name != path.name] or there
                same = [each for each in there if each.name == path.name] or twins
                if path.is_file():
                    found[str(path.relative_to(project.data))] = str(same[-1].relative_to(project.data))
        found[f"cache/whole/{pin['result']}.json"] = f"cache/whole/{others[stage]['result']}.json"
    found["cache/code.json"] = next(each for each in found if each.startswith("cache/whole/"))
    logs = {
        name: str(next(project.data.glob(f"logs/*-{name}-*")).relative_to(project.data)) for name in ("small", "other")
    }
    found[logs["small"]] = found["store.lock"] = logs["other"]
    there = {str(path.relative_to(project.data)) for path in project.data.rglob("*") if path.is_file()}
    there = {name for name in there if not name.startswith("figures/")}  # copies, which test_drawing hurts
    assert there == {*found, *found.values(), *(name for name in there if any(key in name for key in keys_of(others)))}
    return found


def keys_of(pins):
    return [pin[key] for pin in pins.values() for key in ("result", "pool") if key in pin]


def plain(project, name):
    """Return the name of a file with the stage in the place of a key."""
    pins = json.loads((project.data / "pipelines" / "small.pins.json").read_text())
    for stage, pin in pins.items():
        for key in ("result", "pool"):
            name = name.replace(pin.get(key, stage), stage)
    for pattern, word in ((r"[0-9a-f]{20}\.mcap", "<point>.mcap"), (r"\d{8}-[0-9a-f]{12}", "<part>")):
        name = re.sub(pattern, word, name)
    return re.sub(r"\d{8}T\d{6}-small-\d+", "<time>-small-<process>", name)


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


def test_every_kind_of_file_of_the_store_has_a_fault(whole, tmp_path):
    """Each kind of file one of the faults, each fault some of them; the full tests give every file every fault."""
    inject(whole, tmp_path, lambda number: FAULTS[number % len(FAULTS)], one_of_each_kind(files_of(whole)))


def one_of_each_kind(files):
    """Return the first of the files that lie in one place and have one name, whatever their stage."""
    first = {}
    for name, twin in files.items():
        place, _, file = name.rpartition("/")
        kind = Path(file).suffix if re.match("picture|[0-9a-f]{12}|[0-9]{8}T", file) else file
        first.setdefault((place.partition("/")[0], kind), (name, twin))
    return dict(first.values())


@pytest.mark.full
@pytest.mark.parametrize("fault", [*FAULTS, *MORE], ids=lambda each: each.__name__)
def test_every_file_of_the_store_has_every_fault(whole, tmp_path, fault):
    inject(whole, tmp_path, lambda number: fault, files_of(whole))


def inject(whole, tmp_path, fault_of, files):
    """Hurt each of the files, see what each command does, and return that: fault, file, and a word for each command."""
    right, answers = (
        contents(whole),
        {sql: whole.vines("query", sql, "--format", "json").stdout for sql in (SQL, OTHER)},
    )
    table = []
    for number, (name, twin) in enumerate(files.items()):
        fault = fault_of(number)
        project = Project(tmp_path / f"{number}")
        shutil.copytree(whole.root, project.root)
        before = (project.data / name).read_bytes()
        fault(project.data / name, project.data / twin)
        if not (project.data / name).is_file() or (project.data / name).read_bytes() != before:
            table.append((fault.__name__, plain(whole, name), outcome(project, name, right, answers)))
        shutil.rmtree(project.root)
    return table


def outcome(project, name, right, answers):
    """See what each command does, and return a word for it."""
    said = {}
    status = project.vines("status", "small")
    said["status"] = "up to date" if all("up to date" in line for line in status.stdout.splitlines()[1:]) else "named"
    query = project.vines("query", SQL, "--format", "json", check=False)
    pins = project.data / "pipelines" / "small.pins.json"
    forgotten = not (pins.exists() or pins.is_symlink())  # as who removes it wants
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
    said["gc"] = "named" if gc.returncode else "keeps points"
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
    return said
