"""Speed beside another checkout, in turn: ``python -m benchmarks.beside CHECKOUT [WORDS] [--runs 7] [--starts 5]``.

A process of each checkout does the same work, one after the other, again and again, so that what disturbs one disturbs
the other too. Processor time of one core; the ratio is the median of those of neighbouring runs. Where a process lies
in memory changes the time of a loop by several percent as long as it lives, so all is done again in new processes: the
ratio shown is the median of the starts, with their least and largest. WORDS choose the rows whose name holds one of
them. Only what both checkouts have under the same name is asked for; each keeps its kernels in a folder of its own
under ``--kernels`` (a temporary one if left out: then compiling takes minutes first).
"""

from __future__ import annotations

import argparse
import functools
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent.parent
RUNS = 2048

REGIMES: dict[str, tuple[dict[str, float], float]] = {
    "periodic, A .015": ({"mu": 0.01, "A": 0.015}, 200),
    "chaos, A .03": ({"mu": 0.01, "A": 0.03}, 200),
    "chaos, A .06": ({"mu": 0.01, "A": 0.06}, 200),
    "periodic, A .3, mu .1": ({"mu": 0.1, "A": 0.3}, 200),
    "two ticks a flight, A = mu = .1, Omega 1.17": ({"mu": 0.1, "A": 0.1, "Omega": 1.17}, 200),
    "slow forcing, A 2, Omega .2": ({"mu": 0.01, "A": 2.0, "Omega": 0.2}, 50),
    "long flights, A .003": ({"mu": 0.01, "A": 0.003}, 200),
    "chatter, A 2": ({"mu": 0.01, "A": 2.0}, 50),
    "chatter, A .3, r .2": ({"mu": 0.01, "A": 0.3, "r": 0.2}, 50),
    "sticking at each impact, A .3, r 0": ({"mu": 0.01, "A": 0.3, "r": 0.0}, 50),
}
"""Name, parameters and forcing periods of runs of one kind."""

WAYS: dict[str, dict[str, Any]] = {
    "final": {},
    "measures": {"record": "measures"},
    "impacts": {"record": "impacts"},
    "spectrum": {"lyapunov": True},
}


def works() -> dict[str, Callable[[], object]]:
    """Return what is timed, by name."""
    import numpy as np

    from vines.attractors import classify_many, settle
    from vines.dynamics import ensemble, lyapunov_spectrum, simulate
    from vines.model import Params
    from vines.orbits import all_orbits, continue_orbit, find_orbit, symmetric_table

    draw = np.random.default_rng(7)
    plane = {"A": 10 ** draw.uniform(np.log10(0.005), 0.0, RUNS), "mu": 10 ** draw.uniform(-3.0, 0.0, RUNS)}
    speeds = {"v2": np.linspace(0.09, 0.11, RUNS)}
    named: dict[str, Callable[[], object]] = {}
    for way, options in WAYS.items():
        for regime, (p, periods) in REGIMES.items():
            named[f"lanes, {way}: {regime}"] = functools.partial(
                ensemble, Params(**p), speeds, periods=periods, threads=1, **options
            )
        named[f"lanes, {way}: map of (A, mu)"] = functools.partial(ensemble, plane, periods=200, threads=1, **options)
        named[f"lanes, {way}: map of (A, mu), r .3"] = functools.partial(
            ensemble, {**plane, "r": np.full(RUNS, 0.3)}, periods=100, threads=1, **options
        )
    named["regime map, 256 points"] = lambda: classify_many(
        {name: values[:256] for name, values in plane.items()}, settle=200, watch=128, threads=1
    )
    for regime in ("periodic, A .015", "chaos, A .03", "chatter, A .3, r .2"):
        p = Params(**REGIMES[regime][0])
        run = simulate(p, periods=2000)
        named[f"one run, events: {regime}"] = functools.partial(simulate, p, periods=2000)
        named[f"one run, measures: {regime}"] = run.measures
        named[f"one run, spectrum: {regime}"] = functools.partial(lyapunov_spectrum, run)
        named[f"settle: {regime}"] = functools.partial(settle, p)
    orbit, low = find_orbit("LR", Params(mu=0.01, A=0.015)), Params(mu=0.01, A=0.023)
    two = find_orbit("LLR", low)
    named["find_orbit, 1:1"] = lambda: [find_orbit("LR", orbit.params) for _ in range(20)]
    named["find_orbit, LLR from a neighbour"] = lambda: [find_orbit("LLR", low, guess=two) for _ in range(20)]
    named["all orbits of LLR"] = lambda: all_orbits("LLR", low)
    named["continue_orbit, 1:1"] = lambda: continue_orbit(orbit, "A", 0.03, within=(0.012, 0.03))
    named["symmetric_table, 20,000 points"] = lambda: symmetric_table(
        np.full(20_000, 0.01), np.linspace(0.01, 1.0, 20_000), np.ones(20_000), np.full(20_000, 0.65)
    )
    return named


