"""Runs that only accelerometers saw, against the sealed truth: knocks have pulses, and some impacts have none."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from vines.rig import reconstruct, ring_down
from vines.rig.synth import RigSettings, simulate_rig

pytestmark = pytest.mark.long(9)

ALONE = RigSettings(
    duration=12.0, settle=20.0, sigma_r=0.01, friction=0.002, false=0.15, missed=0.03, acc_cross_axis=0.03,
    channels=("base_acc", "lo_acc"),
)  # fmt: skip


@pytest.fixture(scope="module")
def ringdown():
    """Return omega0 and lam from ten seconds without the ball."""
    settings = RigSettings(
        run_id="free", protocol="ringdown", ball=False, E=0.0, duration=10.0, settle=0.0, start=(0.012, 0.0, 0.0, 0.0),
        channels=ALONE.channels,
    )  # fmt: skip
    return ring_down(simulate_rig(settings, 1)[0])


@pytest.fixture(scope="module")
def run():
    """Return twelve seconds with 15 % of knocks and 3 % of silent impacts, and their truth."""
    return simulate_rig(ALONE, 11)


@pytest.fixture(scope="module")
def found(run, ringdown):
    return reconstruct(run[0], [ringdown])


def test_the_run_is_accepted_and_its_quantities_come_within_the_targets(found, run):
    truth = run[1]
    assert found.accepted, found.reasons
    assert (found.pattern.name, found.pattern.fraction) == ("1:1", 1.0)
    assert found.quantities["r"].value == pytest.approx(truth["settings"]["r"], abs=0.005)
    assert found.quantities["sigma_r"].value == pytest.approx(truth["settings"]["sigma_r"], rel=0.2)
    assert found.quantities["mu_momentum"].value == pytest.approx(0.032 / 3.807, rel=0.02)
    for name in ("E", "omega0", "lam", "phase"):
        one = found.quantities[name]
        assert abs(one.value - truth["parameters"][name]) < 3 * one.u


def test_impacts_without_a_pulse_are_found_and_knocks_are_none(found, run):
    true = np.array(run[1]["impacts"]["t"])
    true = true[(true > found.impacts["t"][0] - 1e-3) & (true < found.impacts["t"][-1] + 1e-3)]
    assert len(true) == len(found.impacts)
    apart = found.impacts["t"] - true
    assert np.sqrt(np.mean(apart**2)) < 20e-6
    assert found.pruned > 10


def test_the_residual_is_noise_and_in_metres(found):
    assert found.residual < 1.3 * found.noise
    assert found.noise < 1e-6


def test_a_base_that_is_wired_the_other_way_round_is_a_fault(ringdown):
    recording = simulate_rig(msgspec.structs.replace(ALONE, duration=6.0), 11)[0]
    base = recording.role("base_acc")
    turned = replace(recording, channels={**recording.channels, base.name: replace(base, values=-base.values)})
    result = reconstruct(turned, [ringdown])
    assert not result.accepted
    assert any(one.fault and not one.passed for one in result.findings)
