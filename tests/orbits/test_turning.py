import numpy as np
from scipy.optimize import minimize_scalar

from vines.dynamics._flight import phasors
from vines.dynamics._room import constants
from vines.model import Params
from vines.orbits._turning import turning_points_kernel


def flight(rng, k):
    Omega = 1 + 1e-3 * rng.normal() if k % 3 == 0 else rng.uniform(0.3, 3)
    p = Params(mu=0.1, A=10 ** rng.uniform(-3, 0.5), Omega=Omega, lam=rng.uniform(0.001, 0.3))
    x, v, drift = rng.normal(size=3) * 10 ** rng.uniform(-2, 0.5)
    return p, x, v, drift, rng.uniform(0, 2 * np.pi), rng.uniform(0.1, 20)


def velocity(p, x, v, phase, t):
    """x1' of the flight, written afresh with complex exponentials."""
    s = complex(-p.lam / 2, np.sqrt(1 - p.lam**2 / 4))
    q = p.A * (p.lam * p.Omega - 1j) / (1 - p.Omega**2 + 1j * p.lam * p.Omega) * np.exp(1j * phase)
    zr = x - q.real
    z = complex(zr, (s.real * zr - (v + p.Omega * q.imag)) / s.imag)
    return (s * z * np.exp(s * t)).real - p.Omega * (q * np.exp(1j * p.Omega * t)).imag


def test_every_turning_point_of_random_flights_is_found():
    rng = np.random.default_rng(4)
    found = 0
    for k in range(1500):
        p, x, v, drift, phase, duration = flight(rng, k)
        c = constants(p)
        times = turning_points_kernel(c, phasors(c.free, p.Omega, x, v, phase), drift, duration)
        assert np.all(np.diff(times) > 0)
        assert np.all((times > 0) & (times < duration))
        dense = np.linspace(0, duration, 20001)
        rate = velocity(p, x, v, phase, dense) - drift
        scale = np.abs(rate).max()
        # Sampling sees a change of sign exactly where an odd number of zeros lies between two samples.
        changes = np.flatnonzero(np.diff(np.sign(rate)) != 0)
        seen = np.searchsorted(dense, times) - 1
        odd = [k for k in np.unique(seen) if np.sum(seen == k) % 2]
        assert list(changes) == odd
        assert np.all(np.abs(velocity(p, x, v, phase, times) - drift) < 1e-13 * max(scale, 1))
        found += len(times)
    assert found > 3000


def test_a_pair_of_turning_points_between_two_samples_is_found():
    # The drift is put a hair under a maximum of x1': two zeros of the rate 2e-5 apart.
    p = Params(mu=0.1, A=0.3, Omega=1.3)
    c = constants(p)
    t = np.linspace(1, 9, 4001)
    rough = t[1 + np.flatnonzero(np.diff(np.sign(np.diff(velocity(p, 0.2, 0.1, 0.7, t)))) < 0)[0]]
    top = minimize_scalar(
        lambda t: -velocity(p, 0.2, 0.1, 0.7, t), bounds=(rough - 0.1, rough + 0.1), options={"xatol": 1e-12}
    )
    z = phasors(c.free, p.Omega, 0.2, 0.1, 0.7)
    near = turning_points_kernel(c, z, -top.fun - 1e-10, 10.0)
    assert np.sum(np.abs(near - top.x) < 1e-4) == 2
    assert np.sum(np.abs(turning_points_kernel(c, z, -top.fun + 1e-10, 10.0) - top.x) < 1e-4) == 0
