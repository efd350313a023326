"""Cost of an impact with several balls: ``python -m benchmarks.balls``. It needs numpy and numba and nothing else.

All run the kernels of `vines.dynamics.parallel`, the VI-NES its own. Events are found and written over each other, as
in a transient; times are those of the processor, the least of seven in turn.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import vines
from vines.dynamics._advance import S_IMPACTS, pass_over
from vines.dynamics._room import constants, room_of, start_of
from vines.dynamics.runs import EVENTS_PER_PERIOD
from vines.systems import Parallel

BALLS = (1, 2, 4, 8)
PERIODS = 2000
REPEATS = 7
CASES = {"A = .03": (0.03, 1.0), "A = .1, Omega = 1.17": (0.1, 1.17)}


def once(p: Any, v2: Any) -> float:
    """Return µs an impact of one run."""
    c, room = constants(p), room_of(p)
    layout = room.layout(p)
    state, rows = np.zeros(layout.state), np.empty((layout.rows, layout.width))
    room.begin(c, state, *start_of(p, {"v2": v2}, 0.0, 0.0), 0.0)
    began = time.process_time()
    pass_over(c, state, PERIODS * p.period, EVENTS_PER_PERIOD, rows)
    return (time.process_time() - began) / state[S_IMPACTS] * 1e6


def main() -> None:
    """Print µs an impact for 1, 2, 4 and 8 balls of .02 in all, lengths from 1 to 1.4, and the ratios to one ball."""
    print(f"{'µs an impact':24}{'VI-NES':>9}" + "".join(f"{f'N = {n}':>16}" for n in BALLS))
    for name, (A, Omega) in CASES.items():
        runs: list[tuple[Any, Any]] = [(vines.Params(mu=0.02, A=A, Omega=Omega), 0.1)]
        for n in BALLS:
            beta = [1.0 + 0.4 * k / max(n - 1, 1) for k in range(n)]
            runs.append((Parallel(mu=(0.02 / n,) * n, beta=beta, A=A, Omega=Omega), [0.1 - 0.07 * k for k in range(n)]))
        for run in runs:
            once(*run)
        # In turn, so that a busy machine disturbs all alike.
        model, *costs = (
            min(each) for each in zip(*([once(*run) for run in runs] for _ in range(REPEATS)), strict=True)
        )
        shown = "".join(f"{f'{each:.3f} ({each / costs[0]:.2f})':>16}" for each in costs)
        print(f"{name:24}{model:9.3f}{shown}")


if __name__ == "__main__":
    main()
