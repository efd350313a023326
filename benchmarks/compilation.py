"""What compiling the kernels costs, beside another checkout: from nothing, by part, and after edits; Markdown tables.

    python -m benchmarks.compilation [CHECKOUT] [--runs 5] [--clones]

The peer is a checkout of another revision, such as aea8472, which compiles in numba's own way: each caller holds a copy
of its callees, with full optimisation, and all that a room compiled is stale when a file of it changes. Both are asked
in turn, and every figure is a median. ``--clones`` times `make run` and `make test` of fresh clones too, with downloads
as they come, and names the twenty slowest tests; nothing else may run beside that.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent.parent

PROGRAM = """
import json, sys, time
import vines
from numba.core import codegen

modules, lines = [0], [0]
optimise = codegen.CPUCodeLibrary._optimize_final_module

def counted(library):
    modules[0] += 1
    lines[0] += str(library._final_module).count("\\n") if sys.argv[1] == "count" else 0
    optimise(library)

codegen.CPUCodeLibrary._optimize_final_module = counted
from vines.attractors import classify_many, settle
from vines.dynamics import Scatter, ensemble, lyapunov_spectrum, simulate, tangent_map
from vines.model import Params
from vines.orbits import continue_orbit, find_orbit, follow_curve, symmetric_table

p, kept = Params(mu=0.01, A=0.015), {}

def one_run():
    run = simulate(Params(mu=0.1, A=0.3, Omega=1.2), periods=4)
    run.measures(), run.sample(16), tangent_map(run), lyapunov_spectrum(run)

def orbits():
    find_orbit("LR", Params(mu=0.01, A=0.017))
    symmetric_table(0.01, 0.017)
    kept["branch"] = continue_orbit(find_orbit("LLR", Params(mu=0.01, A=0.0213)), "A", 0.0212)

parts = {
    "one run: flight, energies, samples, tangent map": one_run,
    "what one run settles to": lambda: settle(p, settle=200),
    "many runs in lanes": lambda: ensemble(p, periods=1, threads=1),
    "many runs and what they settle to": lambda: classify_many(p, settle=200),
    "scatter": lambda: ensemble(p, periods=1, scatter=Scatter(sigma_r=0.1), threads=1),
    "orbits and their families": orbits,
    "curves of bifurcations": lambda: follow_curve(
        kept["branch"].bifurcations[0], box={"A": (0.02, 0.022), "mu": (0.0099, 0.0101)}
    ),
}
seconds = {}
for name, work in parts.items():
    began = time.process_time(), time.perf_counter()
    work()
    seconds[name] = time.perf_counter() - began[1], time.process_time() - began[0]
