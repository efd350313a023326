"""Compiled kernels: loaded where nothing changed, compiled again with what changed, never with another's code."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.made_once import own_copy

pytestmark = pytest.mark.long(30)

HELPER = """
from vines.kernels import fused_njit, linked_njit, new_vector

@fused_njit
def inner(x):
    return 2.0 * x

@linked_njit
def called(x):
    return inner(x) + 1.0
"""
KERNEL = """
from helper import called, inner
from vines.kernels import cold_njit, entry_njit

@cold_njit
def between(x):
    return called(x) * 10.0

@entry_njit
def kernel(x):
    return between(x) + inner(x)
"""
PROGRAM = """
from vines.kernels import expected
expected()
import kernel, helper
result = kernel.kernel(1.0)
made = [f.__name__ for f, d in ((kernel.kernel, kernel.kernel), (kernel.between, kernel.between.dispatcher),
        (helper.called, helper.called.dispatcher)) if sum(d.stats.cache_misses.values())]
print(result, sorted(made))
"""


def _run(folder: Path, helper: str, kernel: str = KERNEL, program: str = PROGRAM, **environment: str) -> str:
    (folder / "helper.py").write_text(helper)
    (folder / "kernel.py").write_text(kernel)
    paths = os.pathsep.join([str(folder), *sys.path])
    done = subprocess.run(
        [sys.executable, "-c", program],
        # Python takes a file for unchanged that was changed within its second and kept its length.
        env={
            **os.environ,
            "PYTHONPATH": paths,
            "PYTHONDONTWRITEBYTECODE": "1",
            "NUMBA_CACHE_DIR": str(folder / "cache"),
            **environment,
        },
        capture_output=True,
        text=True,
        check=True,
    )
    return (done.stdout + done.stderr).strip()


@pytest.fixture(scope="module")
def compiled_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder whose kernels are compiled; not to be changed."""
    folder = tmp_path_factory.mktemp("compiled")
    assert _run(folder, HELPER) == "32.0 ['between', 'called', 'kernel']"
    return folder


@pytest.fixture
def compiled(compiled_once: Path, tmp_path: Path) -> Path:
    """Return a folder of its own with the same sources and kernels, which may be changed."""
    return own_copy(compiled_once, tmp_path)


def test_only_what_changed_is_compiled_and_never_stale(compiled: Path) -> None:
    # In another folder than where they were compiled, too.
    assert _run(compiled, HELPER) == "32.0 []"
    assert _run(compiled, HELPER.replace("@linked_njit", "# Once.\n\n@linked_njit")) == "32.0 []"
    # The callee alone: its callers hold its name.
    assert _run(compiled, HELPER.replace("+ 1.0", "+ 2.0")) == "42.0 ['called']"
    # A helper that is copied: both that hold a copy.
    assert _run(compiled, HELPER.replace("2.0 * x", "3.0 * x")) == "43.0 ['called', 'kernel']"
    # Back again: it is still there.
    assert _run(compiled, HELPER) == "32.0 []"


BODIES = """
from typing import NamedTuple
from vines.kernels import by_type, fused_njit, linked_njit, njit

class One(NamedTuple):
    x: float

class Other(NamedTuple):
    y: float

@by_type(One)
@linked_njit
def across(of):
    return 0.0 * of.x

@across.register(Other)
@linked_njit
def _across(of):
    return 0.0 * of.y

@by_type(One)
@fused_njit
def inner(of):
    return 2.0 * of.x

@njit
def factor(y):
    return 3.0 * y

@inner.register(Other)
@njit
def _inner(of):
    return factor(of.y)

@njit
def copied(of):
    return inner(of) + 1.0

@linked_njit
def called(of):
    return copied(of) + across(of)
"""
CALLERS = """
from helper import One, Other, called
from vines.kernels import entry_njit

@entry_njit
def first(x):
    return called(One(x))

@entry_njit
def second(x):
    return called(Other(x)) + 10.0
"""
ASK = """
from vines.kernels import expected
expected()
import kernel, helper
results = kernel.first(1.0), kernel.second(1.0)
print(results, sum(helper.called.dispatcher.stats.cache_misses.values()),
      sum(kernel.first.stats.cache_misses.values()) + sum(kernel.second.stats.cache_misses.values()))
"""


