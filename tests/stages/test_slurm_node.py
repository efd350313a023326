"""The recipe for SLURM in docs/clusters.md on a real SLURM of one node: munged, slurmctld and slurmd of Debian.

What test_slurm.py assumes of SLURM, this one shows where the programs are.
"""

import os
import shutil
import socket
import subprocess
import tempfile
import time
from pathlib import Path

import pytest

from tests.stages.recipe import assert_as_one_run, write_recipe

pytestmark = pytest.mark.long(90)

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scancel", "scontrol", "squeue")
CONFIGURATION = """\
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmdParameters=config_overrides
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=1,sched_min_interval=0,bf_interval=1
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=20000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""
TROUBLES = """
[ "$SLURM_ARRAY_TASK_ID" = 2 ] && [ ! -e failed ] && touch failed && exit 1
[ "$SLURM_ARRAY_TASK_ID" = 1 ] && [ ! -e preempted ] && echo "waits, restart ${SLURM_RESTART_COUNT:-0}" &&
    echo "$SLURM_ARRAY_JOB_ID" > preempted && sleep 600
echo "goes on, restart ${SLURM_RESTART_COUNT:-0}"
"""
"""What the array does first: its second task fails in the first round, and its first waits until it is preempted."""


class Node:
    """A SLURM of one node, all of it below a folder."""

    def __init__(self, folder):
        self.folder = folder
        self.environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf")}
        self.daemons = []

    def begin(self):
        """Start munged, slurmctld and slurmd, and wait until the node takes jobs."""
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        with socket.socket() as one, socket.socket() as two:
            for each in (one, two):
                each.bind(("127.0.0.1", 0))
            ports = [each.getsockname()[1] for each in (one, two)]
        text = CONFIGURATION.format(host=os.uname().nodename.partition(".")[0], ports=ports, folder=self.folder)
        (self.folder / "slurm.conf").write_text(text)
        (self.folder / "munge.key").write_bytes(os.urandom(1024))
        (self.folder / "munge.key").chmod(0o400)
        places = {"key-file": "munge.key", "socket": "munge.socket", "pid-file": "munged.pid"}
        places |= {"log-file": "munged.log", "seed-file": "munge.seed"}
        self.daemon("munged", "--foreground", "--force", *(f"--{k}={self.folder / v}" for k, v in places.items()))
        self.wait_for(lambda: (self.folder / "munge.socket").exists())
        self.daemon("slurmctld", "-D")
        self.wait_for(lambda: "is UP" in self.ask("scontrol", "ping"))
        self.daemon("slurmd", "-D")
        self.wait_for(lambda: "State=IDLE" in self.ask("scontrol", "show", "node"))

    def daemon(self, *command):
        with (self.folder / f"{command[0]}.out").open("w") as sink:
            self.daemons.append(subprocess.Popen(command, env=self.environment, stdout=sink, stderr=sink))

    def ask(self, *command, **options):
        said = subprocess.run(
            command, env=self.environment, check=False, capture_output=True, text=True, timeout=60, **options
        )
        return said.stdout

    def jobs(self):
        """Return number and state of the jobs that are not over."""
        return self.ask("squeue", "--noheader", "--format=%i %T %r").splitlines()

    def wait_for(self, condition, seconds=600):
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, "\n".join(
                path.read_text(errors="replace")[-2000:] for path in self.folder.glob("*.out")
            )
            time.sleep(0.1)

    def close(self):
        if len(self.daemons) == 3:
            self.ask("scancel", "--user=root")
            end = time.monotonic() + 20
            while self.jobs() and time.monotonic() < end:
                time.sleep(0.1)
        for process in reversed(self.daemons):
            process.terminate()
            process.wait()


@pytest.fixture
def node():
    """Give a node of SLURM; skip, aloud, where its programs are missing, which a CI machine must have."""
    missing = [name for name in PROGRAMS if shutil.which(name) is None]
    if missing and os.environ.get("CI"):
        pytest.fail(f"{missing[0]} is missing on a CI machine; make system installs it")
    if missing:
        pytest.skip(f"{missing[0]} is not installed, so no job is submitted; make system installs it")
    if os.geteuid() != 0:
        pytest.skip("slurmd starts jobs as their users, which only a superuser may")
    with tempfile.TemporaryDirectory(prefix="slurm") as folder:  # a path of pytest is too long for a socket
        made = Node(Path(folder))
        try:
            made.begin()
            yield made
        finally:
            made.close()


def test_the_recipe_on_a_real_slurm_though_a_share_fails_and_one_is_preempted(node, project):
    write_recipe(project, before=TROUBLES)
    subprocess.run(["/bin/bash", "submit.sh"], cwd=project.root, env=node.environment, check=True)
    strict = node.ask("sbatch", "--parsable", "--dependency=afterok:2", "--wrap", "touch never", cwd=project.root)
    node.wait_for((project.root / "preempted").exists)
    number = (project.root / "preempted").read_text().strip()
    node.wait_for(lambda: f"{number}_1 RUNNING" in "\n".join(node.jobs()))
    node.ask("scontrol", "requeue", f"{number}_1")
    node.wait_for(lambda: f"{number}_1 PENDING BeginTime" in node.jobs())
    node.ask("scontrol", "update", f"JobId={number}_1", "StartTime=now")  # SLURM would wait for two minutes
    node.wait_for(lambda: node.jobs() == [f"{strict.strip()} PENDING DependencyNeverSatisfied"])
    assert not (project.root / "never").exists()
    said = {path.stem: path.read_text() for path in project.root.glob("slurm-*.out")}
    array = [name for name in sorted(said) if name.endswith("_1") and "waits, restart 0" in said[name]]
    assert len(array) == 1, said
    assert "goes on, restart 1" in said[array[0]]
    assert sum("points are missing; run the shards again" in text for text in said.values()) == 1, said
    assert_as_one_run(project)
