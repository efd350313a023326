"""Speed of the lanes alone, on one core: ``python -m benchmarks.lanes``. It needs numpy and numba and nothing else.

Every figure is the median of five; times are those of the processor, so that a busy machine disturbs little.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np

from vines.dynamics import _lane_fields as f
from vines.dynamics import ensemble
from vines.dynamics._lane_certificate import certify
from vines.dynamics._lane_guess import GROUP, predict
from vines.dynamics._lane_measures import measure, renew
from vines.dynamics._lane_motion import half_turn, small_expm1
from vines.dynamics._lane_strike import aim, arrive, go, strike
from vines.dynamics._lanes import choose
from vines.kernels import WIDE, loop_njit
from vines.model import Params

ORBIT = Params(mu=0.01, A=0.015)
MIXED = Params(mu=0.01, A=0.03)
STRONG = Params(mu=0.1, A=0.3)
REPEATS = 5
PUBLISHED_FLOOR = 11.0
"""ns for four sincos-exponential evaluations on the machine of facts/mathematics.md."""

WAYS = {
    "lanes, final states": {"periods": 200},
    "lanes, measures": {"periods": 200, "record": "measures"},
    "lanes, measures over 40 periods": {"periods": 40, "record": "measures"},
    "lanes, measures and impacts kept": {"periods": 200, "record": "impacts"},
    "lanes, Lyapunov spectrum": {"periods": 200, "lyapunov": True},
}


def median(work: Callable[[], object]) -> float:
    """Return the median processor time of five calls after a first one."""
    work()
    times = []
    for _ in range(REPEATS):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return statistics.median(times)


@loop_njit
def _floor(L, n):
    """Four sine-cosine pairs and four exponentials in each lane, n times: what an impact cannot do without."""
    for _ in range(n):
        for i in range(f.LANES):
            x = L[f.MOVE + i]
            total = 0.0
            s, c = half_turn(x)
            total += s * c + small_expm1(-x)
            s, c = half_turn(x * 0.9)
            total += s * c + small_expm1(-x * 0.9)
            s, c = half_turn(x * 0.8)
            total += s * c + small_expm1(-x * 0.8)
            s, c = half_turn(x * 0.7)
            total += s * c + small_expm1(-x * 0.7)
            L[f.MOVE + i] = 0.3 + 0.05 * total


def _room() -> np.ndarray:
    """Return lanes in the middle of nowhere in particular, beginning where a line of the cache begins."""
    room = np.zeros(f.SIZE + 8)
    L = room[(-room.ctypes.data // 8) % 8 :][: f.SIZE]
    L[:] = np.random.default_rng(1).uniform(0.1, 0.9, f.SIZE)
    # Undamped, so that nothing decays to numbers with which processors are slow.
    for field, value in ((f.HALF, 0.0), (f.LAM, 0.0), (f.GAMMA, 1.0), (f.INVERSE, 1.0), (f.OMEGA, 1.0), (f.UNIT, 1.0)):
        L[field : field + f.LANES] = value
    for field in (f.WAITS, f.SPEED, f.SIN):
        L[field : field + f.LANES] = 0.0
    L[f.COS : f.COS + f.LANES] = 1.0
    return L


def floor() -> float:
    """Return the floor in ns an impact."""
    L, n = _room(), 20_000
    return median(lambda: _floor(L, n)) / n / f.LANES * 1e9


@loop_njit
def _moves(L, n):
    for _ in range(n):
        go(L)


@loop_njit
def _arrivals(L, n):
    for _ in range(n):
        aim(L)
        arrive(L)


@loop_njit
def _certificates(L, n):
    for _ in range(n):
        certify(L)


@loop_njit
def _strikes(L, n):
    for _ in range(n):
        strike(L)
        choose(L, 1e9)


@loop_njit
def _predictions(L, n):
    for _ in range(n):
        for i in range(0, f.LANES, GROUP):
            predict(L[i:])


@loop_njit
def _measures(L, n):
    for _ in range(n):
        measure(L)
        renew(L)


def parts_of_a_tick() -> list[tuple[str, float]]:
    """Return (what, ns a lane) of the loops of which a tick is made, and of those that take measures."""
    n, rows = 5000, []
    for name, work in (
        ("move", _moves),
        ("aim, arrive", _arrivals),
        ("certify", _certificates),
        ("strike, choose", _strikes),
        ("predict, where flights differ", _predictions),
        ("measures", _measures),
    ):
        L = _room()
        rows.append((name, median(lambda work=work, L=L: work(L, n)) / n / f.LANES * 1e9))
    return rows


def ways_to_run(p: Params) -> list[tuple[str, float]]:
    """Return (what, ns an impact) for the ways to run an ensemble, on one core."""
    v2, rows = {"v2": np.linspace(0.09, 0.11, 2048)}, []
    for name, options in WAYS.items():
        hits = int(ensemble(p, v2, threads=1, **options).counts.sum())
        rows.append((name, median(lambda options=options: ensemble(p, v2, threads=1, **options)) / hits * 1e9))
    return rows


def main() -> None:
    """Print the table."""
    bottom = floor()
    print(f"vectors of {8 if WIDE else 4} doubles")
    print(f"floor: four sincos-exp evaluations in a lane {bottom:.1f} ns here, {PUBLISHED_FLOOR:.0f} ns in the facts")
    for name, ns in parts_of_a_tick():
        print(f"  {name:36s} {ns:12.1f} ns a lane")
    for p in (ORBIT, MIXED, STRONG):
        print(f"\n{p}")
        for name, ns in ways_to_run(p):
            floors = f", {ns / bottom:.1f} floors of here, {ns / PUBLISHED_FLOOR:.1f} of the facts"
            print(f"  {name:36s} {ns:12.1f} ns an impact{floors if 'final' in name else ''}")


if __name__ == "__main__":
    main()
