"""The misprints of the paper (docs/errata.md): the printed formula fails, the corrected one holds to 40 digits.

The appendix is implemented twice, as printed and as corrected, and both are compared with differences of a map that is
written down independently of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import mpmath as mp
import numpy as np
import pytest

from vines.dynamics import P1, P2, P3, P4, jacobian
from vines.model import Params
from vines.orbits import find_orbit

P = Params(mu=0.1, A=0.3, Omega=1.2, r=0.65, lam=0.2)
# v1, v2, x2, t just before an impact on `side`, and about the flight time to the next one on `side_next`.
STARTS = {
    "P1": (1, -1, ("0.3", "-0.8", "-0.7", "0.4"), 2.3),
    "P2": (-1, 1, ("-0.3", "0.8", "0.7", "3.0"), 2.3),
    "P3": (1, 1, ("-0.3", "-0.8", "-1.3", "3.3"), 2.12),
    "P4": (-1, -1, ("0.3", "0.8", "1.3", "0.68"), 2.12),
}
PHI = "0.25"
Z = ("v1", "v2", "x2", "t")


def m(text):
    return mp.mpf(text)


@dataclass
class Setting:
    """Everything the appendix speaks of, in the paper's letters, t_{k-1} = t and t_k = T in absolute time."""

    side: int
    side_next: int
    start: list

    def __post_init__(self):
        self.mu, self.A, self.O, self.r, self.lam = (m(repr(v)) for v in P.as_dict().values())
        self.phi = m(PHI)
        self.g = mp.sqrt(1 - self.lam**2 / 4)
        D = (1 - self.O**2) ** 2 + (self.lam * self.O) ** 2
        self.b1 = (self.A * (1 - self.O**2) + self.A * (self.lam * self.O) ** 2) / D
        self.b2 = ((1 - self.O**2) * self.A * self.lam * self.O - self.lam * self.O * self.A) / D

    def after(self, v1, v2):
        """(12)."""
        mu, r = self.mu, self.r
        return ((1 - r * mu) * v1 + mu * (1 + r) * v2) / (1 + mu), ((1 + r) * v1 + (mu - r) * v2) / (1 + mu)

    def forced(self, t):
        angle = self.O * t + self.phi
        s, c = mp.sin(angle), mp.cos(angle)
        return self.b1 * s + self.b2 * c, self.O * (self.b1 * c - self.b2 * s)

    def coefficients(self, v1p, x1, t):
        """a1, a2 from the linear system (21) with a given second entry v1p on its right-hand side."""
        e, s, c = mp.exp(-self.lam * t / 2), mp.sin(self.g * t), mp.cos(self.g * t)
        M = mp.matrix([[e * s, e * c], [e * (-self.lam / 2 * s + self.g * c), e * (-self.lam / 2 * c - self.g * s)]])
        xp, vp = self.forced(t)
        return mp.lu_solve(M, mp.matrix([x1 - xp, v1p - vp]))

    def oscillator(self, a, t):
        """(17), (18)."""
        e, s, c = mp.exp(-self.lam * t / 2), mp.sin(self.g * t), mp.cos(self.g * t)
        xp, vp = self.forced(t)
        x = e * (a[0] * s + a[1] * c) + xp
        v = e * (a[0] * (-self.lam / 2 * s + self.g * c) + a[1] * (-self.lam / 2 * c - self.g * s)) + vp
        return x, v

    def map(self, v1, v2, x2, t, near):
        x1 = x2 + self.side
        v1p, v2p = self.after(v1, v2)
        a = self.coefficients(v1p, x1, t)
        T = mp.findroot(lambda T: self.oscillator(a, T)[0] - x2 - v2p * (T - t) - self.side_next, t + near)
        return [self.oscillator(a, T)[1], v2p, x2 + v2p * (T - t), T]


def differences(setting, near):
    h = mp.mpf(10) ** -24
    J = mp.matrix(4, 4)
    for j in range(4):
        up, down = list(setting.start), list(setting.start)
        up[j] += h
        down[j] -= h
        for i, (a, b) in enumerate(zip(setting.map(*up, near), setting.map(*down, near), strict=True)):
            J[i, j] = (a - b) / (2 * h)
    return J


ITEMS = ("A.2", "A.6", "A.7", "A.9", "A.10")


