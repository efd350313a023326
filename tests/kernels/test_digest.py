"""The digest of a kernel: it changes with what the machine code depends on, and with nothing else."""

from __future__ import annotations

import importlib.util
import itertools
import sys
from pathlib import Path

import pytest

from vines.kernels._digest import digest_of

HELPER = """
from vines.kernels import njit, fused_njit, linked_njit

SHIFT = 1.0

@fused_njit
def inner(x):
    return 2.0 * x + SHIFT

@linked_njit
def called(x):
    return inner(x)
"""
KERNEL = """
import {helper} as other
from {helper} import called, inner
from vines.kernels import entry_njit

FACTOR = 3.0

@entry_njit
def kernel(x):
    '''Say what it does.'''
    return FACTOR * inner(x) + called(x) + other.SHIFT
"""
_NUMBERS = itertools.count()


def _digest(folder: Path, helper: str, kernel: str) -> str:
    """Return the digest of the kernel with these sources, from modules of their own but with names always alike."""
    names = {"helper_of_a_kernel": helper, "a_kernel": kernel.format(helper="helper_of_a_kernel")}
    place = folder / str(next(_NUMBERS))
    place.mkdir()
    made = None
    for name, text in names.items():
        path = place / f"{name}.py"
        path.write_text(text)
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None
        assert spec.loader is not None
        made = importlib.util.module_from_spec(spec)
        sys.modules[name] = made
        spec.loader.exec_module(made)
    return digest_of(made.kernel.py_func)


def test_comments_docstrings_and_lines_change_nothing(tmp_path: Path) -> None:
    before = _digest(tmp_path, HELPER, KERNEL)
    assert _digest(tmp_path, HELPER, "# A comment.\n\n\n" + KERNEL) == before
    assert _digest(tmp_path, HELPER, KERNEL.replace("Say what it does.", "Say it better.")) == before
    assert _digest(tmp_path, HELPER.replace("    return 2.0", "    # Twice.\n    return 2.0"), KERNEL) == before
    assert _digest(tmp_path, HELPER, KERNEL.replace("    '''Say what it does.'''\n", "")) == before


@pytest.mark.parametrize(
    ("place", "old", "new"),
    [
        ("kernel", "FACTOR * inner", "FACTOR + inner"),
        ("kernel", "FACTOR = 3.0", "FACTOR = 4.0"),
        ("helper", "2.0 * x", "2.5 * x"),
        ("helper", "SHIFT = 1.0", "SHIFT = 1.5"),
        ("helper", "@fused_njit", "@njit"),
    ],
)
def test_what_is_copied_into_the_kernel_changes_its_digest(tmp_path: Path, place: str, old: str, new: str) -> None:
    helper, kernel = (text.replace(old, new) if name == place else text for name, text in _both().items())
    assert (helper, kernel) != (HELPER, KERNEL)
    assert _digest(tmp_path, helper, kernel) != _digest(tmp_path, HELPER, KERNEL)


def _both() -> dict[str, str]:
    return {"helper": HELPER, "kernel": KERNEL}


def test_what_is_called_by_symbol_does_not(tmp_path: Path) -> None:
    changed = HELPER.replace("def called(x):\n    return inner(x)", "def called(x):\n    return inner(x) - 1.0")
    assert changed != HELPER
    assert _digest(tmp_path, changed, KERNEL) == _digest(tmp_path, HELPER, KERNEL)


BY_TYPE = """
from typing import NamedTuple
from vines.kernels import by_type, njit

class One(NamedTuple):
    x: float

class Other(NamedTuple):
    y: float

@by_type(One)
@njit
def inner(of):
    return 2.0 * of.x

@inner.register(Other)
@njit
def _inner(of):
    return 3.0 * of.y

called, SHIFT = inner, 1.0
"""


def test_bodies_by_type_belong_to_what_is_compiled_for_their_type(tmp_path: Path) -> None:
    # Which of them a kernel holds is kept beside its machine code: test_cache.
    before = _digest(tmp_path, BY_TYPE, KERNEL)
    assert _digest(tmp_path, BY_TYPE.replace("3.0 * of.y", "4.0 * of.y"), KERNEL) == before
