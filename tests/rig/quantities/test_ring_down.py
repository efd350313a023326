"""Ring-downs: a decaying sine in closed form, and the drift of omega0 with temperature."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from vines.errors import RigError
from vines.rig import Recording, RingDown, RunInfo, Sampled, Uncertain, match_ring_downs, ring_down
from vines.rig.quantities._ring_down import STIFFNESS_DRIFT, U_STIFFNESS_DRIFT, natural

OMEGA0, LAM, RATE, SECONDS = 55.39, 0.012, 3200.0, 14.0


def info(name="free", protocol="ringdown", began="2026-01-05T09:00:00Z", ball=False, ringdown=()):
    one = Uncertain(1.0, 0.01)
    return RunInfo(name, began, protocol, None, None, 0.0, one, one, one, ball, (20.0, 20.4), ringdown)


def recorded(noise, seed=0, bent=0.0, role="lo_disp", **about):
    """Return the record of a free decay, by a sensor that may add a square of the motion."""
    t = (np.arange(round(SECONDS * RATE)) + 0.5) / RATE
    s = OMEGA0 * complex(-LAM / 2, np.sqrt(1 - LAM**2 / 4))
    x = 4e-3 * np.exp(s.real * t) * np.cos(s.imag * t + 0.3)
    x = x + bent * x**2 / 4e-3 + 1e-5 + noise * np.random.default_rng(seed).normal(size=len(t))
    return Recording(info(**about), {"one": Sampled("one", role, RATE, t[0], x, np.ones(len(t), bool))}, "none")


def test_closed_form_is_met():
    found = ring_down(recorded(0.0))
    assert found.omega0.value == pytest.approx(OMEGA0, rel=1e-9)
    assert found.lam.value == pytest.approx(LAM, rel=1e-6)
    assert found.temperature == pytest.approx(20.2)


def test_stated_uncertainties_are_those_of_the_noise():
    found = [ring_down(recorded(2e-5, seed)) for seed in range(12)]
    for name, true in (("omega0", OMEGA0), ("lam", LAM)):
        told = [getattr(one, name) for one in found]
        ratios = np.array([(one.value - true) / one.u for one in told])
        assert 0.3 < np.sqrt(np.mean(ratios**2)) < 1.5


def test_a_sensor_that_is_not_quite_linear_does_not_move_the_damping():
    found = ring_down(recorded(1e-6, bent=2e-3))
    assert found.lam.value == pytest.approx(LAM, rel=2e-4)


def two_masses(role, table=60.0, swing=1.5):
    """Return the free decay of an oscillator on a table that hangs at `swing` Hz, by eigenvectors, as two channels."""
    M, k, c = 3.807, 3.807 * OMEGA0**2, 3.807 * LAM * OMEGA0
    kb, cb = table * (2 * np.pi * swing) ** 2, 0.1 * table * 2 * np.pi * swing
    matrix = np.array([
        [0, 1, 0, 0], [-k / M, -c / M, k / M, c / M],
        [0, 0, 0, 1], [k / table, c / table, -(k + kb) / table, -(c + cb) / table],
    ])  # fmt: skip
    s, v = np.linalg.eig(matrix)
    size = np.linalg.solve(v, np.array([0.01, 0, 0, 0], complex))
    t = (np.arange(round(SECONDS * RATE)) + 0.5) / RATE
    order = 2 if role == "acc" else 0
    rng = np.random.default_rng(3)
    waves = np.exp(np.outer(t, s)) * (size * s**order)
    both = {
        name: Sampled(name, f"{name}_{role}", RATE, t[0], (waves @ v[place]).real + noise * rng.normal(size=len(t)),
                      np.ones(len(t), bool), 1e-3, 1e-6)
        for name, place, noise in (("lo", 0, 1e-6), ("base", 2, 1e-7))
    }  # fmt: skip
    return Recording(info(), both, "none")


@pytest.mark.parametrize("role", ["disp", "acc"])
def test_a_table_that_moves_is_allowed_for(role):
    found = ring_down(two_masses(role))
    assert found.base == pytest.approx(3.807 / 60, rel=0.1)
    assert abs(found.omega0.value / OMEGA0 - 1) < 1e-5
    assert found.lam.value == pytest.approx(LAM, rel=1e-3)
    # Without its channel the frequency is that of both masses.
    blind = ring_down(Recording(info(), {"lo": two_masses(role).channels["lo"]}, "none"))
    assert blind.omega0.value / OMEGA0 - 1 == pytest.approx(0.5 * 3.807 / 60, rel=0.1)


@pytest.mark.parametrize("share", [0.07, -0.05, 0.004])
def test_a_spring_that_is_not_linear_is_seen(share):
    k3 = share / 0.009**2

    def rates(_, y):
        return y[1], -(OMEGA0**2) * y[0] * (1 + k3 * y[0] ** 2) - LAM * OMEGA0 * y[1]

    t = (np.arange(round(SECONDS * RATE)) + 0.5) / RATE
    x = solve_ivp(rates, (0, t[-1]), (0.012, 0), "DOP853", t_eval=t, rtol=1e-8, atol=1e-11).y[0]
    x += 1e-6 * np.random.default_rng(1).normal(size=len(t))
    found = ring_down(
        Recording(info(), {"one": Sampled("one", "lo_disp", RATE, t[0], x, np.ones(len(t), bool))}, "none")
    )
    assert found.stiffening.value == pytest.approx(3 / 8 * k3, rel=0.02)
    assert abs(found.omega0.value - OMEGA0) < 3 * max(found.omega0.u, 1e-5 * OMEGA0)


def test_a_linear_spring_is_none_of_these():
    found = ring_down(recorded(2e-6))
    assert abs(found.stiffening.value) < 4 * found.stiffening.u
    assert found.stiffening.u * 0.009**2 < 1e-4


@pytest.mark.parametrize(
    ("recording", "reason"),
    [
        (lambda: recorded(0.0, ball=True), "with the ball in"),
        (lambda: recorded(0.0, role="base_disp"), "has no channel on the oscillator"),
        (lambda: recorded(1e-2), "shows no free decay|no decaying sine"),
    ],
)
def test_what_is_no_ring_down_is_refused(recording, reason):
    with pytest.raises(RigError, match=reason):
        ring_down(recording())


def measured(temperature, drift=STIFFNESS_DRIFT, u=1e-5, name="a"):
    return RingDown(
        name, Uncertain(OMEGA0 * (1 + drift * (temperature - 20)), u), Uncertain(LAM, 1e-6), temperature, 0.0
    )


def test_two_ring_downs_give_the_drift_of_the_stiffness():
    drift = -2.4e-4
    pair = (measured(19.0, drift), measured(24.0, drift))
    for temperature in (19.0, 21.5, 24.0, 26.0):
        omega0, lam = natural(pair, temperature)
        assert omega0.value == pytest.approx(OMEGA0 * (1 + drift * (temperature - 20)), rel=1e-5)
        assert lam.value == pytest.approx(LAM)


@pytest.mark.parametrize("temperature", [19.0, 21.5, 24.0, 29.0])
def test_uncertainty_between_and_beyond_two_ring_downs(temperature):
    """Of rigs whose drift is drawn, and by how much the springs were not at the temperature that was read (.1 K)."""
    rng, ratios = np.random.default_rng(4), []
    for _ in range(600):
        drift = rng.normal(STIFFNESS_DRIFT, U_STIFFNESS_DRIFT)
        away = ((19.0, 0.1), (24.0, 0.1), (temperature, 0.1))
        true = [OMEGA0 * (1 + drift * (at + error * rng.normal() - 20)) for at, error in away]
        pair = tuple(
            RingDown("a", Uncertain(value, 1e-5), Uncertain(LAM, 1e-6), at, 0.0)
            for at, value in zip((19.0, 24.0), true[:2], strict=True)
        )
        found = natural(pair, temperature)[0]
        ratios.append((found.value - true[2]) / found.u)
    assert 0.8 < np.std(ratios) < 1.4


def test_one_ring_down_is_moved_by_what_steel_does():
    for away in (-3.0, 0.0, 2.0):
        omega0, _ = natural((measured(20.0),), 20.0 + away)
        assert omega0.value == pytest.approx(OMEGA0 * (1 + STIFFNESS_DRIFT * away), rel=1e-9)
        assert omega0.u >= OMEGA0 * 0.5e-4 * abs(away)
    unknown = natural((measured(20.0),), float("nan"))[0]
    assert (unknown.value, unknown.u > OMEGA0 * 2e-4) == (OMEGA0, True)
    with pytest.raises(RigError, match="no ring-down is at hand"):
        natural((), 20.0)


def test_ring_downs_of_a_run():
    free = [info(name, began=f"2026-01-05T{hour}:00:00Z") for name, hour in (("a", "08"), ("b", "09"), ("c", "12"))]
    run = info("run", "dwell", "2026-01-05T13:00:00Z", ball=True)
    assert match_ring_downs(run, free) == ("c",)
    assert match_ring_downs(info("run", "dwell", ball=True, ringdown=("a",)), free) == ("a",)
    with pytest.raises(RigError, match="names the ring-down 'd', which is not at hand"):
        match_ring_downs(info("run", "dwell", ball=True, ringdown=("d",)), free)
    with pytest.raises(RigError, match="has no ring-down: omega0 must be known"):
        match_ring_downs(run, [run])
