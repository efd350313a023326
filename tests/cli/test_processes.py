"""Each command in a process of its own: it imports what it needs, prints what a call here prints, and ends.

Other tests call the command line in the process of the tests, where everything is imported already. The commands of
``vines rig`` are called as processes in test_rig.py and in tests/stages/test_rehearsal.py.
"""

import pytest

from tests.made_once import own_copy
from tests.project import Project
from vines.cli._app import COMMANDS

# name: (arguments, exit code); LOG is a log of the quickstart, OUT and RRD paths that are not there

pytestmark = pytest.mark.long(18)

READING = {
    "list": (["list"], 0),
    "kinds": (["kinds"], 0),
    "plots": (["plots"], 0),
    "status": (["status", "quickstart"], 0),
    "run": (["run", "quickstart"], 0),
    "graph": (["graph", "quickstart"], 0),
    "tables": (["tables"], 0),
    "schema": (["schema", "points"], 0),
    "query": (["query", "select A, name from points where stage = 'up' order by A limit 3"], 0),
    "verify": (["verify", "quickstart", "--recompute", "2"], 0),
    "check": (["check", "quickstart"], 1),
    "solve": (["solve", "LR", "--mu", "0.01", "--A", "0.02"], 0),
    "view": (["view", "LOG", "--web", "--png", "OUT"], 2),
    "recover": (["recover", "LOG"], 2),
    "diff": (["diff", "quickstart.up", "quickstart.up"], 0),
    "gc": (["gc"], 0),
}
WORKING = {
    "init": (["init", "OUT"], 0),
    "merge": (["merge", "quickstart"], 0),
    "report": (["report", "quickstart", "--out", "OUT"], 0),
    "export": (["export", "OUT", "quickstart"], 0),
    "view --save": (["view", "LOG", "--save", "RRD"], 0),
    "rig": (["rig", "--help"], 0),  # begins with how it was called
    "warm-up": (["warm-up"], 0),
}
ELSEWHERE = {
    "browse",
    "figure",
}  # the one serves until Ctrl-C, that it says what is wrong is tested below; test_drawing


def filled_in(arguments, project, tmp_path):
    """Put paths in the place of LOG, OUT and RRD."""
    paths = {"LOG": sorted(project.data.rglob("*.mcap"))[0], "OUT": tmp_path / "out", "RRD": tmp_path / "out.rrd"}
    return [paths.get(each, each) for each in arguments]


def test_every_command_is_here():
    assert {name.split()[0] for name in (*READING, *WORKING)} | ELSEWHERE == set(COMMANDS)


@pytest.mark.parametrize("name", READING)
def test_a_process_says_what_a_call_says(quickstart, tmp_path, name):
    arguments, code = READING[name]
    arguments = filled_in(arguments, quickstart, tmp_path)
    process = quickstart.process(*arguments, check=False)
    assert process.returncode == code, process.stderr
    assert process == quickstart.vines(*arguments, check=False)


@pytest.mark.parametrize("name", WORKING)
def test_a_process_does_its_work(quickstart, tmp_path, name):
    arguments, code = WORKING[name]
    project = Project(own_copy(quickstart.root, tmp_path / "project"))
    process = project.process(*filled_in(arguments, project, tmp_path), check=False)
    assert (process.returncode, process.stderr) == (code, "")
    assert (tmp_path / "out").exists() == ("OUT" in arguments)
    assert (tmp_path / "out.rrd").exists() == ("RRD" in arguments)


def test_an_error_is_one_line_of_a_process_too(project):
    said = project.process("browse", check=False)
    assert (said.returncode, said.stdout, said.stderr.count("\n")) == (2, "", 1)
