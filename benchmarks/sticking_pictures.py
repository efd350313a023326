"""The pictures of docs/sticking.md: ``python -m benchmarks.sticking_pictures``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from vines.attractors import classify_many, settle, settle_from
from vines.model import Params
from vines.orbits import continue_orbit, find_orbit, follow_end

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "pictures"
CASE = Params(mu=0.0256654, A=0.965717, Omega=1.02946, r=0.347164, lam=0.0959532)
INK, STICKS, OTHER = "#222222", "#c8102e", "#8fa7bf"


def simulated(values: np.ndarray) -> list[tuple[float, bool, np.ndarray, np.ndarray]]:
    """Return amplitude, whether it is L*R*, phases of the impacts on L and of the last periods, carried downwards."""
    found = []
    last = None
    for A in values:
        p = CASE.replace(A=float(A))
        last = settle(p, lyapunov=False) if last is None else settle_from(p, last.final, settle=200, lyapunov=False)
        hits = last.impacts[last.impacts["side"] > 0]
        recent = hits[hits["t"] > hits["t"].max() - 16 * p.period]
        found.append((float(A), last.word == "L*R*", recent["phase"], recent["w_dot"]))
    return found


def branch_picture() -> None:
    """Draw the 1:1 branch that sticks over the amplitude, with its end, above and below it what the simulator shows."""
    orbit = find_orbit("L*R*", CASE)
    down, up = continue_orbit(orbit, "A", 0.3), continue_orbit(orbit, "A", 1.2)
    orbits = [*reversed(down.orbits), *up.orbits[1:]]
    A = np.array([each.params.A for each in orbits])
    end = down.bifurcations[-1]
    figure = Figure(figsize=(6.8, 7.2), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True)
    for value, sticks, phase, speed in simulated(np.linspace(1.2, 0.3, 226)):
        colour = STICKS if sticks else OTHER
        axes[0].plot(np.full(len(phase), value), phase, ".", ms=1.6, color=colour)
        axes[1].plot(np.full(len(speed), value), speed, ".", ms=1.6, color=colour)
    left = [each.spells[each.spells["side"] > 0][0] for each in orbits]
    contact = [float(each.phase[0]) for each in orbits]
    axes[0].plot(A, contact, color=INK, lw=1.2, label="first impact")
    axes[0].plot(A, [s["phase_start"] for s in left], color=INK, lw=1.2, ls="--", label="chatter complete")
    axes[0].plot(A, [s["phase_release"] for s in left], color=INK, lw=1.2, ls=":", label="release")
    axes[0].set_ylabel("phase on L [rad]")
    axes[0].set_ylim(0, 2.9)
    axes[0].legend(fontsize=7, loc="upper right", ncols=3)
    axes[1].plot(A, [each.w_dot[0] for each in orbits], color=INK, lw=1.2)
    axes[1].set_ylabel("w' at impacts on L")
    axes[2].plot(A, [abs(each.half_multipliers[0]) for each in orbits], color=INK, lw=1.2, label="|m| of the half map")
    axes[2].plot(A, [s["t_release"] - s["t_start"] for s in left], color=STICKS, lw=1.2, label="length of the stick")
    axes[2].set_ylim(0, None)
    axes[2].legend(fontsize=7, loc="lower right")
    axes[2].set_xlabel("A")
    for ax in axes:
        ax.axvline(end.value, color=INK, lw=0.6, ls=(0, (1, 2)))
    axes[0].set_title(f"L*R*, chatter complete from A = {end.value:.7f} on; simulation red where it sticks", fontsize=9)
    figure.savefig(FOLDER / "sticking_branch.png", dpi=130)


def map_picture() -> None:
    """Draw the bounds of 1:1 that sticks over the simulated map of (A, mu)."""
    base = Params(mu=0.01, A=1.0, Omega=1.0, r=0.65)
    A, mu = np.geomspace(0.05, 1.0, 160), np.geomspace(0.001, 1.0, 120)
    grid = [base.replace(A=float(a), mu=float(m)) for m in mu for a in A]
    found = classify_many(grid, settle=200, watch=64)
    kind = np.zeros(len(grid), dtype=int)
    for k in range(len(grid)):
        each = found.attractor(k)
        one = each.regime == "periodic" and each.name == "1:1"
        kind[k] = 3 if one and each.word == "L*R*" else 2 if one else 1 if each.recurrent_sticking else 0
    figure = Figure(figsize=(6.6, 4.8), layout="constrained")
    ax = figure.add_subplot()
    colours = ListedColormap(["#ffffff", "#e3d6c3", "#a9c8e6", "#2b5d8c"])
    ax.pcolormesh(A, mu, kind.reshape(len(mu), len(A)), cmap=colours, vmin=-0.5, vmax=3.5, shading="nearest")
    inside = find_orbit("L*R*", base.replace(mu=float(mu[0])))
    ends = follow_end(inside, "A", 0.05, other="mu", values=np.geomspace(mu[0], mu[-1], 140).tolist())
    ax.plot([end.params.A for end in ends], [end.params.mu for end in ends], color=STICKS, lw=1.4)
    ax.set(xscale="log", yscale="log", xlabel="A", ylabel="mu", xlim=(A[0], A[-1]), ylim=(mu[0], mu[-1]))
    ax.set_title(
        "Dark: 1:1 that sticks; blue: 1:1 without; brown: other recurrent sticking. Red: end of L*R*", fontsize=8
    )
    figure.savefig(FOLDER / "sticking_bound.png", dpi=130)


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    branch_picture()
    map_picture()
