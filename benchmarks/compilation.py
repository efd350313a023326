"""What compiling the kernels costs: all of them from nothing, and after edits; the peer is numba's own way.

The peer compiles the same sources with `numba.njit` for every decorator: each caller holds a copy of its callees, with
full optimisation and machine code to be called from Python for all. Both compile in one process, in turn; medians.

    python -m benchmarks.compilation [--runs 5]
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent / "vines"

PROGRAM = """
import json, sys, time
from vines.kernels import expected
import vines.kernels, numba
from numba.core import codegen

if sys.argv[1] == "peer":
    plain = numba.njit(error_model="numpy", nogil=True)
    fused = numba.njit(error_model="numpy", nogil=True, fastmath={"contract", "nsz"})
    inline = numba.njit(error_model="numpy", nogil=True, fastmath={"contract", "nsz"}, forceinline=True)
    arrays = ("new_vector new_matrix new_cube zero_vector zero_matrix zero_cube integer_vector zero_integers "
              "byte_vector complex_vector complex_matrix identity max_abs copy_values").split()
    for name in arrays:
        setattr(vines.kernels, name, plain(getattr(vines.kernels, name).py_func))
    for name in ("njit", "linked_njit", "cold_njit", "entry_njit"):
        setattr(vines.kernels, name, plain)
    vines.kernels.loop_njit, vines.kernels.fused_njit = fused, inline

modules, lines = [0], [0]
optimise = codegen.CPUCodeLibrary._optimize_final_module

def counted(library):
    modules[0] += 1
    lines[0] += str(library._final_module).count("\\n") if sys.argv[2] == "count" else 0
    optimise(library)

codegen.CPUCodeLibrary._optimize_final_module = counted
expected()
from vines.dynamics import _warm_up as dynamics
from vines.attractors import _warm_up as attractors
from vines.orbits import _warm_up as orbits

parts = {"one run": dynamics.runs, "what one run settles to": attractors.one_run, "many runs": attractors.many_runs,
         "scatter": dynamics.scatter, "orbits": orbits.orbits, "curves": orbits.curves}
seconds = {}
for name, work in parts.items():
    began = time.process_time()
    work()
    seconds[name] = time.process_time() - began
print(json.dumps({"seconds": seconds, "modules": modules[0], "lines": lines[0]}))
"""

EDITS = {
    "a docstring of dynamics": ("dynamics/_contact.py", '"""Return |re + i im|."""', '"""Return the modulus."""'),
    "a kernel of orbits": ("orbits/_equations.py", "share < 1e-3", "share < 1.1e-3"),
    "dynamics/_contact.py": ("dynamics/_contact.py", "BEYOND = 1.125", "BEYOND = 1.126"),
}


def _compiled(way: str, cache: Path, package: Path, *, count: bool = False) -> dict:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache), "PYTHONPATH": str(package.parent)}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, way, "count" if count else ""],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout.splitlines()[-1])


def _table(rows: Iterable[tuple[str, ...]]) -> None:
    for row in rows:
        print("| " + " | ".join(row) + " |")


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    runs = parser.parse_args().runs
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        package = place / "sources" / "vines"
        shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
        results: dict[str, list[dict]] = {"vines": [], "peer": []}
        for k in range(runs):
            for way, found in results.items():
                found.append(_compiled(way, place / f"{way}{k}", package))
        counts = {way: _compiled(way, place / f"count-{way}", package, count=True) for way in results}
        parts = list(results["vines"][0]["seconds"])
        print(f"Processor seconds in one process, medians of {runs}.")
        _table([("kernels for", "vines", "numba's own way", "ratio"), ("---",) * 4])
        for part in [*parts, "all"]:
            ours, theirs = (
                statistics.median(sum(r["seconds"].values()) if part == "all" else r["seconds"][part] for r in found)
                for found in results.values()
            )
            _table([(part, f"{ours:.1f}", f"{theirs:.1f}", f"{ours / theirs:.2f}")])
        for what in ("modules", "lines"):
            ours, theirs = counts["vines"][what], counts["peer"][what]
            label = "modules" if what == "modules" else "lines of LLVM before its passes"
            _table([(label, f"{ours:,}", f"{theirs:,}", f"{ours / theirs:.2f}")])
        print("\nAfter an edit: processor seconds of all the work above, and modules compiled.")
        cache = place / "vines0"
        _table([("edit", "s", "modules"), ("---",) * 3])
        for edit, (path, old, new) in {"nothing": ("model/_words.py", "", ""), **EDITS}.items():
            source = package / path
            text = source.read_text("utf-8")
            if old not in text:
                raise SystemExit(f"{path} does not contain {old!r} any more; choose another edit")
            source.write_text(text.replace(old, new, 1), "utf-8")
            done = _compiled("vines", cache, package)
            _table([(edit, f"{sum(done['seconds'].values()):.1f}", str(done["modules"]))])
            source.write_text(text, "utf-8")


if __name__ == "__main__":
    main()
