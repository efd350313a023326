"""A run that was killed goes on with the same command and ends with the same bytes as an undisturbed one."""

import hashlib
import signal
import time

import pytest

pytestmark = pytest.mark.long(16)

MOMENTS = ("points/*/0*", "results/*/manifest.json", "pipelines/*.pins.json")
"""Files whose first appearance is the moment to kill: a part of a pool, a first result, a first pin."""


def contents(project):
    """Return the digest of every stored file but the manifests, which hold the clock, and of the pins."""
    return {
        str(path.relative_to(project.data)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(project.data.glob("results/**/*"))
        if path.is_file() and path.name != "manifest.json"
    }


@pytest.mark.parametrize(("moment", "wait"), [*((m, 0.0) for m in MOMENTS), (MOMENTS[1], 0.4)])
def test_killed_and_run_again(project, quickstart, moment, wait):
    running = project.start("run", "quickstart", "--quiet")
    try:
        end = time.monotonic() + 120
        while not any(project.data.glob(moment)) and time.monotonic() < end and running.poll() is None:
            time.sleep(0.002)
        time.sleep(wait)
    finally:
        running.send_signal(signal.SIGKILL)
        running.wait()
    assert running.returncode == -signal.SIGKILL, "the run ended before it could be killed"
    assert contents(project) != contents(quickstart)
    project.vines("run", "quickstart", "--jobs", "1")
    assert contents(project) == contents(quickstart)
    assert not [path for path in project.data.glob("staging/*") if path.is_dir()]
