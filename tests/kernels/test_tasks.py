"""Tasks and the kernels that they need: compiled beside each other, and only those that a run will ask for."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from vines.errors import KernelError
from vines.kernels import Task, compile_tasks
from vines.stages import load_pipeline, status

pytestmark = pytest.mark.long(9)

WORK = """
from typing import NamedTuple
from vines.kernels import by_type, entry_njit, linked_njit

class Number(NamedTuple):
    value: float

@by_type(Number)
@linked_njit
def part(of):
    return 0.5 * of.value

@entry_njit
def half(x):
    return part(Number(x))

def work():
    assert half(2.0) == 1.0
"""
PROGRAM = """
from vines.kernels import Task, compile_tasks, is_warm
task = Task("half", "halving", "work:work")
print(is_warm(task))
compile_tasks([task], lambda line: print(line.split(":")[0].strip()))
print(is_warm(task))
"""


def test_a_task_is_warm_until_one_of_its_kernels_changes(tmp_path: Path) -> None:
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path]),
        "PYTHONDONTWRITEBYTECODE": "1",  # else a file changed within its second may be taken for the old one
        "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
    }

    def run() -> list[str]:
        return subprocess.run(
            [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True
        ).stdout.split()

    path = tmp_path / "work.py"
    path.write_text(WORK)
    assert run() == ["False", "halving", "True"]
    path.write_text(WORK.replace("def half", "# A comment.\ndef half"))
    assert run()[0] == "True"
    path.write_text(WORK.replace("0.5 * of.value", "of.value * 0.5"))
    assert run() == ["False", "halving", "True"]
    # What was recorded by other sources, of a module that has been removed since, is compiled anew.
    (record,) = (tmp_path / "cache").rglob("tasks/half.json")
    record.write_text('[["removed", "half"]]')
    assert run() == ["False", "halving", "True"]


def test_a_task_that_fails_is_one_line() -> None:
    with pytest.raises(KernelError, match="kernels for 'nothing' could not be compiled: ModuleNotFoundError"):
        compile_tasks([Task("nothing", "nothing", "no_such_module:work")], print)


def test_the_quickstart_asks_for_no_lanes(quickstart, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VINES_ROOT", str(quickstart.root))
    monkeypatch.setenv("VINES_DATA", str(quickstart.root / "elsewhere"))
    assert load_pipeline("quickstart").name == "quickstart"
    needed = {name for plan in status("quickstart") for name in plan.kernels}
    assert needed == {"one_run", "runs", "orbits"}