def answer() -> None:
    """Do what the lines of stdin name, and say how long it took the processor."""
    named = works()
    print(json.dumps(list(named)), flush=True)
    for line in sys.stdin:
        work = named[json.loads(line)]
        began = time.process_time()
        work()
        print(json.dumps(time.process_time() - began), flush=True)


class Checkout:
    """A process that works with the sources of a checkout."""

    def __init__(self, folder: Path, kernels: Path) -> None:
        environment = {**os.environ, "PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(kernels), "VINES_QUIET": "1"}
        self._process = subprocess.Popen(
            [sys.executable, "-P", __file__, "--answer"],
            cwd=folder,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.names: list[str] = self._read()

    def _read(self) -> Any:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit(f"the process of {self._process.args} ended; its message stands above")
        return json.loads(line)

    def seconds(self, name: str) -> float:
        """Return the processor time of a piece of work."""
        assert self._process.stdin is not None
        print(json.dumps(name), file=self._process.stdin, flush=True)
        return self._read()

    def close(self) -> None:
        """Let the process end."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()


def compared(here: Checkout, there: Checkout, name: str, runs: int) -> tuple[float, float, float]:
    """Return the median times of both, and the median ratio of neighbours."""
    for checkout in (here, there):
        checkout.seconds(name)
    pairs = [(here.seconds(name), there.seconds(name)) for _ in range(runs)]
    ours, theirs = (statistics.median(times) for times in zip(*pairs, strict=True))
    return ours, theirs, statistics.median(one / other for one, other in pairs)


def started(origin: Path, kernels: Path, words: list[str], runs: int) -> dict[str, tuple[float, float, float]]:
    """Return what `compared` finds, by name, in a process of each checkout."""
    # Both begin to compile at the same time.
    here, there = Checkout(HERE, kernels / "here"), Checkout(origin, kernels / "there")
    wanted = [name for name in here.names if name in there.names and (not words or any(w in name for w in words))]
    found = {name: compared(here, there, name, runs) for name in wanted}
    here.close()
    there.close()
    return found


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("checkout", type=Path, nargs="?")
    parser.add_argument("words", nargs="*")
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--starts", type=int, default=5)
    parser.add_argument("--kernels", type=Path)
    parser.add_argument("--answer", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.answer:
        answer()
        return
    if asked.checkout is None or not (asked.checkout / "vines").is_dir():
        parser.error(f"{asked.checkout} holds no folder vines; give a checkout of vines")
    with tempfile.TemporaryDirectory() as folder:
        kernels, origin = asked.kernels or Path(folder), asked.checkout.resolve()
        starts = [started(origin, kernels, asked.words, asked.runs) for _ in range(asked.starts)]
    print("| work | here, ms | there, ms | here/there | least to largest |\n|---|---|---|---|---|")
    for name in starts[0]:
        ours, theirs, ratio = (
            statistics.median(values) for values in zip(*(each[name] for each in starts), strict=True)
        )
        ratios = [each[name][2] for each in starts]
        spread = f"{min(ratios):.2f} to {max(ratios):.2f}"
        print(f"| {name} | {ours * 1e3:.2f} | {theirs * 1e3:.2f} | {ratio:.2f} | {spread} |")


if __name__ == "__main__":
    main()
