"""What all tests share: compiled kernels from the project's cache, and one run of the quickstart to look at."""

import os
import shutil
import signal
from pathlib import Path

import hypothesis
import pytest

from tests.made_once import made_once
from tests.project import REPOSITORY, Project
from vines.places import cache_folder

# Tests keep their results in temporary folders; the kernels they use are those that `make run` compiled.
os.environ.setdefault("NUMBA_CACHE_DIR", str(cache_folder()))
os.environ["RERUN_ANALYTICS"] = "0"
os.environ.pop("VINES_ROOT", None)
os.environ.pop("VINES_DATA", None)
# A shell starts what runs in the background with SIGINT ignored; the commands that tests interrupt would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

# A file is on the disk when a write returns, for the sake of power cuts. No test makes one, and all wait for the disk;
# that everything stored is synced is a test of the store.
os.fsync = lambda descriptor: None

# The suite writes and removes some thirty thousand small files, which a disk that discards blocks does at two
# milliseconds each. Where memory serves as a folder and has room, they lie there.
MEMORY = Path("/dev/shm")
if os.access(MEMORY, os.W_OK) and shutil.disk_usage(MEMORY).free > 4 << 30:
    os.environ.setdefault("PYTEST_DEBUG_TEMPROOT", str(MEMORY))

# Beside others a worker has one core: what a test computes in several processes it asks for (jobs=2), and commands that
# it starts see all cores.
if "PYTEST_XDIST_WORKER" in os.environ and hasattr(os, "sched_getaffinity"):
    os.sched_getaffinity = lambda process: {0}

# No timed test in the suite: a busy machine must not fail a property.
# In CI the examples are the same each time; a developer's run goes on looking for new ones.
hypothesis.settings.register_profile("vines", deadline=None, derandomize=bool(os.environ.get("CI")))
hypothesis.settings.load_profile("vines")


def pytest_collection_modifyitems(items):
    """Begin with the long files: a worker takes a file at a time, and none sits idle at the end."""

    def seconds(item):
        mark = item.get_closest_marker("long")
        return mark.args[0] if mark else 0

    items.sort(key=seconds, reverse=True)  # which leaves the others in their order


@pytest.fixture
def project(tmp_path):
    """Return a project of its own with the pipelines of vines."""
    shutil.copytree(REPOSITORY / "pipelines", tmp_path / "pipelines")
    return Project(tmp_path)


@pytest.fixture(scope="session")
def quickstart(tmp_path_factory):
    """Return a project in which a process has run the pipeline quickstart; shared, not to be changed."""

    def make(root):
        shutil.copytree(REPOSITORY / "pipelines", root / "pipelines")
        (root / "said.txt").write_text(Project(root).process("run", "quickstart").stdout, "utf-8")

    project = Project(made_once(tmp_path_factory, "quick start", make))

    def stored():
        return {path: path.stat().st_mtime_ns for path in project.data.glob("results/**/*")}

    before = stored()
    yield project
    assert stored() == before, "a test changed the shared quickstart; work on own_copy() of it"


@pytest.fixture(scope="session")
def browser_program():
    """Skip, aloud, where there is no Chromium; never on a CI machine, which must have one."""
    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if program is None:
        if os.environ.get("CI"):
            pytest.fail("Chromium is missing on a CI machine; make system installs it")
        pytest.skip("Chromium is not installed, so no page is opened; make system installs it")
    return program
