"""The ball's motion and momentum at impacts, against a 1:1 orbit in closed form; restitution by Monte Carlo."""

from dataclasses import fields

import numpy as np
import pytest

import vines
from vines.rig import Uncertain
from vines.rig.ball._ball import Cavity, Course, ball_motion
from vines.rig.ball._momentum import fit_momentum
from vines.rig.ball._restitution import restitution
from vines.rig.fit._jumps import Jumps

P = vines.Params(mu=0.0084, A=0.015)
B, OMEGA0, PERIODS = 0.015, 55.39, 40


def noisy(jumps, u, rng, shape=()):
    """Return states of the oscillator with errors of standard deviation u times that of each of them."""
    parts = {field.name: getattr(jumps, field.name) for field in fields(Jumps)}
    sizes = {"t": 0.0, "x": 1e-6, "v_before": 1e-4, "v_after": 1e-4}
    return Jumps(**{
        name: part + u * sizes[name] * rng.normal(size=(*shape, len(part))) for name, part in parts.items()
    })  # fmt: skip


KNOWN = {"friction": Uncertain(0.0, 0.01), "tilt": Uncertain(0.0, 1e-5), "touch": Uncertain(0.0, 1e-6)}


def straight(side):
    """Return the course of flights without friction between hard walls."""
    return Course(np.zeros(len(side) - 1), np.zeros(len(side) - 1), np.zeros(len(side)))


@pytest.fixture(scope="module")
def orbit():
    """Return impacts of the symmetric 1:1 orbit over many periods, in SI units, and the orbit itself."""
    found = vines.find_orbit("LR", P)
    t = (found.t + 2 * np.pi / P.Omega * np.arange(PERIODS)[:, None]).ravel() / OMEGA0
    x1, v1, _, v2, side = np.tile(np.vstack([found.states.T, found.side]), PERIODS)
    gain = (1 + P.r) * (v1 - v2) / (1 + P.mu)
    speed = B * OMEGA0
    jumps = Jumps(t, B * x1, speed * v1, speed * (v1 - P.mu * gain))
    return jumps, side, speed * v2, speed * (v2 + gain)


def test_the_balls_motion_is_that_of_the_orbit(orbit):
    jumps, side, v2, v2_after = orbit
    ball = ball_motion(jumps, side, Cavity(B))
    np.testing.assert_allclose(ball.v2_before, v2[1:-1], rtol=1e-9)
    np.testing.assert_allclose(ball.v2_after, v2_after[1:-1], rtol=1e-9)
    np.testing.assert_allclose(ball.r, P.r, rtol=1e-9)


def test_friction_slows_a_flight_from_wall_to_wall():
    """A ball that loses speed at a constant rate: its velocities at both ends of a flight, by hand."""
    friction, tilt, time, start = 0.05, 0.01, 0.06, 0.6
    end = start + (tilt - friction) * time
    x2 = np.array([0.0, start * time + 0.5 * (tilt - friction) * time**2])
    b = 0.5 * (x2[1] - x2[0])
    jumps = Jumps(
        np.array([-1.0, 0.0, time, time + 1]), np.array([0.0, x2[0] + b, x2[1] - b, 0.0]), np.zeros(4), np.zeros(4)
    )
    ball = ball_motion(jumps, np.array([-1.0, 1.0, -1.0, 1.0]), Cavity(b, friction, tilt))
    assert ball.v2_after[0] == pytest.approx(start, rel=1e-12)
    assert ball.v2_before[1] == pytest.approx(end, rel=1e-12)


def test_mu_from_b_and_b_from_mu(orbit):
    jumps, side, *_ = orbit
    draws = noisy(jumps, 1.0, np.random.default_rng(0), (64,))
    by_gauge = fit_momentum(jumps, draws, side, straight(side), mu=None, b=Uncertain(B, 1e-7), **KNOWN)
    assert by_gauge.mu.value == pytest.approx(P.mu, rel=1e-5)
    gauged = Uncertain(1.02 * B, 1e-3)
    by_scales = fit_momentum(jumps, draws, side, straight(side), mu=Uncertain(P.mu, 1e-8), b=gauged, **KNOWN)
    assert by_scales.b.value == pytest.approx(B, rel=2e-4)
    assert by_scales.good.all()


def test_stated_uncertainty_of_mu_is_that_of_the_noise(orbit):
    jumps, side, *_ = orbit
    rng = np.random.default_rng(5)
    found = []
    for _ in range(60):
        seen = noisy(jumps, 1.0, rng)
        draws = noisy(seen, 1.0, rng, (64,))
        found.append(fit_momentum(seen, draws, side, straight(side), mu=None, b=Uncertain(B, 1e-7), **KNOWN).mu)
    errors = np.array([(one.value - P.mu) / one.u for one in found])
    assert abs(errors.mean()) < 0.5
    assert 0.6 < errors.std() < 1.3


@pytest.mark.parametrize(("spread", "exponent", "n"), [(0.0, 0.0, 60), (0.25, -0.1, 400)])
def test_restitution_its_exponent_and_scatter_are_unbiased(spread, exponent, n):
    rng = np.random.default_rng(17)
    r, sigma, runs = 0.65, 0.02, 150
    side = np.where(np.arange(n) % 2, 1.0, -1.0)
    rows = []
    for _ in range(runs):
        speed = 0.5 * np.exp(spread * rng.normal(size=n))
        u = rng.uniform(0.005, 0.03, n)
        mean = r * (speed / speed.mean()) ** exponent
        one = restitution(mean + sigma * rng.normal(size=n) + u * rng.normal(size=n), u, speed, side)
        rows.append((one.r - r, one.sigma_r / sigma - 1, one.exponent - exponent, one.u_sigma_r / sigma))
        assert one.n == n
    error, relative, power, stated = np.array(rows).T
    for values in (error, relative, power):
        assert abs(values.mean()) <= 4 * values.std() / np.sqrt(runs)
    assert np.median(stated) == pytest.approx(relative.std(), rel=0.25)


def test_what_a_sensor_does_to_left_and_right_is_no_scatter():
    rng = np.random.default_rng(2)
    side = np.where(np.arange(600) % 2, 1.0, -1.0)
    r = 0.65 + 0.01 * side + 0.005 * rng.normal(size=600)
    assert restitution(r, np.full(600, 1e-3), np.ones(600), side).sigma_r == pytest.approx(0.005, rel=0.1)
