"""The certificate of a whole move in lanes, against the same motion in 40 digits."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from vines.dynamics._lane_certificate import MARGIN, stays_inside
from vines.dynamics._lane_motion import any_turn, flow, short_flow, small_expm1
from vines.dynamics._lanes import octagon

SAMPLES = 48

motions = {
    "z": st.floats(0.0, 0.8),
    "turn": st.floats(0.0, 2 * math.pi),
    "q": st.floats(0.0, 0.6),
    "phase": st.floats(0.0, 2 * math.pi),
    "lam": st.sampled_from([0.0, 0.012, 0.3, 1.5]),
    "Omega": st.floats(0.2, 3.0),
    "speed": st.floats(-1.5, 1.5),
    "angle": st.floats(0.05, 6.28),
}


class Motion:
    """w = Re(z e^{st} + q e^{i Omega t}) - ball - speed t over a move, in 40 digits."""

    def __init__(
        self,
        *,
        z: float,
        turn: float,
        q: float,
        phase: float,
        lam: float,
        Omega: float,
        speed: float,
        angle: float,
    ) -> None:
        half = mp.mpf(lam) / 2
        self.s = -half + mp.j * mp.sqrt(1 - half * half)
        self.z = mp.mpf(z) * mp.expj(turn)
        self.q = mp.mpf(q) * mp.expj(phase)
        self.io = mp.j * mp.mpf(Omega)
        self.speed = mp.mpf(speed)
        self.tau = mp.mpf(angle / max(1.0, Omega))
        self.ball = mp.mpf(0)
        self.most8 = mp.mpf(z) + mp.mpf(q) * mp.mpf(Omega) ** 8

    def at(self, t: mp.mpf, n: int = 0) -> mp.mpf:
        """Return the n-th derivative of w at t."""
        motion = mp.re(self.s**n * self.z * mp.exp(self.s * t) + self.io**n * self.q * mp.exp(self.io * t))
        return motion - (self.ball + self.speed * t if n == 0 else self.speed if n == 1 else 0)

    def times(self) -> list[mp.mpf]:
        return [self.tau * k / SAMPLES for k in range(SAMPLES + 1)]

    def certified(self, inside: float = 1.0) -> bool:
        """Return what the kernel says of it, in doubles."""
        w0, v0, a0, j0 = (float(self.at(mp.mpf(0), n)) for n in range(4))
        w1, v1, a1, j1 = (float(self.at(self.tau, n)) for n in range(4))
        most8 = float(self.most8) * (1 + 1e-15)
        return bool(stays_inside(float(self.tau), w0, v0, a0, j0, w1, v1, a1, j1, most8, inside))

    def coefficients(self) -> tuple[list[mp.mpf], mp.mpf]:
        """Return the coefficients of degree eight of the Hermite polynomial, from its conditions, and the remainder."""
        n, tau = 7, self.tau
        rows, right = mp.zeros(8, 8), mp.zeros(8, 1)
        # Derivatives of a Bernstein form at its ends are differences of its coefficients.
        for order in range(4):
            scale = mp.factorial(n) / mp.factorial(n - order) / tau**order
            for j in range(order + 1):
                sign = (-1) ** (order - j) * mp.binomial(order, j) * scale
                rows[order, j] = sign
                rows[4 + order, n - order + j] = sign
            right[order], right[4 + order] = self.at(mp.mpf(0), order), self.at(tau, order)
        b = list(mp.lu_solve(rows, right))
        ends = [mp.mpf(0), *b, mp.mpf(0)]
        raised = [(k * ends[k] + (8 - k) * ends[k + 1]) / 8 for k in range(9)]
        return raised, self.most8 * tau**8 / (mp.factorial(8) * mp.binomial(8, 4))


@settings(max_examples=40, deadline=None)
@given(**motions)
def test_the_motion_lies_within_the_widened_polynomial(**motion: float) -> None:
    with mp.workdps(40):
        m = Motion(**motion)
        c, width = m.coefficients()
        for t in m.times():
            s = t / m.tau
            basis = [mp.binomial(8, k) * s**k * (1 - s) ** (8 - k) for k in range(9)]
            off = m.at(t) - mp.fsum(c[k] * basis[k] for k in range(9))
            assert abs(off) <= width * basis[4] * (1 + mp.mpf(10) ** -25) + mp.mpf(10) ** -30


@settings(max_examples=100, deadline=None)
@given(**motions)
def test_a_certified_move_stays_inside_and_has_coefficients_inside(**motion: float) -> None:
    with mp.workdps(40):
        m = Motion(**motion)
        # The ball so that w runs about as far to one side as to the other.
        values = [m.at(t) for t in m.times()]
        m.ball = (max(values) + min(values)) / 2
        if max(abs(m.at(mp.mpf(0))), abs(m.at(m.tau))) > 1 or not m.certified():
            return
        c, width = m.coefficients()
        assert max(abs(each) for each in c[1:8]) < 1 + mp.mpf(10) ** -13
        assert abs(c[4]) + width < 1 + mp.mpf(10) ** -13
        assert max(abs(m.at(t)) for t in m.times()[1:-1]) < 1


@settings(max_examples=100, deadline=None)
@given(**motions, depth=st.integers(1, 12), side=st.sampled_from([1, -1]))
def test_a_move_that_touches_a_wall_on_its_way_is_never_certified(depth: int, side: int, **motion: float) -> None:
    with mp.workdps(40):
        m = Motion(**motion)
        k, peak = max(enumerate(side * m.at(t) for t in m.times()), key=lambda pair: pair[1])
        if k in (0, SAMPLES):
            return
        m.ball += side * (peak - 1) - side * mp.mpf(10) ** -depth
        assert side * m.at(m.times()[k]) > 1
        assert not m.certified(1.0 - MARGIN * (1.0 + motion["z"] + motion["q"]))


def test_short_and_smooth_moves_are_certified() -> None:
    motion = {"z": 0.1, "turn": 1.0, "q": 0.1, "phase": 2.0, "lam": 0.012, "Omega": 1.0, "speed": 0.1}
    with mp.workdps(40):
        for angle in (0.1, 1.0, 3.0):
            assert Motion(**motion, angle=angle).certified()
    assert not stays_inside(1.0, math.nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    assert not stays_inside(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, math.inf, 1.0)


normal = st.floats(-1e3, 1e3, allow_subnormal=False)
"""The bound of relative error is far above rounding of these, and the margin of the certificate above the others."""


@given(a=normal, b=st.one_of(st.just(0.0), normal))
def test_the_octagon_holds_the_circle(a: float, b: float) -> None:
    with mp.workdps(40):
        length = mp.sqrt(mp.mpf(a) ** 2 + mp.mpf(b) ** 2)
        assert length <= octagon(a, b) <= length * mp.mpf("1.083") + mp.mpf(10) ** -300


@settings(max_examples=200, deadline=None)
@given(h=st.floats(0.0, 6.28), half=st.sampled_from([0.0, 0.006, 0.12]), Omega=st.floats(0.1, 1.0))
def test_one_move_is_right_to_rounding(h: float, half: float, Omega: float) -> None:
    for move, time in ((flow, h), (short_flow, h / 32), (short_flow, -h / 32)):
        gamma = math.sqrt(1.0 - half * half)
        xh, vh, cosine, sine = move(half, gamma, 1.0 / gamma, Omega, 0.3, -0.4, 0.6, 0.8, time)
        with mp.workdps(40):
            s = -mp.mpf(half) + mp.j * mp.mpf(gamma)
            z = mp.mpf(0.3) - mp.j * (mp.mpf(-0.4) + half * mp.mpf(0.3)) / mp.mpf(gamma)
            z *= mp.exp(s * mp.mpf(time))
            u = (mp.mpf(0.6) + mp.j * mp.mpf(0.8)) * mp.expj(mp.mpf(Omega) * mp.mpf(time))
            assert abs(xh - mp.re(z)) < 2e-15
            assert abs(vh - mp.re(s * z)) < 2e-15
            assert abs(mp.mpf(cosine) + mp.j * mp.mpf(sine) - u) < 2e-15


def test_sines_and_exponentials_keep_their_digits() -> None:
    x = np.linspace(-20.0, 20.0, 1001)
    turned = np.array([any_turn(each) for each in x])
    assert np.max(np.abs(turned - np.column_stack([np.sin(x), np.cos(x)]))) < 1e-15
    y = np.linspace(-0.8, 0.8, 1000)
    assert np.max(np.abs(np.array([small_expm1(each) for each in y]) / np.expm1(y) - 1.0)) < 1e-15
