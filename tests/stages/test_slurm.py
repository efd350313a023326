"""The recipe for SLURM in docs/clusters.md, as it stands there, against a stand-in for sbatch.

The stand-in keeps the rules that the recipe relies on (man sbatch of SLURM 24.05): options in #SBATCH lines before the
first command; an array ``1-n%m``, its variables, at most m tasks at a time; ``afterok`` starts only if all tasks of the
job ended with 0, ``afterany`` when they have ended; a task with ``--requeue`` that is preempted starts again with the
same id, and its file of output is truncated unless ``--open-mode=append``; no shell option is inherited.
"""

import json
import os
import re
import shutil
import stat
import subprocess
import sys

import pytest

from tests.stages.recipe import assert_as_one_run, write_recipe

pytestmark = [
    pytest.mark.long(14),
    pytest.mark.skipif(
        shutil.which("slurmctld") is not None and os.geteuid() == 0,
        reason="SLURM is installed, and test_slurm_node runs the recipe on the real one",
    ),
]

SBATCH = r'''#!PYTHON
"""Queue a job and print its number; the test runs the queue."""
import json, os, re, sys
from pathlib import Path
queue = Path(os.environ["QUEUE"])
words, script, wrap = sys.argv[1:], None, None
options = {}
while words:
    word = words.pop(0)
    if word == "--wrap":
        wrap = words.pop(0)
    elif word.startswith("--"):
        name, _, value = word[2:].partition("=")
        options[name] = value
    else:
        script = word
if script is not None:
    for line in Path(script).read_text().splitlines():
        if line and not line.startswith("#"):
            break
        found = re.fullmatch(r"#SBATCH --([a-z-]+)(?:=(\S+))?", line)
        if line.startswith("#SBATCH"):
            assert found, line
            options.setdefault(found[1], found[2] or "")
assert options.pop("parsable", None) == "" and (script is None) != (wrap is None)
number = len(list(queue.glob("*.json"))) + 1
text = Path(script).read_text() if script else "#!/bin/sh\n" + wrap + "\n"
(queue / f"{number}.json").write_text(json.dumps({"options": options, "text": text}))
print(number)
'''


class Queue:
    """The stand-in, and the jobs that it was given."""

    def __init__(self, project):
        self.project = project
        self.folder = project.root / "queue"
        self.folder.mkdir()
        self.codes = {}
        program = self.folder / "sbatch"
        program.write_text(SBATCH.replace("PYTHON", sys.executable))
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        self.environment = {**os.environ, "QUEUE": str(self.folder), "PATH": f"{self.folder}:{os.environ['PATH']}"}

    def jobs(self):
        return sorted(int(path.stem) for path in self.folder.glob("*.json"))

    def job(self, number):
        return json.loads((self.folder / f"{number}.json").read_text())

    def run(self, preempt=()):
        """Run what may start, in the order of submission; tasks in `preempt` are ended once by SIGTERM."""
        for number in self.jobs():
            job = self.job(number)
            options = job["options"]
            how, _, before = options.get("dependency", ":").partition(":")
            if how == "afterok" and any(code for code in self.codes[int(before)]):
                continue  # DependencyNeverSatisfied
            last, most = 1, 1
            if "array" in options:
                found = re.fullmatch(r"1-(\d+)%(\d+)", options["array"])
                assert found, options["array"]
                last, most = map(int, found.groups())
            assert most >= 1
            self.codes[number] = [
                self.task(number, job, i, last, preempted=(number, i) in preempt) for i in range(1, last + 1)
            ]

    def task(self, number, job, i, count, *, preempted):
        options = job["options"]
        script = self.folder / f"{number}.sh"
        script.write_text(job["text"])
        variables = {
            "SLURM_SUBMIT_DIR": str(self.project.root),
            "SLURM_CPUS_PER_TASK": options.get("cpus-per-task", "1"),
        }
        if count > 1:
            variables |= {"SLURM_ARRAY_TASK_ID": str(i), "SLURM_ARRAY_TASK_COUNT": str(count)}
        environment = {**os.environ, **self.project.environment, **variables}
        code = -1
        for start in range(2 if preempted else 1):
            assert start == 0 or "requeue" in options
            mode = "a" if options.get("open-mode") == "append" else "w"
            with (self.folder / f"slurm-{number}_{i}.out").open(mode) as out:
                process = subprocess.Popen(
                    ["/bin/bash", script], cwd=self.project.root, env=environment, stdout=out, stderr=out
                )
                if preempted and start == 0:
                    process.terminate()
                code = process.wait(timeout=280)
        return code

    def said(self, number, i=1):
        return (self.folder / f"slurm-{number}_{i}.out").read_text()


@pytest.fixture
def queue(project):
    """Give the queue of a project with the scripts of the page, for a small pipeline and an array of two."""
    write_recipe(project)
    made = Queue(project)
    subprocess.run(["/bin/bash", "submit.sh"], cwd=project.root, env=made.environment, check=True)
    return made


def test_the_recipe_ends_with_the_result_of_one_run_though_a_share_fails_and_one_is_preempted(queue):
    assert queue.jobs() == [1, 2, 3, 4, 5, 6, 7]
    first = queue.job(2)
    for option in ("array", "mem", "time", "requeue", "signal", "open-mode"):
        assert option in first["options"], option
    (queue.folder / "2.json").write_text(  # its second task fails, whatever it is
        json.dumps({**first, "text": '[ "$SLURM_ARRAY_TASK_ID" = 2 ] && exit 1\n' + first["text"]})
    )
    queue.run(preempt={(4, 1)})
    assert queue.codes[2] == [0, 1]
    assert queue.codes[3] == [3], queue.said(3)
    assert "points are missing; run the shards again" in queue.said(3)
    assert queue.codes[4] == [0, 0], queue.said(4)
    assert queue.codes[7] == [0], queue.said(7)
    assert_as_one_run(queue.project)
