"""A long log in the viewer, thinned and in full: 10^5 impacts and 2*10^6 states.

Run as ``python -m benchmarks.long_log [--full]``. The log is made once (50 000 forcing periods of the symmetric 1:1
orbit, 40 states a period); then `vines view --save` does it in a process of its own, five times, and once with
``--full``, which takes minutes: what is timed is all of it, from the start of Python to the recording on the disk.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from vines import Params, logs, simulate

PERIODS = 50_000
PER_PERIOD = 40
REPEATS = 5


def make(path: Path) -> None:
    """Write the log."""
    run = simulate(Params(mu=0.01, A=0.02, Omega=1.0, r=0.65), periods=PERIODS)
    states = run.sample(per_period=PER_PERIOD)
    logs.write_run(
        path,
        states=states,
        impacts=run.impacts,
        sticks=run.sticks,
        provenance={},
        parameters=run.params.as_dict(),
        name="a long run",
        bare=False,
    )
    print(f"{len(states):,} states, {len(run.impacts):,} impacts, log of {path.stat().st_size / 1e6:.0f} MB")


def saved(log: Path, out: Path, *options: str) -> tuple[float, float]:
    """Return seconds on the clock and of the processor that `vines view --save` took."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, "-m", "vines", "view", str(log), "--save", str(out), *options]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.perf_counter() - start, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Print times and sizes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--full", action="store_true", help="also draw every state")
    full = parser.parse_args().full
    with tempfile.TemporaryDirectory() as name:
        log, out = Path(name) / "long.mcap", Path(name) / "long.rrd"
        make(log)
        print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; medians of {REPEATS}, --full once")
        wall, own = zip(*(saved(log, out) for _ in range(REPEATS)), strict=True)
        told = f"{statistics.median(wall):8.1f} s {statistics.median(own):8.1f} s of processor"
        print(f"thinned {told} {out.stat().st_size / 1e6:8.1f} MB")
        if full:
            before = out.stat().st_size
            one, processor = saved(log, out, "--full")
            print(f"full    {one:8.1f} s {processor:8.1f} s of processor {out.stat().st_size / 1e6:8.1f} MB")
            print(f"ratio   {one / statistics.median(wall):8.1f}   {out.stat().st_size / before:8.1f} in size")


if __name__ == "__main__":
    main()
