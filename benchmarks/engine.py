"""What the pipeline engine costs beside the work itself, with DVC, Snakemake, pytask and doit measured beside it.

Run as ``python -m benchmarks.engine``. The peers are installed into environments of their own below a temporary folder
(or the folder named by ``VINES_BENCHMARK_PEERS``, which is kept); ``--no-peers`` leaves them out. Every figure is the
median of several cold processes, imports included.

The work is trivial on purpose: a point is one multiplication. A peer's unit of work is a task, so 200 points are 200
tasks there; none of them would be used for a million.
"""

from __future__ import annotations

import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import textwrap
import time
from collections.abc import Callable, Iterator
from pathlib import Path

REPEATS = 5
TARGETS = {
    "no-op, 3 stages": 0.25,
    "no-op, 3 stages of 10^5 points": 0.25,
    "200 points from cold, one job": 1.0,
    "overhead a point, chunks of 10^4 (us)": 5.0,
    "no-op, 10^6 points": 0.5,
    "parent's memory beyond 10^5 points (B a point)": 100.0,
}

LAB = '''
"""A kind whose points cost nothing."""
import msgspec
from vines.pipeline import Batch, Kind, register

class Options(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    gain: float = 1.0

def compute(job):
    import pyarrow as pa
    A = job.points.column("A")
    ids, status = job.points.key.arrow(), pa.repeat("ok", len(A))
    rows = {"point_id": ids, "A": A, "kinetic_ratio": job.options.gain * A, "status": status}
    return Batch(tables={"points": rows})

register(Kind(name="trivial", summary="a multiplication", shape="points", options=Options,
              body="trivial.lab:compute", tables=("points",), parameters={"A": None}, vary="grid"))
'''

RUN = """
import json, resource, sys, time
from pathlib import Path
root, count, chunk = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
sys.path.insert(0, str(root))
import trivial.lab
from vines.pipeline import load, run_pipeline
from vines.store import Store
if chunk:
    import vines.pipeline._work as work
    work.MOST_POINTS = chunk
began = time.perf_counter()
pipeline = load(root / "pipelines" / "bench.toml", {f"stages.{s}.vary.A.count": count for s in ("a", "b", "c")
                if s in sys.argv[4]}, root=root)
run_pipeline(pipeline, Store(root / "data"), stages=list(sys.argv[4]), jobs=1)
print(json.dumps([time.perf_counter() - began, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024]))
"""


def project(folder: Path) -> Path:
    """Make a project with three trivial stages."""
    (folder / "pipelines").mkdir(parents=True)
    (folder / "trivial").mkdir()
    (folder / "trivial" / "__init__.py").write_text("")
    (folder / "trivial" / "lab.py").write_text(LAB)
    stage = '[stages.{1}]\nkind = "trivial"\ngain = {0}\nvary.A = {{ from = 0.015, to = 0.023, count = 67 }}\n'
    (folder / "pipelines" / "bench.toml").write_text("".join(stage.format(*each) for each in enumerate("abc")))
    return folder


def vines(root: Path, count: int, *, stages: str = "abc", chunk: int = 0) -> tuple[float, float, float]:
    """Run the project; return wall seconds, seconds inside, and the parent's largest memory in MB."""
    began = time.perf_counter()
    command = [sys.executable, "-c", RUN, str(root), str(count), str(chunk), stages]
    out = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    wall = time.perf_counter() - began
    inside, memory = json.loads(out)
    return wall, inside, memory


def median(measure: Callable[[], float], repeats: int = REPEATS) -> float:
    """Return the median of several measurements."""
    return statistics.median(measure() for _ in range(repeats))


def fresh(base: Path) -> Iterator[Path]:
    """Yield projects in new folders."""
    number = 0
    while True:
        number += 1
        yield project(base / f"p{number}")


def measure_vines(base: Path) -> dict[str, float]:
    """Measure what the targets are about."""
    projects = fresh(base)
    found = {}
    root = next(projects)
    vines(root, 67)
    found["no-op, 3 stages"] = median(lambda: vines(root, 67)[0])
    root = next(projects)
    small = vines(root, 100_000, stages="a")[2]
    vines(root, 100_000)
    found["no-op, 3 stages of 10^5 points"] = median(lambda: vines(root, 100_000)[0])
    found["200 points from cold, one job"] = median(lambda: vines(next(projects), 200, stages="a")[0])
    few = median(lambda: vines(next(projects), 10_000, stages="a", chunk=10_000)[1], 3)
    many = median(lambda: vines(next(projects), 210_000, stages="a", chunk=10_000)[1], 3)
    found["overhead a point, chunks of 10^4 (us)"] = (many - few) / 200_000 * 1e6
    root = next(projects)
    wall, _, memory = vines(root, 1_000_000, stages="a")
    found["10^6 points from cold"] = wall
    found["no-op, 10^6 points"] = median(lambda: vines(root, 1_000_000, stages="a")[0])
    found["parent's memory, 10^5 points (MB)"] = small
    found["parent's memory, 10^6 points (MB)"] = memory
    found["parent's memory beyond 10^5 points (B a point)"] = (memory - small) * 2**20 / 900_000
    return found


