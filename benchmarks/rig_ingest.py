"""How long it takes to read and reconstruct a run of 60 s at 51.2 kS/s in four channels, beside nptdms for its file.

Run with ``python -m benchmarks.rig_ingest``; prints medians of five and the peak memory.
"""

from __future__ import annotations

import resource
import statistics
import tempfile
import time
from pathlib import Path

import msgspec

from vines.rig import read_run, reconstruct, ring_down
from vines.rig.formats import read_file
from vines.rig.synth import RigSettings, draw_settings, make_run, simulate_rig


def main() -> None:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "run"
        began = time.perf_counter()
        settings = draw_settings(3, recorders=1)
        make_run(folder, settings, 3)
        still = msgspec.structs.replace(
            RigSettings(),
            protocol="ringdown",
            ball=False,
            E=0.0,
            settle=0.0,
            duration=15.0,
            start=(0.012, 0.0, 0.0, 0.0),
        )
        free = ring_down(simulate_rig(still, 4)[0])
        print(f"made in {time.perf_counter() - began:.1f} s, 120 s of motion, kernels compiled or loaded")
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        peer, ours, all_of_it = [], [], []
        for _ in range(5):
            began = time.perf_counter()
            read_file(folder / "raw" / "run.tdms")
            peer.append(time.perf_counter() - began)
            began = time.perf_counter()
            read_run(folder)
            ours.append(time.perf_counter() - began)
            began = time.perf_counter()
            reconstruct(read_run(folder).recording, [free])
            all_of_it.append(time.perf_counter() - began)
        peak = max(before, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
        a, b = statistics.median(ours), statistics.median(peer)
        print(f"read and reconstruct {statistics.median(all_of_it):.2f} s")
        print(f"read_run {a:.2f} s, nptdms alone {b:.2f} s, ratio {a / b:.1f}; peak of the process {peak / 1e6:.2f} GB")


if __name__ == "__main__":
    main()
