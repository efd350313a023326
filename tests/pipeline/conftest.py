"""The laboratory of the tests, a project with the toy kinds."""

import importlib
import sys
from collections import Counter

import pytest

from tests.pipeline.lab import Lab
from vines.pipeline import KINDS


@pytest.fixture(autouse=True)
def known_kinds(monkeypatch):
    """Forget afterwards the kinds that a test registers: others list what there is."""
    monkeypatch.setattr(KINDS, "_things", dict(KINDS._things))


@pytest.fixture
def lab(tmp_path, monkeypatch):
    """Give a laboratory whose package can be imported, and forget it afterwards."""
    made = Lab(tmp_path)
    monkeypatch.syspath_prepend(str(made.package.parent))
    made.register()
    # processes that a test stops in the middle take their time; what it computes here to compare needs none
    monkeypatch.setattr(importlib.import_module("toylab.bodies"), "pause", lambda seconds: None)
    yield made
    for name in [name for name in sys.modules if name.partition(".")[0] == "toylab"]:
        del sys.modules[name]


@pytest.fixture
def tally(tmp_path):
    """Give a file to count computed points in, and a function that reads the counts."""
    path = tmp_path / "tally.txt"

    def read() -> Counter:
        counts = Counter(path.read_text().split() if path.exists() else [])
        path.unlink(missing_ok=True)
        return counts

    return path, read
