"""The pictures of docs/dynamics.md: ``python -m benchmarks.pictures [error] [regimes]``."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from benchmarks.dynamics import ORBIT, dop853, siconos, start_on
from benchmarks.rk4 import rk4_run
from vines.dynamics import ensemble, simulate

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "pictures"
COLUMNS, ROWS = 640, 500
KINDS = (
    ("two impacts a period", "#2166ac"),
    ("three", "#67a9cf"),
    ("four or more", "#d1e5f0"),
    ("fewer than two", "#fddbc7"),
    ("sticking", "#1b7837"),
    ("chaotic (largest exponent > .005)", "#b2182b"),
    ("no impact", "#eeeeee"),
)


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


def regime_map() -> None:
    """Draw what is reached over (A, mu) from rest, and K2/K1 beside it."""
    A, mu = np.logspace(-2.3, 0.3, COLUMNS), np.logspace(-3, 0, ROWS)
    a, m = (grid.ravel() for grid in np.meshgrid(A, mu))
    found = ensemble({"mu": m, "A": a}, settle=300, periods=32, record="measures", lyapunov=True)
    assert found.measures is not None
    assert found.exponents is not None
    hits = (found.measures["impacts_left"] + found.measures["impacts_right"]) / 32
    kind = np.full(len(a), 2)
    kind[hits < 3.5] = 1
    kind[hits < 2.5] = 0
    kind[hits < 1.5] = 3
    kind[found.measures["sticks_left"] + found.measures["sticks_right"] > 0] = 4
    kind[found.exponents[:, 0] > 0.005] = 5
    kind[hits == 0] = 6
    figure = Figure(figsize=(10.0, 4.8), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    colours = ListedColormap([colour for _, colour in KINDS])
    left.pcolormesh(A, mu, kind.reshape(ROWS, COLUMNS), cmap=colours, vmin=-0.5, vmax=6.5, rasterized=True)
    ratio = found.measures["kinetic_ratio"].reshape(ROWS, COLUMNS)
    shown = right.pcolormesh(A, mu, ratio, norm=LogNorm(1e-3, 1), cmap="magma", rasterized=True)
    figure.colorbar(shown, ax=right, label="$K_2/K_1$", extend="both")
    for ax in (left, right):
        ax.set(xscale="log", yscale="log", xlabel="A")
    left.set_ylabel(r"$\mu$")
    left.set_title("reached from rest after 300 periods", fontsize=9)
    right.set_title(f"{len(a):,} points, Omega = 1, r = .65, lam = .012", fontsize=9)
    handles = [Patch(color=colour, label=name) for name, colour in KINDS]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=8, frameon=False)
    figure.savefig(FOLDER / "dynamics_regimes.png", dpi=110)


if __name__ == "__main__":
    wanted = sys.argv[1:] or ["error", "regimes"]
    FOLDER.mkdir(exist_ok=True)
    if "error" in wanted:
        error_against_periods()
    if "regimes" in wanted:
        regime_map()
