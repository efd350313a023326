"""The synthetic rig: its contact, its energy, its limit, and that its truth is what was recorded."""

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import vines
from vines.errors import ParameterError
from vines.rig.synth import RigSettings, draw_settings, simulate_rig
from vines.rig.synth._contact import damping, stiffness
from vines.rig.synth._motion import move
from vines.rig.synth._pattern import true_pattern

FREE = RigSettings(c=0.0, k=1e-9, E=0.0, settle=0.0, duration=0.05, sigma_r=0.0, start=(0.0, 0.0, 0.0, 0.4))


@settings(max_examples=25)
@given(r=st.floats(0.1, 0.95), speed=st.floats(0.05, 1.5), time=st.floats(70e-6, 200e-6))
def test_contact_gives_restitution_and_duration(r, speed, time):
    """Against scipy's integrator: the law separates exactly, so r is met whatever the stiffness."""
    mass, a = 0.0317, damping(r)
    stiff = stiffness(time, speed, r, mass)

    def motion(_, y):
        return [y[1], -stiff * max(y[0], 0.0) ** 1.5 * (1 + a / speed * y[1]) / mass]

    def leaves(_, y):
        return y[0]

    leaves.terminal, leaves.direction = True, -1
    end = solve_ivp(motion, (0, 20 * time), [0.0, speed], events=leaves, rtol=1e-10, atol=1e-14, max_step=time / 30)
    assert -end.y_events[0][0][1] / speed == pytest.approx(r, abs=1e-6)
    assert end.t_events[0][0] == pytest.approx(time, rel=1e-4)


@pytest.mark.parametrize("r", [0.3, 0.65, 0.9])
def test_free_impact_keeps_momentum_and_loses_the_right_energy(r):
    s = msgspec.structs.replace(FREE, r=r)
    motion = move(s, np.random.default_rng(0), 1 / s.rate, 0)
    (first, *_) = motion.impacts
    assert -first.w_dot_after / first.w_dot == pytest.approx(r, abs=1e-6)
    assert s.M * first.v1_after + s.m * first.v2_after == pytest.approx(s.m * 0.4, rel=1e-9)
    reduced = s.M * s.m / (s.M + s.m)
    lost = 0.5 * s.m * 0.4**2 - 0.5 * (s.M * first.v1_after**2 + s.m * first.v2_after**2)
    assert lost == pytest.approx(0.5 * reduced * (1 - r * r) * 0.4**2, rel=1e-5)


def test_energy_balance_between_impacts():
    """Work of the base less loss in the damper is what is gained, until the first impact."""
    s = RigSettings(settle=0.0, duration=2.0, ball=False, sigma_r=0.0, temperature=(20.0, 20.0))
    motion = move(s, np.random.default_rng(3), 1 / s.rate, 0)
    t = np.arange(len(motion.x1)) * motion.step
    e, de = motion.base(t), motion.base(t, 1)
    force = s.c * (motion.v1 - de) + s.k * (motion.x1 - e)
    work = -np.trapezoid(de * force, t)
    damper = np.trapezoid(s.c * (motion.v1 - de) ** 2, t)
    energy = 0.5 * s.M * motion.v1**2 + 0.5 * s.k * (motion.x1 - e) ** 2
    assert work - damper == pytest.approx(energy[-1] - energy[0], rel=1e-6)


def test_hard_impacts_are_the_limit_of_short_contacts():
    """The exact model, which shares no code with it, is met in proportion to the contact time."""
    errors = []
    for contact in (8e-5, 4e-5):
        s = RigSettings(sigma_r=0.0, settle=0.0, duration=1.0, contact_time=contact, E=3e-4, start=(0.0, 0.0, 0.0, 0.8))
        motion = move(s, np.random.default_rng(5), 1 / s.rate, 0)
        p = vines.PhysicalParams(M=s.M, c=s.c, k=s.k, b=s.b, r=s.r).dimensionless(E=s.E, omega=2 * np.pi * s.f, m=s.m)
        omega0 = np.sqrt(s.k / s.M)
        phi = motion.parameters["phi"]
        exact = vines.simulate(p, x1=0, v1=0, x2=0, v2=0.8 / (s.b * omega0), t=0, phi=phi, periods=8)
        assert np.array_equal(motion.impacts["side"][:4], exact.impacts["side"][:4])
        errors.append(motion.impacts["t_mid"][:4] - exact.impacts["t"][:4] / omega0)
    assert np.abs(errors[0]).max() < 1e-3
    np.testing.assert_allclose(errors[1] / errors[0], 0.5, rtol=0.05)


def test_truth_is_what_was_recorded():
    s = RigSettings(duration=6.0, settle=20.0, laser_delay=3e-4, ppm=40.0, skew=0.5, acc_gain=0.0)
    recording, truth = simulate_rig(s, 4)
    lo = recording.channels["lo_disp"]
    t = np.array(truth["impacts"]["t"])
    x1 = np.array(truth["impacts"]["x1"])
    seen = np.interp(t, lo.times, lo.values)
    assert (
        np.abs(seen - x1).max() < 60e-6
    )  # a contact lasts some 100 us, the oscillator moves at .5 m/s, the laser 2 um
    acc = recording.channels["lo_acc"]
    for each in t[1:-1]:
        near = np.abs(acc.times - each) < 3e-4
        peak = acc.times[near][np.argmax(np.abs(acc.values[near]))]
        assert abs(peak - each) < 2.5e-4
    assert truth["pattern"]["name"] == "1:1"


def test_two_recorders_come_onto_one_clock():
    s = RigSettings(
        duration=20.0, settle=1.0, rate=12800.0, recorders=2, ppm=30.0, ppm_second=-45.0, offset_second=0.037,
        channels=("base_acc", "base_disp", "lo_disp", "lo_acc"),
    )  # fmt: skip
    recording, _ = simulate_rig(s, 4)
    lo = recording.channels["lo_disp"]
    assert lo.rate == pytest.approx(12800.0 * (1 + 30e-6) / (1 - 45e-6), rel=1e-7)
    assert lo.start == pytest.approx(0.037 / (1 + 30e-6) - s.laser_delay, abs=20e-6)
    assert 0 < lo.u_time < 20e-6


def test_patterns():
    t = np.array([0.1, 0.3, 0.6])[None] + np.arange(100)[:, None]
    side = np.tile([1.0, 1.0, -1.0], (100, 1))
    assert true_pattern(t.ravel(), side.ravel(), 1.0, 100.0)["name"] == "2:1"
    halves = np.where(np.arange(300) % 2, 1.0, -1.0)
    assert true_pattern(np.sort(t.ravel()), halves, 1.0, 100.0)["name"] == "3:3/2T"
    rng = np.random.default_rng(0)
    assert true_pattern(np.sort(rng.uniform(0, 100, 250)), rng.choice([-1.0, 1.0], 250), 1.0, 100.0)["name"] == "mixed"


def test_impossible_rigs_are_refused_in_one_line():
    for wrong in ({"r": 1.5}, {"M": -1.0}, {"channels": ("laser",)}, {"contact_time": 1.0}):
        with pytest.raises(ParameterError) as caught:
            RigSettings(**wrong).check()
        assert "\n" not in str(caught.value)
    assert draw_settings(3).r < 0.98
