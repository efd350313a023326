"""The recipe for SLURM in docs/clusters.md, as it stands there, against a stand-in for sbatch.

The stand-in keeps the rules that the recipe relies on (man sbatch of SLURM 24.05): options in #SBATCH lines before the
first command; an array ``1-n%m``, its variables, at most m tasks at a time; ``afterok`` starts only if all tasks of the
job ended with 0, ``afterany`` when they have ended; a task with ``--requeue`` that is preempted starts again with the
same id, and its file of output is truncated unless ``--open-mode=append``; no shell option is inherited.
"""

import json
import os
import re
import stat
import subprocess
import sys

import pytest

from tests.project import REPOSITORY

pytestmark = pytest.mark.long(14)

DECLARED = """
[params]
mu = 0.01
[stages.up]
kind = "sweep"
vary.A = { from = 0.015, to = 0.017, count = 5 }
settle = 50
record = 16
refine = { on = ["kinetic_ratio"], tolerance = 0.0003, jump = 0.0001 }
"""

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


def recipe():
    """Return the two scripts of the page."""
    page = (REPOSITORY / "docs" / "clusters.md").read_text("utf-8").partition("## A job array")[2]
    return re.findall(r"```sh\n(#!/bin/bash\n.*?)```", page, flags=re.DOTALL)[:2]


@pytest.fixture
def queue(project):
    """Give the queue of a project with the scripts of the page, for a small pipeline and an array of two."""
    (project.root / "pipelines" / "fig5.toml").write_text(DECLARED)
    (project.root / ".venv" / "bin").mkdir(parents=True)
    program = project.root / ".venv" / "bin" / "vines"
    # warm-up compiles what these tests have compiled already
    program.write_text(f'#!/bin/sh\n[ "$1" = warm-up ] || exec {sys.executable} -m vines.cli "$@"\n')
    program.chmod(0o755)
    job, submit = recipe()
    (project.root / "fig5.sbatch").write_text(
        job.replace("1-16%8", "1-2%1").replace("cpus-per-task=8", "cpus-per-task=1")
    )
    (project.root / "submit.sh").write_text(submit)
    made = Queue(project)
    subprocess.run(["/bin/bash", "submit.sh"], cwd=project.root, env=made.environment, check=True)
    return made


def test_the_recipe_ends_with_the_result_of_one_run_though_a_share_fails_and_one_is_preempted(queue, tmp_path):
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
    pins = json.loads((queue.project.data / "pipelines" / "fig5.pins.json").read_text())
    table = (queue.project.data / "results" / pins["up"]["result"] / "points.parquet").read_bytes()
    (queue.project.data).rename(queue.project.root / "of the array")
    queue.project.vines("run", "fig5", "--quiet", "--jobs", "1")
    alone = json.loads((queue.project.data / "pipelines" / "fig5.pins.json").read_text())
    assert alone["up"]["result"] == pins["up"]["result"]
    assert (queue.project.data / "results" / alone["up"]["result"] / "points.parquet").read_bytes() == table
