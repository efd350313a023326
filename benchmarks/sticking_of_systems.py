"""Attractors that stick, of the systems with one ball beside the VI-NES, at random, each found as an orbit by its word.

Run as ``python -m benchmarks.sticking_of_systems [points] [seed] [system …]``. mu is drawn log-uniformly from .01 to
.5, A from .06 to 4, lam from .01 to .25, Omega uniformly from .5 to 1.6, r from .05 to .6; what else there is as `draw`
says. Of ``L*R*`` one in twenty counts. K2/K1 and the polynomial of the multipliers are compared with those of `settle`.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np

from vines.attractors import settle
from vines.orbits import all_orbits
from vines.systems import CubicBarriers, Drag, Duffing, Friction, Hybrid, Modes

SHARE = 0.05
TOLERANCE = 1e-8


def draw(system: type, rng: np.random.Generator) -> Any:
    """Return random parameters of a system."""
    common = {
        "mu": 10 ** rng.uniform(-2, -0.3),
        "A": 10 ** rng.uniform(-1.2, 0.6),
        "Omega": rng.uniform(0.5, 1.6),
        "r": rng.uniform(0.05, 0.6),
        "lam": 10 ** rng.uniform(-2, -0.6),
    }
    if system is Drag:
        return Drag(**common, delta=10 ** rng.uniform(-2, 0.3))
    if system is Friction:
        return Friction(**common, f=10 ** rng.uniform(-2.5, -0.3), G=float(rng.choice([0.0, 0.05])))
    if system is Duffing:
        return Duffing(**common, alpha=10 ** rng.uniform(-1.5, 0.7))
    if system is Hybrid:
        spring = {"k1": rng.uniform(-0.2, 1), "k3": 10 ** rng.uniform(-2, 1), "l2": 10 ** rng.uniform(-2, 0)}
        return Hybrid(**common, mu_n=10 ** rng.uniform(-2.5, -0.5), **spring)
    if system is Modes:
        omega = (1.0, *np.cumprod(rng.uniform(1.3, 3.0, rng.integers(1, 3))).tolist())
        phi, gamma = ((1.0, *rng.uniform(-1, 1, len(omega) - 1).tolist()) for _ in range(2))
        damping = common.pop("lam")
        return Modes(**common, omega=omega, phi=phi, gamma=gamma, lam=[damping * each for each in omega])
    return CubicBarriers(
        **common, k1=rng.uniform(-0.2, 0.3), k3=10 ** rng.uniform(-2, 0), l2=float(rng.choice([0, 0.1]))
    )


def study(system: type, points: int, seed: int) -> None:
    """Print what is found at random points, until so many attractors stick."""
    rng = np.random.default_rng(seed)
    met, longest, apart, wrong, times = 0, 0, 0.0, 0.0, []
    others = good = 0
    while met < points:
        p = draw(system, rng)
        attractor = settle(p, lyapunov=False, errors=False)
        word = str(attractor.word)
        if attractor.multipliers is None or "*" not in word or (word == "L*R*" and rng.random() > SHARE):
            continue
        met += 1
        others += word != "L*R*"
        began = time.process_time()
        found = all_orbits(word, p)
        times.append(time.process_time() - began)
        away, orbit = min(
            ((abs(each.measures.kinetic_ratio / attractor.measures.kinetic_ratio - 1), each) for each in found),
            key=lambda pair: pair[0],
            default=(np.inf, None),
        )
        if orbit is None or away > TOLERANCE:
            print(f"missed: {word} at {p}", flush=True)
            continue
        good += 1
        longest, apart = max(longest, orbit.word.p), max(apart, away)
        wrong = max(wrong, float(np.abs(np.poly(orbit.multipliers) - np.poly(attractor.multipliers)).max()))
    print(f"{system.__name__}: {good} of {met} found, {others} other than L*R*, up to {longest} periods")
    print(f"K2/K1 to {apart:.1g}, multipliers' polynomial to {wrong:.1g}")
    print(f"processor seconds a search: median {np.median(times):.2f}, largest {max(times):.1f}", flush=True)


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:3]]
    for each in (Drag, Friction, CubicBarriers, Duffing, Hybrid, Modes):
        if len(sys.argv) < 4 or each.__name__ in sys.argv[3:]:
            study(each, *(numbers + [40, 18][len(numbers) :]))
