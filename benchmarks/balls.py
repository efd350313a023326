"""Cost of an impact with several balls: ``python -m benchmarks.balls``. It needs numpy and numba and nothing else.

All run the kernels of `vines.dynamics.parallel`, the VI-NES its own; times are those of the processor, least of five.
"""

from __future__ import annotations

import time
from typing import Any

import vines
from vines.systems import Parallel

PERIODS = 4000
REPEATS = 5
CASES = {"A = .03": (0.03, 1.0), "A = .1, Omega = 1.17": (0.1, 1.17)}


def cost(p: Any, v2: Any) -> float:
    """Return µs an impact, the least of some runs of which every event is kept."""
    vines.simulate(p, v2=v2, periods=5)
    found = []
    for _ in range(REPEATS):
        began = time.process_time()
        run = vines.simulate(p, v2=v2, periods=PERIODS)
        found.append((time.process_time() - began) / len(run.impacts) * 1e6)
    return min(found)


def main() -> None:
    """Print µs an impact for 1, 2, 4 and 8 balls of .02 in all, lengths from 1 to 1.4, and the ratios to one ball."""
    print(f"{'µs an impact':24}{'VI-NES':>9}" + "".join(f"{f'N = {n}':>16}" for n in (1, 2, 4, 8)))
    for name, (A, Omega) in CASES.items():
        model = cost(vines.Params(mu=0.02, A=A, Omega=Omega), 0.1)
        costs = []
        for n in (1, 2, 4, 8):
            beta = [1.0 + 0.4 * k / max(n - 1, 1) for k in range(n)]
            v2 = [0.1 - 0.07 * k for k in range(n)]
            costs.append(cost(Parallel(mu=(0.02 / n,) * n, beta=beta, A=A, Omega=Omega), v2))
        shown = "".join(f"{f'{each:.3f} ({each / costs[0]:.2f})':>16}" for each in costs)
        print(f"{name:24}{model:9.3f}{shown}")


if __name__ == "__main__":
    main()
