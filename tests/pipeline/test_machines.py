"""Several processes and machines: kills at random moments, Ctrl-C, shares, a dask cluster. All with real processes."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from vines.errors import EngineError, RunFailed
from vines.pipeline import load, plan
from vines.pipeline._dask import Dask
from vines.store import Store

pytestmark = pytest.mark.long(50)

SCRIPT = Path(__file__).with_name("script_of_the_lab.py")
SWEEP = """
    [stages.up]
    kind = "toy"
    wait = 0.01
    vary.mu = [0.1, 0.2, 0.3, 0.4]
    vary.A = { from = 0.1, to = 0.5, count = 25 }
    [stages.total]
    kind = "total"
    needs = ["up"]
"""
CARRIED = SWEEP.replace("[stages.total]", 'carry = "A"\n    [stages.total]')


def start(lab, **options):
    command = [sys.executable, str(SCRIPT), str(lab.folder), json.dumps(options)]
    return subprocess.Popen(
        command, cwd=lab.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )


def end(process, code=0):
    out, err = process.communicate(timeout=120)
    assert process.returncode == code, err
    return json.loads(out) if code == 0 else err


def parts(lab):
    return len(list(lab.store.pools.glob("*/0*")))


def staged(lab):
    folder = lab.store.staging_folder
    return {path.name for path in folder.iterdir()} if folder.is_dir() else set()


def wait_for(condition, process=None, seconds=60):
    limit = time.monotonic() + seconds
    while not condition() and time.monotonic() < limit and (process is None or process.poll() is None):
        time.sleep(0.005)
    assert condition(), process.communicate() if process is not None and process.poll() is not None else "too slow"


def everything(lab):
    return {stage: lab.bytes_of(stage) for stage in ("up", "total")}


@pytest.fixture
def undisturbed(lab):
    """Return a function that gives the bytes of a run that nobody disturbs."""

    def compute(path):
        kept, lab.store = lab.store, Store(lab.folder / "undisturbed")
        lab.run(path, jobs=1)
        found, lab.store = everything(lab), kept
        return found

    return compute


def test_killed_at_six_random_moments_the_run_ends_with_the_same_bytes(lab, undisturbed):
    declared = lab.declare(CARRIED.replace("count = 25", "count = 61"))
    moments = random.Random(5)
    kills, done = 0, []
    for _ in range(6):
        before, there, more = staged(lab), parts(lab), moments.randrange(4)
        process = start(lab, jobs=1, target=0.06)
        # not before it began to compute, else all kills might all hit the start of Python
        wait_for(lambda before=before: staged(lab) - before, process)
        wait_for(lambda least=there + more: parts(lab) >= least, process)
        time.sleep(moments.uniform(0.0, 0.06))
        process.send_signal(signal.SIGKILL)
        process.communicate()
        kills += process.returncode == -signal.SIGKILL
        done.append(parts(lab))
    assert kills == 6, "the run ended before it was killed six times"
    assert done == sorted(done)
    state = plan(load(declared, root=lab.folder), lab.store)[0]
    assert 0 < state.done < state.wanted
    lab.run(declared, jobs=1)
    assert everything(lab) == undisturbed(declared)
    # the empty lock of a process that was killed between its lock and its folder may stay for a while
    assert not any(path.is_dir() for path in lab.store.staging_folder.iterdir())


@pytest.mark.parametrize("jobs", [1, 2])
def test_ctrl_c_does_not_wait_for_a_point_that_takes_ten_minutes(lab, jobs):
    lab.declare('[stages.up]\nkind = "toy"\nwait = 600.0\nvary.A = [0.1, 0.2, 0.3]\n')
    process = start(lab, jobs=jobs, worth=0.0 if jobs > 1 else 1e9)
    wait_for(lambda: len(staged(lab)) >= jobs, process)
    os.killpg(process.pid, signal.SIGINT)
    # `end` waits for two minutes
    assert end(process, code=130) == "vines: stopped; what is finished is kept, the same command goes on\n"
    assert parts(lab) == 0


@pytest.mark.parametrize("delay", [0.0, 0.4])
def test_ctrl_c_says_one_line_while_workers_start_too(lab, delay):
    lab.declare('[stages.up]\nkind = "toy"\nwait = 600.0\nvary.A = [0.1, 0.2, 0.3]\n')
    process = start(lab, jobs=2, worth=0.0)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    # the first is Python's own, which counts what processes share
    wait_for(lambda: len(children.read_text().split()) >= 2, process)
    time.sleep(delay)
    os.killpg(process.pid, signal.SIGINT)
    assert end(process, code=130) == "vines: stopped; what is finished is kept, the same command goes on\n"


@pytest.mark.parametrize("jobs", [1, 2])
def test_ctrl_c_stops_a_run_that_goes_on_later(lab, undisturbed, jobs):
    declared = lab.declare(SWEEP.replace("wait = 0.01", "wait = 0.03"))
    process = start(lab, jobs=jobs, worth=0.1, target=0.5)
    wait_for(lambda: parts(lab) > 3, process)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does, to workers as well
    said = end(process, code=130)
    assert said == "vines: stopped; what is finished is kept, the same command goes on\n"
    before = plan(load(declared, root=lab.folder), lab.store)[0]
    assert 0 < before.done < 100
    assert lab.run(declared, jobs=1).stages[0].new == 100 - before.done
    assert everything(lab) == undisturbed(declared)


@pytest.mark.parametrize(("form", "count"), [(SWEEP, 4), (CARRIED, 2)])
def test_shards_as_processes_and_a_merge(lab, undisturbed, form, count):
    declared = lab.declare(form)
    shards = [start(lab, jobs=1, shard=f"{i}/{count}") for i in range(1, count + 1)]
    assert [end(shard)["up"][2] for shard in shards] == [100 // count] * count
    assert not lab.store.pins("toys")
    summary = lab.run(declared, merge=True)
    assert [(each.name, each.state) for each in summary.stages] == [("up", "computed"), ("total", "computed")]
    assert summary.stages[0].new == 0
    assert everything(lab) == undisturbed(declared)


def test_a_merge_says_what_is_missing(lab):
    from vines.pipeline import Shard

    declared = lab.declare(SWEEP.replace("wait = 0.01", "wait = 0.0"))
    lab.run(declared, jobs=1, shard=Shard(1, 4))
    summary = lab.run(declared, merge=True)
    assert [each.state for each in summary.stages] == ["failed", "skipped"]
    with pytest.raises(RunFailed, match=r"75 of 100 points are missing; run the shards again, or 'vines run toys'"):
        summary.check()
    assert lab.run(declared, jobs=1).stages[0].new == 75


def test_shards_wait_for_the_start_that_another_computes(lab):
    from vines.pipeline import Shard

    declared = lab.declare(
        """
        [stages.up]
        kind = "toy"
        vary.A = [0.1, 0.2, 0.3, 0.4]
        [stages.on]
        kind = "toy"
        vary.A = [0.2, 0.3]
        carry = { axis = "A", start = { from = "up", at = { A = 0.4 } } }
        """
    )
    first = lab.run(declared, jobs=1, shard=Shard(1, 2))
    assert [(each.name, each.state) for each in first.stages] == [("up", "computed"), ("on", "skipped")]
    lab.run(declared, jobs=1, shard=Shard(2, 2))
    lab.run(declared, jobs=1, shard=Shard(1, 2))
    assert all(each.state == "computed" for each in lab.run(declared, merge=True).stages)


class Cluster:
    """A dask scheduler and workers, each a process of its own."""

    def __init__(self, folder, code):
        self.folder = folder
        self.environment = {**os.environ, "PYTHONPATH": str(code), "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "5"}
        self.processes = []
        self.file = folder / "scheduler.json"

    def begin(self, workers):
        """Start a scheduler, and workers as soon as it has written where it is."""
        self.scheduler = self.spawn(
            "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", self.file
        )
        wait_for(self.written, self.scheduler)
        self.address = json.loads(self.file.read_text())["address"]
        self.workers = [self.worker() for _ in range(workers)]

    def wait_for(self, workers):
        """Wait until so many workers have come."""
        from distributed import Client

        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=60)

    def written(self):
        """Say whether the file of the scheduler is there as a whole."""
        try:
            return "address" in json.loads(self.file.read_text())
        except (FileNotFoundError, json.JSONDecodeError):
            return False

    def spawn(self, what, *arguments, before=()):
        command = [*before, sys.executable, "-m", f"distributed.cli.dask_{what}", *map(str, arguments)]
        sink = (self.folder / f"{what}-{len(self.processes)}.log").open("w")
        with sink:
            process = subprocess.Popen(
                command, cwd=self.folder, env=self.environment, stdout=sink, stderr=subprocess.STDOUT
            )
        self.processes.append(process)
        return process

    def worker(self, before=()):
        options = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1")
        return self.spawn("worker", self.address, *options, before=before)

    def close(self):
        for process in self.processes:
            process.kill()
            process.wait()


@pytest.fixture
def cluster(lab):
    """Give a real cluster that is yet to begin; it ends with the test."""
    made = Cluster(lab.folder, lab.package.parent)
    yield made
    made.close()


def test_a_dask_worker_that_is_killed_loses_nothing(lab, cluster, undisturbed):
    declared = lab.declare(SWEEP)
    cluster.begin(workers=2)
    process = start(lab, engine="dask", scheduler=cluster.address, target=0.1)
    wait_for(lambda: parts(lab) > 2, process)
    cluster.workers[0].kill()
    assert end(process)["up"] == ["computed", 100, 100, 0]
    assert everything(lab) == undisturbed(declared)


def test_a_lost_scheduler_is_one_line_and_the_same_command_goes_on(lab, cluster, undisturbed):
    declared = lab.declare(SWEEP)
    cluster.begin(workers=1)
    process = start(lab, engine="dask", scheduler=cluster.address, target=0.1)
    wait_for(lambda: parts(lab) > 2, process)
    cluster.scheduler.kill()
    said = end(process, code=3)
    assert said.startswith(f"vines: the dask scheduler {cluster.address} is gone; what was computed is kept; the same")
    assert said.count("\n") == 1
    done = plan(load(declared, root=lab.folder), lab.store)[0].done
    assert 0 < done < 100
    lab.run(declared, jobs=1)
    assert everything(lab) == undisturbed(declared)


def test_dask_makes_a_cluster_of_its_own(lab, undisturbed, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(lab.package.parent))
    declared = lab.declare(SWEEP)
    process = start(lab, engine="dask", jobs=2, target=0.1)
    assert end(process)["up"] == ["computed", 100, 100, 0]
    assert everything(lab) == undisturbed(declared)


def test_nobody_at_the_address_is_one_line():
    import vines.pipeline._dask as module

    crew = Dask("tcp://127.0.0.1:9", 1)
    seconds, module._CONNECT_SECONDS = module._CONNECT_SECONDS, 0.3
    try:
        with pytest.raises(EngineError, match=r"no dask scheduler answers at tcp://127\.0\.0\.1:9: .*; start it"):
            crew.executor()
    finally:
        module._CONNECT_SECONDS = seconds