def appendix(setting, near, printed=()):
    """The Jacobian by (A.1)–(A.10), corrected except for the items named in `printed`."""
    mu, r, lam, g, W, b1, b2 = (getattr(setting, n) for n in ("mu", "r", "lam", "g", "O", "b1", "b2"))
    v1, v2, x2, t = setting.start
    x1 = x2 + setting.side
    T = setting.map(v1, v2, x2, t, near)[3]
    v1p, R = setting.after(v1, v2)
    S, C, E = mp.sin(g * t), mp.cos(g * t), mp.exp(lam * t / 2)
    sin, cos = mp.sin(W * t + setting.phi), mp.cos(W * t + setting.phi)

    bad = "A.7" in printed
    X = x1 - b1 * sin + (b2 if bad else -b2) * cos
    V = v1p - b1 * W * cos + (-b2 if bad else b2) * W * sin
    pre = (E**2 if bad else E) / -g
    a1 = pre * ((-lam / 2 * C - g * S) * X - C * V)
    a2 = pre * ((lam / 2 * S - g * C) * X + S * V)

    F = E**2 if "A.9" in printed else E
    keep, passed = (1 - r * mu) / (1 + mu), mu * (1 + r) / (1 + mu)
    last = C - lam / (2 * g) * (C if "A.9" in printed else S)
    da1 = {"v1": F / g * keep * C, "v2": F / g * passed * C, "x2": F * (S + lam / (2 * g) * C)}
    da2 = {"v1": -F / g * keep * S, "v2": -F / g * passed * S, "x2": F * last}
    if "A.10" in printed:
        X = x1 - b1 * sin + b2 * cos
        V = v1p - b1 * W * cos - b2 * W * sin
        inner = (
            (-lam / 2 * C - g * S) * (-b1 * W * cos - b2 * W * sin)
            + (lam * g / 2 * S - g**2 * C) * X
            + g * S * V
            - C * (b1 * W**2 * sin - b2 * W**2 * cos)
        )
        da1["t"], da2["t"] = lam * a1 - E**2 / g * inner, lam * a2 - E**2 / g * inner
    else:
        X, V = x1 - b1 * sin - b2 * cos, v1p - b1 * W * cos + b2 * W * sin
        Xt, Vt = -b1 * W * cos + b2 * W * sin, b1 * W**2 * sin + b2 * W**2 * cos
        da1["t"] = lam / 2 * a1 - E / g * (
            (-lam / 2 * C - g * S) * Xt + (lam * g / 2 * S - g**2 * C) * X + g * S * V - C * Vt
        )
        da2["t"] = lam / 2 * a2 - E / g * (
            (lam / 2 * S - g * C) * Xt + (lam * g / 2 * C + g**2 * S) * X + g * C * V + S * Vt
        )

    e, s, c = mp.exp(-lam * T / 2), mp.sin(g * T), mp.cos(g * T)
    sinT, cosT = mp.sin(W * T + setting.phi), mp.cos(W * T + setting.phi)
    h = e * (2 * g * a1 - lam * a2) / 2 * c - e * (lam * a1 + 2 * g * a2) / 2 * s + b1 * W * cosT - b2 * W * sinT
    j1, j2 = e * (-lam / 2 * s + g * c), e * (-lam / 2 * c - g * s)
    mixed = 0 if "A.6" in printed else -4 * a1 * g * lam
    j3 = (
        (a1 * lam**2 - 4 * a1 * g**2 + 4 * a2 * lam * g) / 4 * e * s
        + (mixed + a2 * lam**2 - 4 * a2 * g**2) / 4 * e * c
        - b1 * W**2 * sinT
        - b2 * W**2 * cosT
    )
    dR = {"v1": (1 + r) / (1 + mu), "v2": (mu - r) / (1 + mu)}
    ez = {"v1": dR["v1"] * (T - t), "v2": dR["v2"] * (T - t), "x2": mp.mpf(1), "t": -R}
    dT = {z: (ez[z] - e * (s * da1[z] + c * da2[z])) / (h - R) for z in Z}
    J = mp.matrix(4, 4)
    for k, z in enumerate(Z):
        J[0, k] = dT[z] * j3 + da1[z] * j1 + da2[z] * j2
        J[1, k] = dR.get(z, mp.mpf(0))
        J[2, k] = ez[z] + R * (dT["v2"] if z == "x2" and "A.2" in printed else dT[z])
        J[3, k] = dT[z]
    return J


def error(J, exact):
    return max(abs(a - b) for a, b in zip(J, exact, strict=True)) / max(abs(b) for b in exact)


@pytest.fixture(params=STARTS)
def case(request):
    side, side_next, start, near = STARTS[request.param]
    with mp.workdps(80):
        yield request.param, Setting(side, side_next, [m(v) for v in start]), near


def test_the_corrected_appendix_holds_to_forty_digits(case):
    _, setting, near = case
    # The differences have a step of 1e-24, hence an error of about 1e-46 of their own.
    assert error(appendix(setting, near), differences(setting, near)) < mp.mpf(10) ** -40


@pytest.mark.parametrize("item", ITEMS)
def test_each_printed_formula_of_the_appendix_fails(case, item):
    _, setting, near = case
    assert error(appendix(setting, near, {item}), differences(setting, near)) > 1e-3