def test_a_body_by_type_compiles_again_what_was_compiled_for_its_type(tmp_path: Path) -> None:
    def ask(helper: str) -> str:
        return _run(tmp_path, helper, CALLERS, ASK)

    assert ask(BODIES) == "(3.0, 14.0) 2 2"
    assert ask(BODIES) == "(3.0, 14.0) 0 0"
    # A body of the other type, and what is copied into it: nothing of the first is compiled.
    assert ask(BODIES.replace("return factor(of.y)", "return factor(of.y) + 1.0")) == "(3.0, 15.0) 1 0"
    assert ask(BODIES.replace("3.0 * y", "5.0 * y")) == "(3.0, 16.0) 1 0"
    assert ask(BODIES.replace("2.0 * of.x", "4.0 * of.x")) == "(5.0, 14.0) 2 0"
    # Back again: what was kept is that of the last body.
    assert ask(BODIES) == "(3.0, 14.0) 1 0"


def test_a_callee_whose_result_is_of_another_type_compiles_its_caller(compiled: Path) -> None:
    whole = HELPER.replace("return inner(x) + 1.0", "return 3 if inner(x) > 0.0 else 4")
    # The caller's own result is of the same type as before, so whoever calls that is left as it is.
    assert _run(compiled, whole) == "32.0 ['between', 'called']"


def test_who_waits_is_told_once_and_can_silence_it(tmp_path: Path) -> None:
    program = "import kernel; kernel.kernel(1.0); kernel.between(2.0)"
    told = _run(tmp_path, HELPER, program=program)
    assert told.count("\n") == 0
    assert "compiling kernels" in told
    assert _run(tmp_path, HELPER, program=program) == ""
    quiet = HELPER.replace("+ 1.0", "+ 5.0")
    assert _run(tmp_path, quiet, program=program, VINES_QUIET="1") == ""


def test_a_folder_that_cannot_be_written_does_no_harm(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("not a folder")
    assert _run(tmp_path, HELPER, NUMBA_CACHE_DIR=str(tmp_path / "file")).startswith("32.0")


def test_a_damaged_file_is_compiled_again(compiled: Path) -> None:
    for path in [*(compiled / "cache").rglob("*.nbc"), *(compiled / "cache").rglob("*.nbi")]:
        path.write_bytes(path.read_bytes()[:40])
    assert _run(compiled, HELPER) == "32.0 ['between', 'called', 'kernel']"
    assert _run(compiled, HELPER) == "32.0 []"


@pytest.mark.parametrize("first", ["vines.dynamics, numba", "numba, vines.dynamics"])
def test_wide_vectors_are_used_where_the_processor_has_them(first: str) -> None:
    program = f"import {first}; from vines.kernels import WIDE; print(WIDE, numba.config.CPU_FEATURES)"
    bare = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_CPU")}
    done = subprocess.run([sys.executable, "-c", program], env=bare, capture_output=True, text=True, check=True)
    wide, features = done.stdout.split(maxsplit=1)
    assert (wide == "True") == features.strip().endswith("-prefer-256-bit")


def test_what_another_process_compiles_meanwhile_is_taken_over(compiled: Path) -> None:
    """The second look into the cache, behind the lock, finds the kernel that the first look missed."""
    for path in (compiled / "cache" / "kernels" / "kernel").iterdir():
        path.unlink()
    program = """
from vines.kernels import _cache, expected
expected()
look = _cache.LazyCache.load_overload
seen = set()
def missing_at_first(self, sig, target_context):
    if id(self) not in seen:
        seen.add(id(self))
        return None
    return look(self, sig, target_context)
_cache.LazyCache.load_overload = missing_at_first
import kernel
print(kernel.kernel(1.0))
"""
    assert _run(compiled, HELPER, program=program) == "32.0"
