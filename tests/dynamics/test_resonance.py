"""At and next to resonance: the motion against 40 digits and the secular closed form, energies, lanes, yardsticks."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest

from vines.dynamics import ensemble, lyapunov_spectrum, no_ball, simulate
from vines.dynamics._constants import Constants
from vines.dynamics._flight import derivatives, fifth, phasors, sixth, turn
from vines.dynamics._integrals import segment_integrals
from vines.dynamics._room import constants
from vines.errors import ParameterError
from vines.model import Params
from vines.orbits import all_orbits, find_orbit

pytestmark = pytest.mark.long(15)

LAMS = (0.0, 1e-12, 1e-8, 1e-4, 1e-2)
OMEGAS = (1.0, 1 + 1e-9, 1 - 1e-9, 1 + 1e-6, 1 - 1e-6, 1 + 1e-3, 1 - 1e-3)


def _exact(p: Params, mass: float, x: float, v: float, phase: float, t: float) -> tuple[mp.mpf, mp.mpf]:
    """x1 and v1 at t in 40 digits: mass x'' + lam x' + x = F, by the Duhamel form or its limit."""
    m, lam, Omega, t = mp.mpf(mass), mp.mpf(p.lam), mp.mpf(p.Omega), mp.mpf(t)
    s = mp.mpc(-lam / (2 * m), mp.sqrt(1 / m - (lam / (2 * m)) ** 2))
    g = mp.mpf(p.A) / m * (lam * Omega - 1j) * mp.expj(mp.mpf(phase)) / (1j * Omega - mp.conj(s))
    apart = 1j * Omega - s
    grown = t * mp.exp(s * t) if apart == 0 else (mp.expj(Omega * t) - mp.exp(s * t)) / apart
    u = mp.exp(s * t) * mp.mpc(x, (g.real + s.real * mp.mpf(x) - mp.mpf(v)) / s.imag) + g * grown
    return u.real, (s * u + g * mp.expj(Omega * t)).real


def _steady(c: Constants) -> float:
    """The steady amplitude where motion is written with it: up to it a few roundings are allowed; else 0."""
    return math.hypot(c.free.qr, c.free.qi) if c.free.reach == 0 else 0.0


@pytest.mark.parametrize("lam", LAMS)
@pytest.mark.parametrize("Omega", OMEGAS)
@pytest.mark.parametrize("A", [1e-6, 0.01, 1.0])
def test_the_motion_keeps_its_digits(A: float, Omega: float, lam: float) -> None:
    p = Params(mu=0.1, A=A, Omega=Omega, lam=lam)
    c = constants(p)
    with mp.workdps(40):
        for x, v in ((0.0, 0.0), (0.3, -0.2)):
            start = phasors(c.free, Omega, x, v, 0.4)
            for t in (0.1, 1.0, 3.3, 17.7, 200.0):
                ours = derivatives(c.free, Omega, *turn(c.free, Omega, *start, t))
                exact = _exact(p, 1.0, x, v, 0.4, t)
                allowed = 3e-15 * (1 + t / 10) * (A * t + abs(x) + abs(v)) + 1e-15 * _steady(c)
                assert abs(ours[0] - exact[0]) < allowed
                assert abs(ours[1] - exact[1]) < allowed


@pytest.mark.parametrize("Omega", [0.5, 0.5 + 1e-9, 0.5 - 1e-5])
def test_the_loaded_oscillator_keeps_its_digits_at_its_own_resonance(Omega: float) -> None:
    p = Params(mu=3.0, A=0.1, Omega=Omega, lam=0.0)
    c = constants(p)
    with mp.workdps(40):
        start = phasors(c.stuck, Omega, 0.1, 0.0, 0.4)
        for t in (0.5, 5.0, 60.0):
            x, v, *_ = derivatives(c.stuck, Omega, *turn(c.stuck, Omega, *start, t))
            exact = _exact(p, 4.0, 0.1, 0.0, 0.4, t)
            assert abs(x - exact[0]) + abs(v - exact[1]) < 1e-15 * (1 + t)
    run = simulate(p, v2=0.3, periods=30)
    assert run.status == "complete"
    assert abs(run.measures().balance) < 1e-12 * (run.measures().base_work + run.measures().max_abs_x1 ** 2)


def test_undamped_at_resonance_it_grows_as_t_sin_t() -> None:
    # x'' + x = A cos t from rest with the phase pi/2: x = A t sin(t)/2.
    p = Params(mu=0.01, A=0.001, Omega=1.0, lam=0.0)
    run = simulate(p, x2=0.0, v2=0.0, phi=math.pi / 2, periods=40)
    assert len(run.impacts) == 0
    s = run.sample(5000)
    assert np.max(np.abs(s["x1"] - 0.5 * p.A * s["t"] * np.sin(s["t"]))) < 1e-14
    # The ball at rest in the middle is struck once the amplitude exceeds 1.
    far = simulate(p, x2=0.0, v2=0.0, phi=math.pi / 2, periods=330).impacts
    t = float(mp.findroot(lambda t: p.A * t * mp.sin(t) / 2 + 1, float(far["t"][0])))
    assert far["t"][0] == pytest.approx(t, abs=1e-11)


