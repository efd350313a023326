"""Computing needs nothing but what a node has; whatever needs more says so in one line and what to install."""

import ast
import importlib
import inspect
import json
import os
import re
import subprocess
import sys
from importlib.metadata import packages_distributions
from importlib.util import find_spec
from pathlib import Path

import pytest
from packaging.utils import canonicalize_name

from vines.errors import PackageMissingError, VinesError
from vines.packages import OPTIONAL, need

REPOSITORY = Path(__file__).resolve().parent.parent
SOURCES = sorted((REPOSITORY / "vines").rglob("*.py"))
ROOMS_WITH_A_DOOR = {"vines.figures": "matplotlib", "vines.viewer": "rerun"}

pytestmark = pytest.mark.long(12)

PIPELINE = """
title = "What a node computes, and what it can neither draw nor ask"
params = { mu = 0.01, Omega = 1.0, r = 0.65 }
[stages.run]
kind = "trajectory"
params.A = 0.015
[stages.up]
kind = "sweep"
vary.A = { from = 0.015, to = 0.016, count = 3 }
settle = 50
record = 8
[stages.symmetric]
kind = "branch"
word = "LR"
vary.A = { from = 0.015, to = 0.016 }
[stages.figure]
kind = "figure"
plot = "bifurcation"
needs = ["up", "symmetric"]
[stages.checks]
kind = "check"
claims = ["fig2_a"]
needs = ["run"]
"""

COMMANDS = {
    "run node": ["duckdb", "matplotlib"],
    "status node --json": [],
    "list": [],
    "graph node": [],
    "verify": [],
    "report node": [],
    "export out": [],
    "gc": [],
    "schema points": [],
    "solve LR --mu 0.01 --A 0.015": [],
    "rig init demo": [],
    "rig inspect run.csv": [],
    "rig synth demo_synth": ["npTDMS"],
    "run node --engine dask": ["distributed"],
    "tables": ["duckdb"],
    "query select(1)": ["duckdb"],
    "check node": ["duckdb"],
    "diff node.up node.up": ["duckdb"],
    "view node.run": ["rerun-sdk"],
    "view node.run --save run.rrd": ["rerun-sdk"],
    "browse": ["rerun-sdk"],
}
"""Commands, and the packages that each misses on a node."""

BLOCK = """
import sys
from importlib.machinery import PathFinder


class Finder(PathFinder):
    @classmethod
    def find_spec(cls, fullname, path=None, target=None):
        return None if fullname.partition(".")[0] in {absent} else super().find_spec(fullname, path, target)


sys.meta_path[sys.meta_path.index(PathFinder)] = Finder
"""
"""How a process starts that finds no package which a node lacks."""

SCRIPT = """
import contextlib, io, json, sys
from vines.cli import main
told = []
for command in json.loads(sys.argv[1]):
    sys.argv = ["vines", *command.split()]
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main()
        except SystemExit as end:
            code = end.code
        except BaseException as error:
            code = repr(error)
    told.append((command, code, out.getvalue(), err.getvalue()))
print(json.dumps(told))
"""


def locked_for_a_node():
    lines = (REPOSITORY / "requirements-node.lock").read_text().splitlines()
    return {line.partition("==")[0] for line in lines if re.match(r"[a-z]", line)}


def absent_from_a_node():
    """Return the names that could be imported here but not on a node."""
    there = locked_for_a_node() | {"vines", "pip", "setuptools"}
    return sorted(
        name
        for name, packages in packages_distributions().items()
        if not {canonicalize_name(package) for package in packages} & there and name != "sitecustomize"
    )


@pytest.fixture
def node(project, tmp_path):
    """Return the environment of a process that can import what a node can, and its children too."""
    (tmp_path / "pipelines" / "node.toml").write_text(PIPELINE)
    (tmp_path / "run.csv").write_text("# sampling_rate: 10\na [V]\n1\n2\n")
    blocked = tmp_path / "blocked"
    blocked.mkdir()
    (blocked / "sitecustomize.py").write_text(BLOCK.replace("{absent}", repr(set(absent_from_a_node()))))
    return {**os.environ, "PYTHONPATH": str(blocked), "VINES_ROOT": str(tmp_path), "COLUMNS": "160"}


