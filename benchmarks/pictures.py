"""The picture of errors in docs/dynamics.md: ``python -m benchmarks.pictures``."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from benchmarks.dynamics import ORBIT, dop853, siconos, start_on
from benchmarks.rk4 import rk4_run
from vines.dynamics import ensemble, simulate

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "pictures"


def _worst(speeds: np.ndarray, speed: float, upto: np.ndarray) -> np.ndarray:
    """Return the largest error among the impacts of the first periods, two impacts a period."""
    error = np.maximum.accumulate(np.abs(speeds - speed))
    return np.array([error[min(2 * n, len(error)) - 1] for n in upto])


def error_against_periods() -> None:
    """Draw the largest error of |w'| so far against the number of periods, for all methods."""
    p = ORBIT
    start, speed = start_on(p)
    state = [start[name] for name in ("x1", "v1", "x2", "v2", "phase")]
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    ax = figure.add_subplot()

    def line(name: str, speeds: np.ndarray, **style: object) -> None:
        last = len(speeds) // 2
        upto = np.unique(np.logspace(0, math.log10(last), 60).astype(int))
        ax.plot(upto, np.maximum(_worst(speeds, speed, upto), 1e-17), label=name, **style)

    for parts, shade in ((100, "#fdae6b"), (400, "#e6550d"), (2000, "#a63603")):
        speeds = np.zeros(20_000)
        hits = rk4_run(p.mu, p.A, p.Omega, p.r, p.lam, *state, 5000 * p.period, parts, speeds)
        line(f"RK4, T/{parts}, halved to 1e-9", speeds[:hits], color=shade)
    line("SciPy DOP853, 1e-9, events", dop853(p, start, 200), color="#756bb1")
    # Its integrator gives up somewhere beyond 50 periods.
    told = siconos(p, start, 200) or siconos(p, start, 50)
    if told and told["speeds"]:
        line("Siconos, event-driven (to where it gives up)", np.array(told["speeds"]), color="#31a354")
    hits = simulate(p, **{n: start[n] for n in ("x1", "v1", "x2", "v2")}, phi=start["phase"], periods=100_000).impacts
    line("vines, scalar", np.abs(hits["w_dot"]), color="#08519c", linewidth=2)
    many = ensemble(p, {n: [v] for n, v in start.items()}, periods=100_000, record="impacts").impacts
    assert many is not None
    line("vines, lanes", np.abs(many["w_dot"]), color="#6baed6", linewidth=2)
    ax.set(xscale="log", yscale="log", xlabel="forcing periods", ylabel="largest error of |w'| so far")
    ax.set_ylim(1e-17, 1e-2)
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8, ncols=2, loc="upper right")
    ax.set_title(f"Symmetric 1:1 orbit, {p}", fontsize=9)
    figure.savefig(FOLDER / "dynamics_error.png", dpi=130)


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    error_against_periods()