@pytest.mark.parametrize("lam", LAMS)
@pytest.mark.parametrize("Omega", OMEGAS)
def test_energy_balances_to_1e_12(Omega: float, lam: float) -> None:
    for A in (1e-3, 0.02, 1.0):
        m = simulate(Params(mu=0.01, A=A, Omega=Omega, lam=lam), v2=0.3, periods=25).measures()
        assert abs(m.balance) <= 1e-12 * (abs(m.base_work) + abs(m.energy_change))


@pytest.mark.parametrize(
    ("A", "Omega", "lam"),
    [(0.02, 1.0, 0.0), (0.02, 1.0, 1e-8), (0.02, 1 + 1e-3, 1e-4), (0.02, 1.0, 0.012), (5.0, 1.2, 0.1), (0.5, 3.0, 0.0)],
)
@pytest.mark.parametrize("stuck", [False, True])
def test_integrals_are_those_of_a_fine_quadrature(A: float, Omega: float, lam: float, stuck: bool) -> None:
    p = Params(mu=0.2, A=A, Omega=Omega, lam=lam)
    c = constants(p)
    mass = 1.2 if stuck else 1.0
    with mp.workdps(30):
        for length in (0.01, 2.9, 40.0):
            ours = segment_integrals(c, 1.0 if stuck else 0.0, 0.3, -0.2, 0.7, 0.4, length)
            nodes, weights = np.polynomial.legendre.leggauss(40)
            parts = max(1, int(length))
            total = [mp.mpf(0)] * 4
            for k in range(parts):
                for node, weight in zip(nodes, weights, strict=True):
                    t = length * (k + 0.5 + 0.5 * node) / parts
                    x, v = _exact(p, mass, 0.3, -0.2, 0.4, t)
                    angle = Omega * t + 0.4
                    rate = A * Omega * mp.cos(angle)
                    a = (A * mp.sin(angle) + lam * rate - lam * v - x) / mass
                    for i, y in enumerate((x * x, v * v, mass * rate * a, lam * (v - rate) ** 2)):
                        total[i] += 0.5 * length / parts * weight * y
            size = float(total[0] + total[1]) + A * A * length
            for got, exact in zip((ours[0], ours[1], ours[3], ours[4]), total, strict=True):
                assert abs(got - float(exact)) < 1e-13 * size + 1e-14 * _steady(c) ** 2


@pytest.mark.parametrize(("A", "Omega"), [(0.3, 1.0), (3.0, 1.0), (1.0, 0.3), (10.0, 4.0)])
def test_derivatives_and_their_bounds_hold_over_a_window(A: float, Omega: float) -> None:
    rng = np.random.default_rng(3)
    for lam in (0.0, 0.01, 1.5):
        c = constants(Params(mu=0.1, A=A, Omega=Omega, lam=lam))
        for _ in range(30):
            at = phasors(c.free, Omega, rng.normal(), rng.normal(), rng.uniform(0, 6.28))
            bound = math.hypot(*fifth(c.free, *at)) + math.hypot(*at[2:]) * Omega**5 * c.window
            for h in np.linspace(0.0, c.window, 25):
                later = turn(c.free, Omega, *at, float(h))
                assert math.hypot(*fifth(c.free, *later)) <= bound * (1 + 1e-12)
            # x'' + lam x' + x = F differentiated four times.
            _, _, _, _, d4 = derivatives(c.free, Omega, *at)
            d5, d6 = fifth(c.free, *at)[0], sixth(c.free, *at)
            turned = (complex(*at[2:]) * complex(c.free.half, c.free.sum)).real
            assert d6 + lam * d5 + d4 == pytest.approx(Omega**4 * turned, rel=1e-12, abs=1e-12 * (1 + A * Omega**5))


def test_lanes_leave_resonance_to_the_scalar_kernel() -> None:
    p = Params(mu=0.01, A=0.02, Omega=1.0, lam=0.0)
    v2 = np.linspace(0.1, 0.3, 5)
    many = ensemble(p, {"v2": v2}, periods=6, record="measures", lyapunov=True)
    assert many.measures is not None
    for k in range(5):
        run = simulate(p, v2=float(v2[k]), periods=6)
        assert many.final["x1"][k] == run.final["x1"]
        assert many.measures["base_work"][k] == pytest.approx(run.measures().base_work, rel=1e-12)
    exponents, _ = lyapunov_spectrum(simulate(p, periods=50))
    assert np.isfinite(exponents).all()


def test_there_the_yardstick_is_infinite_and_closed_forms_of_orbits_refuse() -> None:
    p = Params(mu=0.01, A=0.02, Omega=1.0, lam=0.0)
    assert no_ball(p) == math.inf
    for word in ("LR", "LLR", "LLRR"):
        with pytest.raises(ParameterError, match="lam is 0 at Omega = 1") as caught:
            all_orbits(word, p)
        assert "\n" not in str(caught.value)
    with pytest.raises(ParameterError, match="lam is 0 at Omega = 1"):
        find_orbit("LR", p)