def tasks(tool: str, folder: Path, count: int) -> list[str]:
    """Write `count` independent trivial tasks for a peer and return the command that runs them."""
    folder.mkdir(parents=True)
    if tool == "doit":
        text = f"""
        def write(i):
            open(f"out{{i}}.txt", "w").write(str(0.5 * i))
        def task_point():
            for i in range({count}):
                paths = {{"targets": [f"out{{i}}.txt"], "file_dep": ["in.txt"]}}
                yield {{"name": str(i), "actions": [(write, [i])], **paths}}
        """
        (folder / "dodo.py").write_text(textwrap.dedent(text))
        (folder / "in.txt").write_text("1")
        return ["doit"]
    if tool == "pytask":
        text = f"""
        from pathlib import Path
        from typing import Annotated
        from pytask import Product, task
        for i in range({count}):
            @task(id=str(i))
            def task_point(path: Annotated[Path, Product] = Path(f"out{{i}}.txt"), i: int = i) -> None:
                path.write_text(str(0.5 * i))
        """
        (folder / "task_points.py").write_text(textwrap.dedent(text))
        return ["pytask"]
    if tool == "snakemake":
        text = f"""
        rule all:
            input: expand("out{{i}}.txt", i=range({count}))
        rule point:
            output: "out{{i}}.txt"
            run:
                open(output[0], "w").write(str(0.5 * int(wildcards.i)))
        """
        if count > 3:  # a rule of Python code starts a process a task; a shell line is its quicker way
            text = text.replace(
                '            run:\n                open(output[0], "w").write(str(0.5 * int(wildcards.i)))',
                '            shell: "echo {wildcards.i} > {output}"',
            )
        (folder / "Snakefile").write_text(textwrap.dedent(text))
        return ["snakemake", "--cores", "1", "--quiet", "all"]
    stages = {f"p{i}": {"cmd": f"echo {i} > out{i}.txt", "outs": [f"out{i}.txt"]} for i in range(count)}
    (folder / "dvc.yaml").write_text(json.dumps({"stages": stages}))
    return ["dvc", "repro", "--quiet"]


def environment(tool: str, peers: Path) -> Path:
    """Return the folder of a peer's programs, installed if it is not yet."""
    home = peers / tool
    if not (home / "bin" / tool).exists():
        subprocess.run([sys.executable, "-m", "venv", str(home)], check=True)
        subprocess.run([str(home / "bin" / "pip"), "install", "--quiet", tool], check=True, stderr=subprocess.DEVNULL)
    return home / "bin"


def measure_peer(tool: str, peers: Path, base: Path) -> dict[str, float | str]:
    """Measure a peer: nothing to do for three tasks, and 200 tasks from cold and again."""
    programs = environment(tool, peers)
    variables = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "DVC_NO_ANALYTICS": "1"}
    variables.pop("PYTHONPATH", None)

    def run(command: list[str], folder: Path) -> float:
        began = time.perf_counter()
        path = str(programs / command[0])
        subprocess.run([path, *command[1:]], cwd=folder, env=variables, check=True, capture_output=True)
        return time.perf_counter() - began

    found: dict[str, float | str] = {}
    for count in (3, 200):
        folder = base / f"{tool}{count}"
        command = tasks(tool, folder, count)
        if tool == "dvc":
            subprocess.run(["git", "init", "--quiet"], cwd=folder, check=True)
            run(["dvc", "init", "--quiet"], folder)
        found[f"cold, {count} tasks"] = run(command, folder)
        found[f"no-op, {count} tasks"] = median(lambda c=command, f=folder: run(c, f), 3)
    version = [str(programs / "pip"), "show", tool]
    lines = subprocess.run(version, check=True, capture_output=True, text=True).stdout.splitlines()
    found["version"] = next(line.split()[-1] for line in lines if line.startswith("Version"))
    return found


def main() -> int:
    """Print all figures; return 1 if a target is missed."""
    base = Path(tempfile.mkdtemp(prefix="vines-benchmark-"))
    kept = os.environ.get("VINES_BENCHMARK_PEERS")
    peers = Path(kept) if kept else base / "peers"
    try:
        ours = measure_vines(base / "vines")
        missed = [name for name, most in TARGETS.items() if ours[name] > most]
        for name, value in ours.items():
            target = f"target {TARGETS[name]:g}" if name in TARGETS else ""
            print(f"{name:48s} {value:8.3f}  {target:12s} {'MISSED' if name in missed else ''}".rstrip())
        if "--no-peers" not in sys.argv:
            columns = ["no-op, 3 tasks", "cold, 200 tasks", "no-op, 200 tasks"]
            print(f"\n{'':22s}" + "".join(f"{column:>18s}" for column in columns))
            root = project(base / "beside")
            row = [ours["no-op, 3 stages"], ours["200 points from cold, one job"]]
            vines(root, 200, stages="a")
            row.append(median(lambda: vines(root, 200, stages="a")[0]))
            print(f"{'vines':22s}" + "".join(f"{value:18.2f}" for value in row))
            for tool in ("doit", "pytask", "snakemake", "dvc"):
                found = measure_peer(tool, peers, base / "tasks")
                name = f"{tool} {found['version']}"
                print(f"{name:22s}" + "".join(f"{found[column]:18.2f}" for column in columns), flush=True)
        return 1 if missed else 0
    finally:
        shutil.rmtree(base, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
