"""What is added to recorded channels is what was asked for."""

import numpy as np
import pytest

from vines.errors import ParameterError
from vines.rig.synth import Burst, Disturbances, Hum, RigSettings, Ringing, disturbed, raw_run, read_raw

SHORT = RigSettings(duration=4.0, settle=0.5, rate=12800.0, laser_noise=0.0, enob=24.0, acc_noise=0.0)


@pytest.fixture(scope="module")
def run():
    return raw_run(SHORT, 3)


def added(run, what, role):
    """Return what a disturbance adds to a channel, in SI units."""
    plain, other = read_raw(run).role(role), read_raw(disturbed(run, what, 1)).role(role)
    return plain, other.values - plain.values


def test_hum_has_its_volts_in_all_channels(run):
    for role, per_volt in (("lo_disp", 2e-3), ("base_disp", 1e-4)):
        _, more = added(run, Disturbances(hum=(Hum(50.0, 3e-3),)), role)
        assert np.isclose(np.std(more) * np.sqrt(2), 3e-3 * per_volt, rtol=0.02)


def test_a_mode_rings_by_the_closed_form_after_each_impact(run):
    mode = Ringing("lo_disp", 40.0, 0.05, 0.2)
    channel, more = added(run, Disturbances(ringing=(mode,)), "lo_disp")
    impacts = run.truth["impacts"]
    dv = SHORT.m / (SHORT.M + SHORT.m) * (np.array(impacts["w_dot_after"]) - np.array(impacts["w_dot"]))
    t, expected, omega = channel.times, np.zeros(len(channel.values)), 2 * np.pi * 40.0
    for when, jump in zip(impacts["t"], dv, strict=True):
        tau = np.maximum(t - when, 0.0)
        turn = omega * np.sqrt(1 - 0.05**2)
        expected += 0.2 * jump / turn * np.exp(-0.05 * omega * tau) * np.sin(turn * tau)
    assert np.abs(more - expected).max() < 0.02 * np.abs(expected).max()


def test_bursts_hold_leap_and_leave_the_range(run):
    what = tuple(Burst("lo_disp", kind, when, 0.02) for kind, when in (("held", 1.0), ("dropout", 2.0), ("spike", 3.0)))
    codes = next(c for file in disturbed(run, Disturbances(bursts=what), 1).files.values() for c in file.channels)
    values = np.asarray(
        next(
            c.values
            for file in disturbed(run, Disturbances(bursts=what), 1).files.values()
            for c in file.channels
            if c.name.endswith("lo_disp")
        )
    )
    held = values[round(1.0 * codes.rate) : round(1.02 * codes.rate)]
    assert np.ptp(held) == 0
    assert np.all(values[round(2.0 * codes.rate) + 1 : round(2.02 * codes.rate)] == 2**23 - 1)


def test_no_such_role_is_said(run):
    with pytest.raises(ParameterError, match="no channel of role 'ball_cam'"):
        disturbed(run, Disturbances(hum=(Hum(50.0, 1.0, roles=("ball_cam",)),)), 1)


def test_amplitude_and_restitution_follow_their_courses():
    given = {"E_course": ((0.0, 1.0), (4.0, 1.5)), "r_course": ((0.0, 0.0), (4.0, -0.2))}
    one = raw_run(RigSettings(duration=4.0, settle=2.0, rate=12800.0, sigma_r=0.0, E=4e-4, **given), 3)
    base = read_raw(one).role("base_disp")
    late, early = base.values[base.times > 3.6], base.values[base.times < 0.4]
    assert np.isclose(np.abs(late).max() / np.abs(early).max(), 1.49 / 1.05, rtol=0.02)
    t, r = np.array(one.truth["impacts"]["t"]), np.array(one.truth["impacts"]["r"])
    assert np.allclose(r, 0.65 - 0.05 * t, atol=2e-3)