def test_the_appendix_as_printed_fails_as_a_whole(case):
    _, setting, near = case
    assert error(appendix(setting, near, ITEMS), differences(setting, near)) > 0.1


def test_the_public_maps_agree_with_the_corrected_equations(case):
    name, setting, near = case
    state = [float(v) for v in setting.start]
    v1, v2, x2, t = state
    ours = {"P1": P1, "P2": P2, "P3": P3, "P4": P4}[name](P, (x2 + setting.side, v1, x2, v2, t), phi=float(PHI))
    v1n, v2n, x2n, tn = (float(v) for v in setting.map(*setting.start, near))
    np.testing.assert_allclose(ours.state, [x2n + setting.side_next, v1n, x2n, v2n, tn], rtol=0, atol=1e-14)
    exact = np.array(differences(setting, near).tolist(), dtype=float)
    np.testing.assert_allclose(ours.jacobian, exact, rtol=0, atol=1e-13 * np.abs(exact).max())
    tau = ours.state[4] - t
    saltation = jacobian(
        P, setting.side, setting.side_next, (x2 + setting.side, v1, x2, v2), P.Omega * t + float(PHI), tau
    )
    np.testing.assert_allclose(ours.jacobian, saltation, rtol=0, atol=1e-12)


def test_equation_21_needs_the_velocity_after_the_impact(case):
    """The printed second row, [(1 - r) v1 + 2 mu v2]/(1 + mu), does not give the motion after (12)."""
    _, setting, _ = case
    v1, v2, x2, t = setting.start
    printed = ((1 - setting.r) * v1 + 2 * setting.mu * v2) / (1 + setting.mu)
    for v1p, holds in ((setting.after(v1, v2)[0], True), (printed, False)):
        a = setting.coefficients(v1p, x2 + setting.side, t)
        jump = setting.oscillator(a, t)[1] - v1
        # Momentum is kept: the oscillator's jump is -mu times that of the ball.
        lost = abs(jump + setting.mu * (setting.after(v1, v2)[1] - v2))
        assert (lost < mp.mpf(10) ** -45) == holds


@pytest.mark.parametrize(("name", "printed"), [("P2", 1), ("P3", -1)])
def test_equation_22_has_the_sides_of_p2_and_p3_exchanged(name, printed):
    """The text wants x1 - x2 at k-1 to be 1 for P2 and -1 for P3; P2 begins on R and P3 on L."""
    side, _, start, _ = STARTS[name]
    v1, v2, x2, t = (float(v) for v in start)
    assert printed == -side
    apply = {"P2": P2, "P3": P3}[name]
    apply(P, (x2 + side, v1, x2, v2, t), phi=float(PHI))
    with pytest.raises(Exception, match="the gap x1 - x2"):
        apply(P, (x2 + printed, v1, x2, v2, t), phi=float(PHI))


def test_equations_37_to_39_on_a_2_1_orbit():
    """(37), (38): the ball flies for t_{k+2} - t_{k+1}, not t_{k+1} - t_k; (39): the orbit closes on L, gap +1."""
    orbit = find_orbit("LLR", Params(mu=0.01, A=0.023))
    # The paper's order is L (k-1), R (k), L (k+1), and L again (k+2 = k-1 one period later).
    one, two, three = 1, 2, 0
    t = np.array([orbit.t[one], orbit.t[two], orbit.t[three] + orbit.period, orbit.t[one] + orbit.period])
    assert orbit.side[[one, two, three]].tolist() == [1, -1, 1]
    x2, v2_after = orbit.states[:, 2], orbit.impacts["v2_after"]
    assert x2[three] + v2_after[three] * (t[3] - t[2]) == pytest.approx(x2[one], abs=1e-13)
    assert abs(x2[three] + v2_after[three] * (t[2] - t[1]) - x2[one]) > 0.1
    assert orbit.states[one, 0] - x2[one] == pytest.approx(1, abs=1e-14)


def test_equation_35_is_printed_with_numerators_and_denominators_mixed_up():
    """The Jacobian has the image in its rows and the argument in its columns; only so does it predict a change."""
    side, _, start, _ = STARTS["P1"]
    v1, v2, x2, t = (float(v) for v in start)
    base = P1(P, (x2 + side, v1, x2, v2, t), phi=float(PHI))
    step = 1e-6 * np.array([1.0, -2.0, 0.5, 1.5])
    d1, d2, dx, dt = step
    moved = P1(P, (x2 + dx + side, v1 + d1, x2 + dx, v2 + d2, t + dt), phi=float(PHI))
    change = (moved.state - base.state)[[1, 3, 2, 4]]
    np.testing.assert_allclose(base.jacobian @ step, change, rtol=0, atol=1e-10)
    assert np.abs(base.jacobian.T @ step - change).max() > 1e-7
