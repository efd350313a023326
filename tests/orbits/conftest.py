"""An independent model of flight and impact, in plain numpy or in mpmath, against which the package is checked."""

from types import SimpleNamespace

import mpmath as mp
import numpy as np
import pytest


def fly(p, before, phase, tau, m=np):
    """Return x1, v1, x2, v2 at the end of a flight that begins with the impact of the state `before`.

    Works with numpy and, given ``m=mpmath``, in the precision that mpmath is set to.
    """
    x1, v1, x2, v2 = before
    mu, A, Omega, r, lam = (m.mpf(v) if m is mp else v for v in p.as_dict().values())
    v1, v2 = (
        ((1 - r * mu) * v1 + mu * (1 + r) * v2) / (1 + mu),
        ((1 + r) * v1 + (mu - r) * v2) / (1 + mu),
    )
    gamma = m.sqrt(1 - lam**2 / 4)
    # Forced response b1 sin + b2 cos by comparing coefficients in x'' + lam x' + x = A sin + lam Omega A cos.
    D = (1 - Omega**2) ** 2 + (lam * Omega) ** 2
    b1 = A * ((1 - Omega**2) + (lam * Omega) ** 2) / D
    b2 = A * (lam * Omega * (1 - Omega**2) - lam * Omega) / D

    def xp(a):
        return b1 * m.sin(a) + b2 * m.cos(a)

    def vp(a):
        return Omega * (b1 * m.cos(a) - b2 * m.sin(a))

    X, V = x1 - xp(phase), v1 - vp(phase)
    a2 = X
    a1 = (V + lam / 2 * X) / gamma
    e, s, c = m.exp(-lam * tau / 2), m.sin(gamma * tau), m.cos(gamma * tau)
    end = phase + Omega * tau
    return (
        e * (a1 * s + a2 * c) + xp(end),
        e * ((-lam / 2 * a1 - gamma * a2) * s + (-lam / 2 * a2 + gamma * a1) * c) + vp(end),
        x2 + v2 * tau,
        v2,
    )


def gap(p, before, phase, tau):
    """Return w at times tau after the impact."""
    x1, _, x2, _ = fly(p, before, phase, tau)
    return x1 - x2


def map_to(p, side, side_next, coordinates, guess):
    """Return (v1, v2, x2, t) just before the next impact, in mpmath; `guess` is the flight time."""
    v1, v2, x2, t = coordinates
    before = (x2 + side, v1, x2, v2)
    phase = mp.mpf(p.Omega) * t

    def miss(tau):
        x1, _, x2, _ = fly(p, before, phase, tau, mp)
        return x1 - x2 - side_next

    tau = mp.findroot(miss, guess)
    _, v1, x2, v2 = fly(p, before, phase, tau, mp)
    return [v1, v2, x2, t + tau]


@pytest.fixture(scope="session")
def independent():
    return SimpleNamespace(fly=fly, gap=gap, map_to=map_to)