def test_a_node_computes_and_each_command_says_what_it_misses(node, tmp_path):
    assert {"rerun", "matplotlib", "duckdb", "pandas"} <= set(absent_from_a_node())
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, json.dumps(list(COMMANDS))],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=node,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    for command, code, out, err in json.loads(done.stdout.splitlines()[-1]):
        missed = COMMANDS[command]
        assert code == (3 if command == "run node" else 2 if missed else 0), (command, code, out, err)
        assert "Traceback" not in out + err
        lines = [line for line in err.splitlines() if "not installed" in line]
        assert [line.startswith("vines: ") for line in lines[-1:]] == [True] * bool(missed), (command, err)
        for package in missed:
            assert f"needs {package}, which is not installed; in the folder of vines: pip install " in lines[-1]
        if command.startswith("status"):
            states = {stage["name"]: (stage["state"], stage["failed"]) for stage in json.loads(out)["node"]}
            computed = dict.fromkeys(["run", "up", "symmetric"], ("up_to_date", 0))
            assert states == {**computed, **dict.fromkeys(["figure", "checks"], ("never", 0))}


@pytest.mark.parametrize("module", OPTIONAL)
def test_the_message_names_need_package_and_remedy(module, monkeypatch):
    if find_spec(module) is not None:  # drivers of devices and servers of other viewers are not among what is tested
        need(module)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(PackageMissingError, match=r"needs .*, which is not installed; .*pip install ") as caught:
        need(module)
    assert isinstance(caught.value, VinesError)
    assert isinstance(caught.value, ModuleNotFoundError)
    assert caught.value.name == module
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("room", "module"), ROOMS_WITH_A_DOOR.items())
def test_the_door_of_a_room_tells_what_it_misses(room, module, monkeypatch):
    opened = importlib.import_module(room)
    functions = [name for name in opened.__all__ if inspect.isfunction(getattr(opened, name))]
    assert functions
    monkeypatch.setitem(sys.modules, module, None)
    for name in functions:
        monkeypatch.delitem(vars(opened), name)  # as in a process that has not asked for it yet
        with pytest.raises(PackageMissingError):
            getattr(opened, name)


def imports(node):
    """Yield what a statement imports, by the first part of its name; asking a table for a data frame imports pandas."""
    if isinstance(node, ast.Import):
        yield from (alias.name.partition(".")[0] for alias in node.names)
    elif isinstance(node, ast.ImportFrom) and node.level == 0:
        yield (node.module or "").partition(".")[0]
    elif isinstance(node, ast.Attribute) and node.attr == "to_pandas":
        yield "pandas"


def needed(node):
    """Return what a function asks for by :func:`need`."""
    calls = (each for each in ast.walk(node) if isinstance(each, ast.Call) and isinstance(each.func, ast.Name))
    return {each.args[0].value for each in calls if each.func.id == "need" and isinstance(each.args[0], ast.Constant)}


def lacking(tree):
    """Yield line and package of each import that a node cannot do and nothing asked for before."""
    known = {name.replace("-", "_") for name in locked_for_a_node()} | {"vines", "google"} | sys.stdlib_module_names
    typing_only = {
        inner
        for each in ast.walk(tree)
        if isinstance(each, ast.If) and isinstance(each.test, ast.Name) and each.test.id == "TYPE_CHECKING"
        for inner in ast.walk(each)
    }
    asked = {}
    for scope in (each for each in ast.walk(tree) if isinstance(each, ast.FunctionDef | ast.ClassDef)):
        own = needed(scope)
        for inner in ast.walk(scope) if own else ():
            asked.setdefault(inner, set()).update(own)
    for each in ast.walk(tree):
        if each not in typing_only:
            for package in imports(each):
                if package not in known | asked.get(each, set()):
                    yield each.lineno, package


def test_nothing_imports_what_a_node_lacks_without_asking_for_it():
    found = []
    for file in SOURCES:
        room = ".".join(file.relative_to(REPOSITORY).parts[:2])
        for line, package in lacking(ast.parse(file.read_text())):
            if ROOMS_WITH_A_DOOR.get(room) != package:
                found.append(f"{file.relative_to(REPOSITORY)}:{line} imports {package}")
    assert not found


@pytest.mark.parametrize(
    ("code", "package"),
    [
        ("import pandas", "pandas"),
        ("def f():\n    import matplotlib.figure", "matplotlib"),
        ("def f(t):\n    return t.to_pandas()", "pandas"),
        ("def f():\n    need('duckdb')\n    from h5py import File", "h5py"),
    ],
)
def test_an_import_without_asking_is_found(code, package):
    assert [found for _, found in lacking(ast.parse(code))] == [package]
