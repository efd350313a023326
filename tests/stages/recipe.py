"""The recipe for SLURM of docs/clusters.md, written into a project for a small pipeline and an array of two."""

import json
import re
import sys

from tests.project import REPOSITORY

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


def recipe():
    """Return the two scripts of the page."""
    page = (REPOSITORY / "docs" / "clusters.md").read_text("utf-8").partition("## A job array")[2]
    return re.findall(r"```sh\n(#!/bin/bash\n.*?)```", page, flags=re.DOTALL)[:2]


def write_recipe(project, before=""):
    """Write the pipeline, the two scripts, and the vines that they call.

    Parameters
    ----------
    before : str
        What the script of the array does first.
    """
    (project.root / "pipelines" / "fig5.toml").write_text(DECLARED)
    (project.root / ".venv" / "bin").mkdir(parents=True)
    program = project.root / ".venv" / "bin" / "vines"
    # warm-up compiles what these tests have compiled already
    program.write_text(f'#!/bin/sh\n[ "$1" = warm-up ] || exec {sys.executable} -m vines.cli "$@"\n')
    program.chmod(0o755)
    job, submit = recipe()
    smaller = job.replace("1-16%8", "1-2%1").replace("cpus-per-task=8", "cpus-per-task=1")
    (project.root / "fig5.sbatch").write_text(smaller.replace("cd ", before + "cd ", 1))
    (project.root / "submit.sh").write_text(submit)


def assert_as_one_run(project):
    """See that the array has the result, to the byte, that one run on one machine has."""
    array = _result(project)
    project.data.rename(project.root / "of the array")
    project.vines("run", "fig5", "--quiet", "--jobs", "1")
    assert _result(project) == array


def _result(project):
    key = json.loads((project.data / "pipelines" / "fig5.pins.json").read_text())["up"]["result"]
    return key, (project.data / "results" / key / "points.parquet").read_bytes()
