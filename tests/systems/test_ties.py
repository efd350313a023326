"""Balls of one length that hit together, and stick: by mechanics, whatever the simulator says of itself."""

from __future__ import annotations

import numpy as np
import pytest

import vines
from vines.dynamics.kernels import rows as col
from vines.systems import Parallel

BALL, TIES, BEFORE, X2 = col.ROW, col.ROW + 1, col.ROW + 2, col.ROW + 3
BALLS = [2, pytest.param(3, marks=pytest.mark.full), pytest.param(8, marks=pytest.mark.full)]


def tied(rng, balls):
    """Return a system whose balls have one length and one restitution, and a start in which they move as one.

    From there on only what is rounded parts them, and each time that they stick brings them together again.
    """
    p = Parallel(
        mu=rng.uniform(0.001, 0.1, balls), beta=1.0, r=float(rng.choice([0.0, 0.1, 0.3, 0.5, 0.65, 0.9, 1.0])),
        A=10 ** rng.uniform(-2.5, 0.7), Omega=float(rng.choice([0.4, 0.6, 1.0, 1.3])),
        G=float(rng.choice([0.0, 0.0, 0.01, 0.1])),
    )  # fmt: skip
    # Together to the bit, an ulp apart, or on a wall at rest.
    apart = rng.integers(-1, 2, balls) * np.spacing(0.1)
    start = {"v1": float(rng.choice([0.0, 2.0])), "v2": tuple(0.1 + apart)}
    if rng.random() < 0.3:
        start = {"x2": (float(rng.choice([-1.0, 1.0])),) * balls, "v2": (0.0,) * balls}
    return p, start


def check_instants(p, rows):
    """Hold what happens at each instant to mechanics; return how many ties and how many merges there were."""
    mu, n = np.array(p.mu), p.balls
    ties = merges = 0
    velocities = np.append(rows[0, col.A_V1], rows[0, X2 + 1 : X2 + 2 * n : 2])
    k = 1
    while k < len(rows):
        last = k
        while last + 1 < len(rows) and rows[last + 1, col.TAU] == 0.0 and rows[last + 1, col.KIND] != col.END:
            last += 1
        kinds = rows[k : last + 1, col.KIND]
        if (kinds == col.IMPACT).any() or (kinds == col.STICK).any():
            # Free balls keep their velocity until then, but for gravity; the frame's, and that of riders, is told.
            before = np.where(riders(rows[k, BEFORE], n), rows[k, col.V1], velocities[1:] - p.G * rows[k, col.TAU])
            after = np.append(rows[last, col.A_V1], rows[last, X2 + 1 : X2 + 2 * n : 2])
            momentum = (rows[k, col.V1] - after[0]) + mu @ (before - after[1:])
            size = 1.0 + abs(rows[k, col.V1]) + np.abs(before).max()
            assert abs(momentum) < 1e-13 * size
            lost = rows[k, col.V1] ** 2 - after[0] ** 2 + mu @ (before**2 - after[1:] ** 2)
            assert lost > -1e-13 * size**2
            # Nobody who was struck, or rides, goes on towards the wall.
            own = {int(row[BALL]) - 1: row[col.SIDE] for row in rows[k : last + 1]}
            on = np.array(list(own))
            side = np.array(list(own.values()))
            assert (side * (after[0] - after[1:][on])).max() <= 1e-13 * size
        ties += (rows[k : last + 1, TIES] > 0).any()
        merges += (kinds == col.STICK).any()
        velocities = np.append(rows[last, col.A_V1], rows[last, X2 + 1 : X2 + 2 * n : 2])
        k = last + 1
    return ties, merges


def riders(modes, balls):
    return abs(int(modes)) >> np.arange(balls) & 1 == 1


@pytest.mark.parametrize("balls", BALLS)
def test_ties_with_sticking_keep_momentum_and_go_on(balls):
    """Random starts: no run ends at a cap, each instant keeps momentum and loses energy, nobody leaves its cavity."""
    rng = np.random.default_rng(balls)
    ties = merges = 0
    for _ in range(60):
        p, start = tied(rng, balls)
        run = vines.simulate(p, periods=12, **start)
        assert run.status == "complete", (p, start)
        found = check_instants(p, run.rows)
        ties, merges = ties + found[0], merges + found[1]
        measures = run.measures()
        assert abs(measures.balance) < 1e-12 * (1.0 + abs(measures.base_work))
        at = run.sample(600)
        size = 1.0 + np.abs(at["x1"]).max()
        assert max(np.abs(at[f"w_{k}"]).max() for k in range(1, balls + 1)) <= 1 + 1e-13 * size
    assert ties > 150
    assert merges > 150


def test_a_tie_of_unequal_masses_that_stick_does_not_end_the_run():
    """Runs like this ended at the cap of impacts once: balls on one wall chattered in hops of 1e-15 of each other."""
    p = Parallel(mu=(0.015, 0.005), beta=(1.0, 1.0), A=0.012340677254400193)
    for start in ({"v2": (1.0, 0.0)}, {"v1": 2.0}, {"v1": 2.0, "v2": (0.0, 1e-9)}, {"v2": (0.1, 0.1)}):
        run = vines.simulate(p, periods=1000, **start)
        assert run.status == "complete"
        assert abs(run.measures().balance) < 1e-12
    assert run.measures().ties > 0
