"""Processor time of writing and reading logs, against a checkout of another revision.

Run as ``python -m benchmarks.logs_before CHECKOUT``, where CHECKOUT is a folder with that revision. Both do the same
work in processes of their own, in turn, and the least of all rounds counts: other work only adds time.
Logs of a run (with the profile for bare viewers and without, long and short) and of a rig with three sensors are
written and read with all checks.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

ROUNDS = 3
REPEATS = 4
ROWS = 60_000
ABOUT = {"quantity": "displacement", "unit": "m", "sign": "positive to the right", "rate": "600"}


def rows(message: str, count: int, time_field: str) -> np.ndarray:
    """Return messages that move like a run, in full precision."""
    from vines.schema import numpy_dtype

    random, dtype = np.random.default_rng(count), numpy_dtype(message)
    made, t = np.zeros(count, dtype), np.linspace(0.0, 1000.0, count)
    for place, name in enumerate(dtype.names or ()):
        wave = np.sin((1 + 0.1 * place) * t + place) * (1 + 0.1 * random.standard_normal(count))
        made[name] = wave if dtype[name].kind == "f" else 1
    made[time_field] = t
    return made


def cases() -> dict[str, Callable[[Path], object]]:
    """Return what writes each kind of log."""
    from vines import logs

    about = {"provenance": {}, "parameters": {"mu": 0.01}, "name": "benchmark"}

    def run(count: int, bare: bool) -> Callable[[Path], object]:
        kinds = (
            ("states", "State", count, "t"),
            ("impacts", "Impact", count // 25, "t"),
            ("sticks", "Stick", 60, "t_start"),
        )
        arrays = {key: rows(f"vines.v1.{name}", size, field) for key, name, size, field in kinds}
        return lambda path: logs.write_run(path, **arrays, **about, bare=bare)

    base = rows("vines.v1.BaseMotion", ROWS, "t")
    sensors = {name: logs.Sensor(rows("vines.v1.SensorSample", ROWS, "t"), ABOUT) for name in "abc"}
    return {
        "run": run(ROWS, False),
        "run, bare": run(ROWS, True),
        "short run, bare": run(2000, True),
        "rig": lambda path: logs.write_rig(path, sensors=sensors, base=base, **about),
    }


def measured() -> dict[str, tuple[float, float]]:
    """Return the least processor time of writing and of reading each kind of log [s]."""
    from vines import logs

    found: dict[str, tuple[float, float]] = {}
    with tempfile.TemporaryDirectory() as name:
        for case, write in cases().items():
            path, times = Path(name) / "run.mcap", []
            for _ in range(REPEATS + 1):
                start = time.process_time()
                write(path)
                middle = time.process_time()
                logs.read(path)
                times.append((middle - start, time.process_time() - middle))
            # The first round also imports.
            found[case] = (min(each[0] for each in times[1:]), min(each[1] for each in times[1:]))
    return found


def in_checkout(folder: Path) -> dict[str, tuple[float, float]]:
    """Return what a process measures that imports vines from a folder."""
    done = subprocess.run(
        [sys.executable, __file__, "--measure"],
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        check=True,
        cwd=folder,
    )
    told = json.loads(done.stdout)
    if not Path(told["of"]).is_relative_to(folder):
        raise SystemExit(f"vines came from {told['of']} and not from {folder}")
    return told["times"]


def main(before: Path) -> None:
    """Print both times and their ratio, a line a kind of log."""
    here = Path(__file__).resolve().parent.parent
    rounds = [(in_checkout(before.resolve()), in_checkout(here)) for _ in range(ROUNDS)]
    print(f"{'':18s}{'write before':>14s}{'now':>8s}{'ratio':>7s}{'read before':>14s}{'now':>8s}{'ratio':>7s}")
    for case in rounds[0][0]:
        line = f"{case:18s}"
        for place, width in ((0, 14), (1, 14)):
            old, new = (min(each[side][case][place] for each in rounds) for side in (0, 1))
            line += f"{old:{width}.3f}{new:8.3f}{new / old:7.2f}"
        print(line)


if __name__ == "__main__":
    if sys.argv[1:] == ["--measure"]:
        import vines

        print(json.dumps({"of": vines.__file__, "times": measured()}))
    else:
        main(Path(sys.argv[1]))
