"""Decay without forcing: a value made by another program, closed forms without impacts, and where times must lie."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from vines.dynamics import decay, simulate
from vines.errors import StateError
from vines.model import Params
from vines.systems import ImpactPair, Parallel


def test_the_check_value_of_the_prototypes():
    # systems-check-values.md, a-tet
    found = decay(simulate(Params(mu=0.02, A=0.0), v1=2.0, v2=0.0, periods=20))
    assert found.impacts == 54
    assert math.isclose(found.energy * found.impact_share, 0.718833300114, abs_tol=1e-12)
    assert math.isclose(found.frame_share, 0.072018162476, abs_tol=1e-12)
    total = found.impact_share + found.damper_share + found.frame_share + found.ball_share
    assert math.isclose(total, 1.0, abs_tol=1e-13)


def test_without_impacts_the_oscillator_alone_decays_by_its_closed_form():
    p = Params(mu=0.01, A=0.0, lam=0.05)
    V = 0.9
    found = decay(simulate(p, v1=V, v2=0.0, periods=40))
    gamma = math.sqrt(1 - p.lam**2 / 4)

    def share(t):
        x = V * math.exp(-p.lam * t / 2) * math.sin(gamma * t) / gamma
        v = V * math.exp(-p.lam * t / 2) * (math.cos(gamma * t) - p.lam / (2 * gamma) * math.sin(gamma * t))
        return (x * x + v * v) / V**2

    grid = np.linspace(0, 200, 20001)
    for level, ours in zip((0.1, 0.01), found.times, strict=True):
        k = next(k for k, t in enumerate(grid) if share(t) <= level)
        exact = brentq(lambda t, level=level: share(t) - level, grid[k - 1], grid[k], xtol=1e-14)
        assert math.isclose(ours, exact, rel_tol=1e-11)
    assert (found.impacts, found.impact_share) == (0, 0.0)
    assert math.isnan(found.first_impact)


@pytest.mark.parametrize("share", [0.9, 0.5, 0.2, 0.05])
def test_just_before_the_time_more_is_left_and_after_it_no_more(share):
    run = simulate(Params(mu=0.05, A=0.0, r=0.3), v1=3.0, v2=0.0, periods=60)
    at = decay(run, (share,)).times[0]
    samples = run.sample(times=[at * (1 - 1e-9), at * (1 + 1e-9)])
    energy = samples["kinetic_1"] + samples["kinetic_2"] + samples["potential"]
    assert energy[0] > share * 4.5 >= energy[1]


def test_what_does_not_decay_is_refused_in_one_line():
    with pytest.raises(StateError, match=r"A is 0\.02; energy decays where nothing drives"):
        decay(simulate(Params(mu=0.02, A=0.02), periods=2))
    with pytest.raises(StateError, match="nothing moves at the start"):
        decay(simulate(Params(mu=0.02, A=0.0), v2=0.0, periods=2))
    with pytest.raises(StateError, match="has no oscillator of its own"):
        decay(simulate(ImpactPair(B=0.5), periods=2))


@pytest.mark.parametrize("G", [0.02, -0.02])
def test_a_tilted_system_decays_to_balls_on_their_lower_ends(G):
    mu, beta, V = (0.012, 0.008), (1.0, 1.4), 1.5
    run = simulate(Parallel(mu=mu, beta=beta, A=0.0, G=G), v1=V, v2=[0.0, 0.0], periods=300)
    found = decay(run)
    # above rest: the balls in the middle by mu |G| beta, the oscillator by its way down under their weight
    exact = 0.5 * V**2 + 0.5 * (G * sum(mu)) ** 2 + abs(G) * sum(m * b for m, b in zip(mu, beta, strict=True))
    assert math.isclose(found.energy, exact, rel_tol=1e-12)
    shares = (found.impact_share, found.damper_share, found.frame_share, found.ball_share)
    assert math.isclose(sum(shares), 1.0, rel_tol=1e-12)
    assert min(shares) >= -1e-15
    assert found.frame_share + found.ball_share < 1e-9
    assert found.times[0] < found.times[1]
    side = math.copysign(1.0, G)
    for number, length in enumerate(beta, start=1):
        assert math.isclose(run.final["x1"] - run.final[f"x2_{number}"], side * length, abs_tol=1e-12)