print(json.dumps({"seconds": seconds, "modules": modules[0], "lines": lines[0]}))
"""

EDITS = {
    "nothing": ("dynamics/_contact.py", "", ""),
    "a docstring of dynamics": ("dynamics/_contact.py", '"""Return the certified step', '"""Return a certified step'),
    "a kernel of orbits": ("orbits/_equations.py", "share < 1e-3", "share < 1.1e-3"),
    "`_contact.py`": ("dynamics/_contact.py", "BEYOND = 1.125", "BEYOND = 1.126"),
}


@dataclass(slots=True)
class Checkout:
    """A copy of the sources of a checkout, and what was measured with it: lists of (clock, processor) in seconds."""

    name: str
    origin: Path
    place: Path
    warm_up: list[tuple[float, float]] = field(default_factory=list)
    parts: list[dict[str, tuple[float, float]]] = field(default_factory=list)
    edits: dict[str, list[tuple[float, float]]] = field(default_factory=dict)
    edited: dict[str, int] = field(default_factory=dict)
    counts: tuple[int, int] = (0, 0)

    def __post_init__(self) -> None:
        for part in ("vines", "schemas", "pipelines"):
            shutil.copytree(self.origin / part, self.place / part, ignore=shutil.ignore_patterns("__pycache__"))

    def run(self, kernels: str, *words: str) -> tuple[str, tuple[float, float]]:
        """Return what a Python process with these sources said, and its seconds by the clock and of processor."""
        environment = os.environ | {
            "NUMBA_CACHE_DIR": str(self.place / kernels),
            "PYTHONPATH": str(self.place),
            "VINES_ROOT": str(self.place),
            "VINES_QUIET": "1",
        }
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-P", *words], env=environment, cwd=self.place, capture_output=True, text=True, check=False
        )
        clock, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode:
            raise SystemExit(f"{self.name}: {(done.stderr.strip() or 'no reason given').splitlines()[-1]}")
        return done.stdout, (clock, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)

    def once(self, k: int) -> None:
        """Compile everything from nothing: as the command does, and part by part in one process; then after edits."""
        self.warm_up.append(self.run(f"warm-up-{k}", "-m", "vines.cli", "warm-up")[1])
        told, _ = self.run(f"parts-{k}", "-c", PROGRAM, "")
        self.parts.append(json.loads(told.splitlines()[-1])["seconds"])
        for edit, (path, old, new) in EDITS.items():
            source = self.place / "vines" / path
            text = source.read_text("utf-8")
            if old not in text:
                raise SystemExit(f"{self.name}: {path} does not contain {old!r} any more; choose another edit")
            # A cache of its own for each edit, so that none finds what another has compiled.
            shutil.copytree(self.place / f"parts-{k}", self.place / "edit")
            source.write_text(text.replace(old, new, 1), "utf-8")
            told, seconds = self.run("edit", "-c", PROGRAM, "")
            source.write_text(text, "utf-8")
            shutil.rmtree(self.place / "edit")
            self.edits.setdefault(edit, []).append(seconds)
            self.edited[edit] = json.loads(told.splitlines()[-1])["modules"]

    def count(self) -> None:
        """Count modules and lines of LLVM before its passes, which takes time of its own."""
        found = json.loads(self.run("count", "-c", PROGRAM, "count")[0].splitlines()[-1])
        self.counts = found["modules"], found["lines"]


def cloned(checkout: Path) -> tuple[dict[str, tuple[float, float]], list[str]]:
    """Return the seconds of `make run` and then `make test` in a fresh clone, and the slowest tests."""
    found: dict[str, tuple[float, float]] = {}
    slowest: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["git", "clone", "-q", str(checkout), folder], check=True)
        environment = {name: value for name, value in os.environ.items() if not name.startswith(("VINES", "NUMBA"))}
        for target in ("run", "test"):
            before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
            command = ["make", target, "PYTEST_ARGS=--durations=20 -q"]
            done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            found[f"`make {target}` of a fresh clone"] = time.perf_counter() - began, processor
            slowest = re.findall(r"^\s*[\d.]+s (?:call|setup|teardown) .*$", done.stdout, re.MULTILINE)
    return found, slowest


def _pair(seconds: Sequence[tuple[float, float]]) -> str:
    clock, processor = (statistics.median(values) for values in zip(*seconds, strict=True))
    return f"{clock:.1f} / {processor:.1f}"


def rows_of(checkout: Checkout) -> dict[str, str]:
    """Return what was measured with a checkout, by row of the table."""
    rows = {"`vines warm-up` of everything": _pair(checkout.warm_up)}
    for part in checkout.parts[0]:
        rows[f"in one process: {part}"] = _pair([found[part] for found in checkout.parts])
    rows["in one process: all"] = _pair(
        [(sum(one for one, _ in found.values()), sum(two for _, two in found.values())) for found in checkout.parts]
    )
    rows["modules compiled"], rows["lines of LLVM before its passes"] = (f"{count:,}" for count in checkout.counts)
    for edit, seconds in checkout.edits.items():
        rows[f"all of it after an edit of {edit}"] = f"{_pair(seconds)}, {checkout.edited[edit]} modules"
    return rows


def table(columns: Iterable[tuple[str, dict[str, str]]]) -> list[str]:
    """Return a Markdown table of named columns."""
    listed = list(columns)
    lines = [
        "| clock / processor, s | " + " | ".join(name for name, _ in listed) + " |",
        "|---" * (1 + len(listed)) + "|",
    ]
    for row in listed[-1][1]:
        lines.append(f"| {row} | " + " | ".join(rows.get(row, "") for _, rows in listed) + " |")
    return lines


def measured(origins: dict[str, Path], runs: int, say: Callable[[str], Any] = print) -> None:
    """Measure checkouts in turn, and say the table."""
    with tempfile.TemporaryDirectory() as folder:
        checkouts = [Checkout(name, origin, Path(folder) / name) for name, origin in origins.items()]
        for k in range(runs):
            for checkout in checkouts:
                checkout.once(k)
        for checkout in checkouts:
            checkout.count()
        say("\n".join(table((each.name, rows_of(each)) for each in checkouts)))


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkout", nargs="?", type=Path, help="of the revision to compare with")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--clones", action="store_true", help="`make run` and `make test` of fresh clones too")
    asked = parser.parse_args()
    origins = ({"before": asked.checkout.resolve()} if asked.checkout else {}) | {"now": HERE}
    measured(origins, asked.runs)
    if asked.clones:
        found = {name: cloned(origin) for name, origin in origins.items()}
        columns = ((name, {row: _pair([pair]) for row, pair in rows.items()}) for name, (rows, _) in found.items())
        print("\n" + "\n".join(table(columns)))
        print("\nThe twenty slowest tests now:\n\n```\n" + "\n".join(found["now"][1]) + "\n```")


if __name__ == "__main__":
    main()
