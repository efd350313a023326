"""What all tests share: compiled kernels from the project's cache, and one run of the quickstart to look at."""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import hypothesis
import pytest

from vines.places import cache_folder

REPOSITORY = Path(__file__).resolve().parent.parent

# Tests keep their results in temporary folders; the kernels they use are those that `make run` compiled.
os.environ.setdefault("NUMBA_CACHE_DIR", str(cache_folder()))
os.environ["RERUN_ANALYTICS"] = "0"
os.environ.pop("VINES_ROOT", None)
os.environ.pop("VINES_DATA", None)
# A shell starts what runs in the background with SIGINT ignored; the commands that tests interrupt would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

# No timed test in the suite: a busy machine must not fail a property.
# In CI the examples are the same each time; a developer's run goes on looking for new ones.
hypothesis.settings.register_profile("vines", deadline=None, derandomize=bool(os.environ.get("CI")))
hypothesis.settings.load_profile("vines")


class Project:
    """A project in a temporary folder and its command line."""

    def __init__(self, root: Path):
        self.root = root

    def vines(self, *arguments, check=True, timeout=300, **options):
        """Run the command line in a process of its own."""
        environment = {**os.environ, "VINES_ROOT": str(self.root), "COLUMNS": "160"}
        done = subprocess.run(
            [sys.executable, "-m", "vines.cli", *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=self.root,
            env=environment,
            timeout=timeout,
            check=False,
            **options,
        )
        if check:
            assert done.returncode == 0, done.stderr + done.stdout
        return done

    @property
    def data(self):
        """The folder of results."""
        return self.root / "data"


@pytest.fixture
def project(tmp_path):
    """Return a project of its own with the pipelines of vines."""
    shutil.copytree(REPOSITORY / "pipelines", tmp_path / "pipelines")
    return Project(tmp_path)


@pytest.fixture(scope="session")
def quickstart(tmp_path_factory):
    """Return a project in which the pipeline quickstart has been run once; not to be changed."""
    root = tmp_path_factory.mktemp("quick start")  # a path with a space in it
    shutil.copytree(REPOSITORY / "pipelines", root / "pipelines")
    project = Project(root)
    project.first = project.vines("run", "quickstart")
    return project


@pytest.fixture(scope="session")
def browser_program():
    """Skip, aloud, where there is no Chromium; never on a CI machine, which must have one."""
    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if program is None:
        if os.environ.get("CI"):
            pytest.fail("Chromium is missing on a CI machine; make system installs it")
        pytest.skip("Chromium is not installed, so no page is opened; make system installs it")
    return program
