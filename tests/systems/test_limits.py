"""Limits that tie the systems to each other, where they are not tested with a system of their own."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

import vines
from tests.orbits.in_digits import Flown
from vines.orbits import continue_orbit, find_orbit
from vines.systems import CubicBarriers, Drag, Duffing, Friction, Hybrid, ImpactPair, Modes, Parallel

TWO = Parallel(mu=(0.01, 0.01), beta=(1.0, 1.4), A=0.03)


def test_a_ball_in_a_cavity_that_is_too_long_is_not_there():
    alone = vines.simulate(Parallel(mu=(0.01,), A=0.03), v2=0.1, periods=12)
    beside = vines.simulate(Parallel(mu=(0.01, 0.05), beta=(1.0, 1e6), A=0.03), v2=(0.1, 0.3), periods=12)
    assert len(alone.impacts) > 12
    for name in ("t", "side", "x1", "v1", "x2", "v2"):
        assert beside.impacts[name] == pytest.approx(alone.impacts[name], abs=1e-12)


@pytest.mark.parametrize(
    ("p", "word"), [(ImpactPair(B=0.6, r=0.5), "LR"), (Friction(mu=0.02, A=0.028, f=0.02), "LR"), (TWO, "L1L2R1R2")]
)
def test_tilted_the_other_way_it_is_the_mirror_image_and_level_the_limit(p, word):
    level = find_orbit(word, p)
    up, down = (find_orbit(word, p.replace(G=tilt), guess=level) for tilt in (1e-5, -1e-5))
    half = len(level.t) // 2
    assert np.roll(down.w_dot, half) == pytest.approx(-up.w_dot, abs=1e-11)
    assert (up.w_dot + down.w_dot) / 2 == pytest.approx(level.w_dot, abs=1e-8)


@pytest.mark.parametrize(
    "p",
    [
        Parallel(mu=(0.05, 0.02), beta=(1.0, 0.7), r=1.0, A=0.0, lam=0.0),
        Parallel(mu=(0.05, 0.02), r=1.0, A=0.0, lam=0.0, G=0.01),
        Drag(mu=0.05, A=0.0, r=1.0, lam=0.0, delta=0.0),
        Friction(mu=0.05, A=0.0, r=1.0, lam=0.0, f=0.0, G=0.01),
        CubicBarriers(mu=0.05, A=0.0, r=1.0, lam=0.0, k3=0.5),
        Duffing(mu=0.05, A=0.0, r=1.0, lam=0.0, alpha=0.5),
        Hybrid(mu=0.05, A=0.0, r=1.0, lam=0.0, mu_n=0.03, k1=0.5, k3=0.5),
        Modes(mu=0.05, A=0.0, r=1.0, lam=0.0, omega=(1.0, 2.2), phi=(0.9, 0.5), gamma=(0.8, 0.3)),
    ],
)
def test_without_forcing_and_losses_energy_stays(p):
    run = vines.simulate(p, x1=0.0, v1=1.5, periods=30)
    assert len(run.impacts) > 30
    found = run.measures()
    assert (found.base_work, found.damper_loss, found.travel_loss) == (0.0, 0.0, 0.0)
    assert found.impact_loss == pytest.approx(0.0, abs=1e-12)
    assert found.energy_change == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("kind", "stop"), [("symmetry_breaking", 0.08), ("neimark_sacker", 0.01), ("fold", 0.01)])
def test_bifurcations_of_two_balls_satisfy_their_equations_in_30_digits(kind, stop):
    orbit = find_orbit("L1L2R1R2", TWO)
    found = next(each for each in continue_orbit(orbit, "A", stop).bifurcations if each.type == kind)
    with mp.workdps(30):
        off, value = Flown(found.orbit, half=found.orbit.symmetric).condition(kind)
    assert off < 1e-11
    assert abs(value) < 1e-10
