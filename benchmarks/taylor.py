"""Cost of an impact where flights have no closed form: ``python -m benchmarks.taylor [--heyoka PYTHON]``.

A mass on a cubic spring between barriers (check value c3 of docs/systems.md) by vines, by SciPy's DOP853 with an event
for the barriers, and, if an interpreter that has it is given, by heyoka; and a ball with a mass on such a spring beside
it by vines. Times are those of the processor, in turn; the median and the range of five runs. What compiles is called
once before.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import vines
from vines.dynamics._advance import S_IMPACTS, pass_over
from vines.dynamics._room import constants, room_of, start_of
from vines.dynamics.runs import EVENTS_PER_PERIOD
from vines.systems import CubicBarriers, Hybrid

RUNS = 5
PERIODS = 1000
PERIODS_OF_PEERS = {"DOP853": 4, "heyoka": 100}
CASE = CubicBarriers(mu=0.02, A=0.03, k3=1.0, l2=0.2)
BESIDE = Hybrid(mu=0.01, A=0.03, mu_n=0.01, k3=1.0, l2=0.2)
START = {p: vines.find_orbit("LR", p).start() for p in (CASE, BESIDE)}


def series(p: CubicBarriers | Hybrid, periods: int) -> tuple[float, int]:
    """Return seconds and impacts of a run by vines that keeps no event."""
    c, room = constants(p), room_of(p)
    layout = room.layout(p)
    state, rows = np.zeros(layout.state), np.empty((layout.rows, layout.width))
    at = dict(START[p])
    t = at.pop("t")
    room.begin(c, state, *start_of(p, at, t, 0.0), t)
    began = time.process_time()
    pass_over(c, state, t + periods * p.period, EVENTS_PER_PERIOD, rows)
    return time.process_time() - began, int(state[S_IMPACTS])


def whole(p: CubicBarriers | Hybrid, periods: int) -> tuple[float, int]:
    """Return the same of a run whose events are kept and whose energies are taken."""
    began = time.process_time()
    run = vines.simulate(p, **START[p], periods=periods)
    run.measures()
    return time.process_time() - began, len(run.impacts)


def dop853(p: CubicBarriers, periods: int) -> tuple[float, int]:
    """Return the same of SciPy's DOP853, tolerance 1e-13, stopped at the barriers."""

    def rates(t: float, y: np.ndarray) -> list[float]:
        x, v, w, u = y
        spring = p.k1 * w + p.k3 * w * w * w + p.l2 * u
        force = p.A * (np.sin(p.Omega * t) + p.lam * p.Omega * np.cos(p.Omega * t)) - p.lam * v - x
        return [v, force - p.mu * spring, u, force - (1 + p.mu) * spring]

    def left(t: float, y: np.ndarray) -> float:
        return 1.0 - y[2]

    def right(t: float, y: np.ndarray) -> float:
        return 1.0 + y[2]

    for event in (left, right):
        event.terminal, event.direction = True, -1
    began = time.process_time()
    x1, v1, x2, v2, t = START[p].values()
    y, hits, end = [x1, v1, x1 - x2, v1 - v2], 0, t + periods * p.period
    while t < end - 1e-9:
        found = solve_ivp(rates, (t, end), y, "DOP853", rtol=1e-13, atol=1e-14, events=(left, right))
        t = found.t[-1]
        if found.status != 1:
            break
        x, v, w, u = found.y[:, -1]
        v -= p.mu * (1 + p.r) * u / (1 + p.mu)
        y, hits = [x, v, np.sign(w), -p.r * u], hits + 1
    return time.process_time() - began, hits


def heyoka(python: str) -> Callable[[CubicBarriers, int], tuple[float, int]]:
    """Return what runs heyoka in another interpreter."""

    def run(p: CubicBarriers, periods: int) -> tuple[float, int]:
        script = Path(__file__).with_name("heyoka_run.py")
        given = json.dumps({**p.as_dict(), **START[p], "periods": periods})
        told = subprocess.run([python, str(script), given], check=True, capture_output=True, text=True).stdout
        seconds, hits = json.loads(told)
        return seconds, hits

    return run


def main() -> None:
    """Print µs an impact of each, and their ratios to ours."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--heyoka", metavar="PYTHON", help="an interpreter that has heyoka")
    asked = parser.parse_args()
    peers: dict[str, Callable[[Any, int], tuple[float, int]]] = {
        "vines, events passed over": series, "vines, kept and measured": whole, "DOP853": dop853,
        "a mass beside a ball": series, "kept and measured": whole,
    }  # fmt: skip
    cases = dict.fromkeys(("a mass beside a ball", "kept and measured"), BESIDE)
    if asked.heyoka:
        peers["heyoka"] = heyoka(asked.heyoka)
    costs: dict[str, list[float]] = {name: [] for name in peers}
    for run in (series, whole):
        run(CASE, 10)
        run(BESIDE, 10)
    for _ in range(RUNS):
        for name, run in peers.items():
            seconds, hits = run(cases.get(name, CASE), PERIODS_OF_PEERS.get(name, PERIODS))
            costs[name].append(seconds / hits * 1e6)
    ours = statistics.median(costs["vines, events passed over"])
    for name, each in costs.items():
        middle = statistics.median(each)
        print(f"{name:28}{middle:12.2f} µs an impact ({min(each):.2f} … {max(each):.2f}), {middle / ours:.4g} times")


if __name__ == "__main__":
    main()
