"""The Jacobian of an impact map against 50-digit differences, and its determinant."""

from __future__ import annotations

import itertools

import mpmath as mp
import numpy as np
import pytest

from vines.dynamics import jacobian, simulate
from vines.errors import StateError
from vines.model import Params

WORKED = Params(mu=0.1, A=0.3, Omega=1.2)


def _map(p: Params, u: list[mp.mpf], side: int, side_next: int, phi: mp.mpf, near: float) -> list[mp.mpf]:
    """(v1, v2, x2, t) just before the next impact from the same just before this one."""
    v1, v2, x2, t = u
    mu, A, Omega, r, lam = (mp.mpf(value) for value in p.as_dict().values())
    x1 = x2 + side
    v1p = ((1 - r * mu) * v1 + mu * (1 + r) * v2) / (1 + mu)
    v2p = ((1 + r) * v1 + (mu - r) * v2) / (1 + mu)
    s = mp.mpc(-lam / 2, mp.sqrt(1 - lam**2 / 4))
    q = A * (lam * Omega - 1j) * mp.expj(phi + Omega * t) / (1 - Omega**2 + 1j * lam * Omega)
    zr = x1 - q.real
    z = mp.mpc(zr, (-lam / 2 * zr - Omega * q.imag - v1p) / s.imag)

    def x(tau: mp.mpf) -> mp.mpf:
        return (z * mp.exp(s * tau) + q * mp.expj(Omega * tau)).real

    tau = mp.findroot(lambda tau: x(tau) - x2 - v2p * tau - side_next, near)
    v = (s * z * mp.exp(s * tau) + 1j * Omega * q * mp.expj(Omega * tau)).real
    return [v, v2p, x2 + v2p * tau, t + tau]


@pytest.mark.parametrize("A", [0.015, 0.023, 0.3])
def test_it_agrees_with_differences_in_fifty_digits(A: float) -> None:
    p = Params(mu=0.01, A=A) if A < 0.1 else WORKED
    hits = simulate(p, periods=40).impacts[-5:]
    with mp.workdps(50):
        h = mp.mpf(10) ** -20
        for a, b in itertools.pairwise(hits):
            tau = float(b["t"] - a["t"])
            x2 = float(a["x1"]) - int(a["side"])
            start = [mp.mpf(float(a["v1"])), mp.mpf(float(a["v2"])), mp.mpf(x2), mp.mpf(0)]
            args = (int(a["side"]), int(b["side"]))
            differences = np.empty((4, 4))
            for j in range(4):
                up, down = list(start), list(start)
                up[j] += h
                down[j] -= h
                ahead = _map(p, up, *args, mp.mpf(float(a["phase"])), tau)
                behind = _map(p, down, *args, mp.mpf(float(a["phase"])), tau)
                differences[:, j] = [float((y - x) / (2 * h)) for x, y in zip(behind, ahead, strict=True)]
            before = (x2 + int(a["side"]), float(a["v1"]), x2, float(a["v2"]))
            ours = jacobian(p, *args, before, float(a["phase"]), tau)
            assert np.max(np.abs(ours - differences)) < 1e-11 * np.max(np.abs(differences))


def test_its_determinant_is_that_of_the_invariant() -> None:
    for p in (Params(mu=0.01, A=0.03), WORKED, Params(mu=0.5, A=1.0, Omega=0.6, r=0.9, lam=0.1)):
        hits = simulate(p, periods=60).impacts
        for a, b in itertools.pairwise(hits):
            if min(abs(a["w_dot"]), abs(b["w_dot"])) < 1e-2:
                continue
            tau = float(b["t"] - a["t"])
            before = tuple(float(a[name]) for name in ("x1", "v1", "x2", "v2"))
            J = jacobian(p, int(a["side"]), int(b["side"]), before, float(a["phase"]), tau)
            expected = p.r**2 * a["w_dot"] / b["w_dot"] * np.exp(-p.lam * tau)
            assert np.linalg.det(J) == pytest.approx(expected, rel=1e-8)


def test_states_off_the_wall_are_refused() -> None:
    with pytest.raises(StateError, match="before impact the gap"):
        jacobian(WORKED, 1, -1, (0.3, 0.3, -0.5, -0.8), 0.4, 2.0)
