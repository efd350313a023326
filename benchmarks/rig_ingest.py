"""How long it takes to read a run of 60 s at 51.2 kS/s in four channels, beside what nptdms needs for its file alone.

Run with ``python -m benchmarks.rig_ingest``; prints medians of five and the peak memory.
"""

from __future__ import annotations

import resource
import statistics
import tempfile
import time
from pathlib import Path

from vines.rig import read_run
from vines.rig.formats import read_file
from vines.rig.synth import RigSettings, make_run


def main() -> None:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "run"
        began = time.perf_counter()
        make_run(folder, RigSettings(), 1)
        print(f"made in {time.perf_counter() - began:.1f} s, 120 s of motion, kernels compiled or loaded")
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        peer, ours = [], []
        for _ in range(5):
            began = time.perf_counter()
            read_file(folder / "raw" / "run.tdms")
            peer.append(time.perf_counter() - began)
            began = time.perf_counter()
            read_run(folder)
            ours.append(time.perf_counter() - began)
        peak = max(before, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
        a, b = statistics.median(ours), statistics.median(peer)
        print(f"read_run {a:.2f} s, nptdms alone {b:.2f} s, ratio {a / b:.1f}; peak of the process {peak / 1e6:.2f} GB")


if __name__ == "__main__":
    main()
