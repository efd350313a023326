"""How long a user waits for the command line, and what it costs the processor: medians of seven cold processes.

Run as ``python -m benchmarks.start_up`` after ``make run``. The peer is the interpreter itself importing numpy:
no command that needs an array can start faster. On a machine that others use, processor seconds are the steadier ones.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

from vines.places import cache_folder

REPEATS = 7
KERNELS = os.environ.get("NUMBA_CACHE_DIR") or cache_folder()
COMMANDS = {
    "vines --help": ["-m", "vines.cli", "--help"],
    "vines list": ["-m", "vines.cli", "list"],
    "vines status": ["-m", "vines.cli", "status"],
    "vines status (no data yet)": ["-m", "vines.cli", "status"],
    "vines status quickstart": ["-m", "vines.cli", "status", "quickstart"],
    "vines run quickstart (nothing to do)": ["-m", "vines.cli", "run", "quickstart"],
    "vines run quickstart (from nothing)": ["-m", "vines.cli", "run", "quickstart", "--quiet"],
    "vines query (narrow)": ["-m", "vines.cli", "query", "select value from bifurcations limit 1"],
    "import vines": ["-c", "import vines"],
    "peer: import numpy": ["-c", "import numpy"],
}
EMPTY = ("(no data yet)", "(from nothing)")
"""What the names of commands end in that are given an empty folder of results, and the kernels compiled."""


def seconds(name: str) -> tuple[float, float]:
    """Return the median wall and processor seconds of a cold process."""
    walls, processors = [], []
    for _ in range(REPEATS):
        with tempfile.TemporaryDirectory() as folder:
            fresh = {"VINES_DATA": f"{folder}/data", "NUMBA_CACHE_DIR": str(KERNELS)} if name.endswith(EMPTY) else {}
            used, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
            subprocess.run(
                [sys.executable, *COMMANDS[name]], check=True, capture_output=True, env={**os.environ, **fresh}
            )
            walls.append(time.perf_counter() - start)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        processors.append(after.ru_utime + after.ru_stime - used.ru_utime - used.ru_stime)
    return statistics.median(walls), statistics.median(processors)


def rows() -> list[tuple[str, float, float, float]]:
    """Return (command, median seconds, median processor seconds, ratio of the former to the peer)."""
    measured = {name: seconds(name) for name in COMMANDS}
    peer, _ = measured["peer: import numpy"]
    return [(name, wall, processor, wall / peer) for name, (wall, processor) in measured.items()]


if __name__ == "__main__":
    print(f"{'command':40s} {'median s':>9s} {'processor':>10s} {'x numpy':>8s}")
    for name, wall, processor, ratio in rows():
        print(f"{name:40s} {wall:9.3f} {processor:10.3f} {ratio:8.2f}")
