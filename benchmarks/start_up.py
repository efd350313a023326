"""How long a user waits for the command line: medians of seven cold processes.

Run as ``python -m benchmarks.start_up`` after ``make run``. The peer is the interpreter itself importing numpy:
no command that needs an array can start faster.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

REPEATS = 7
COMMANDS = {
    "vines --help": ["-m", "vines.cli", "--help"],
    "vines list": ["-m", "vines.cli", "list"],
    "vines status quickstart": ["-m", "vines.cli", "status", "quickstart"],
    "vines run quickstart (nothing to do)": ["-m", "vines.cli", "run", "quickstart"],
    "vines query (narrow)": ["-m", "vines.cli", "query", "select value from bifurcations limit 1"],
    "import vines": ["-c", "import vines"],
    "peer: import numpy": ["-c", "import numpy"],
}


def seconds(arguments: list[str]) -> float:
    """Return the median wall time of a cold process."""
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        subprocess.run([sys.executable, *arguments], check=True, capture_output=True)
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def rows() -> list[tuple[str, float, float]]:
    """Return (command, median seconds, ratio to the peer)."""
    measured = {name: seconds(arguments) for name, arguments in COMMANDS.items()}
    peer = measured["peer: import numpy"]
    return [(name, value, value / peer) for name, value in measured.items()]


if __name__ == "__main__":
    print(f"{'command':40s} {'median s':>9s} {'x numpy':>8s}")
    for name, value, ratio in rows():
        print(f"{name:40s} {value:9.3f} {ratio:8.2f}")
