"""Reconstruction against the sealed truth of a synthetic rig, whose contact is soft and whose equations are its own."""

import numpy as np
import pytest

from vines.errors import RigError
from vines.rig import reconstruct
from vines.rig.synth import RigSettings, read_raw, simulate_rig


def test_a_ring_down_gives_omega0_to_a_part_in_ten_thousand_and_lam(ringdown):
    assert ringdown.omega0.value == pytest.approx(np.sqrt(11680.0 / 3.807), rel=1e-4)
    assert ringdown.lam.value == pytest.approx(2.53 / np.sqrt(11680.0 * 3.807), rel=1e-3)


def test_restitution_its_scatter_and_the_mass_ratio_come_within_the_targets(dwell, raw):
    found, truth = dwell, raw.truth
    assert found.accepted, found.reasons
    assert found.quantities["r"].value == pytest.approx(truth["settings"]["r"], abs=0.005)
    assert found.quantities["sigma_r"].value == pytest.approx(truth["settings"]["sigma_r"], rel=0.2)
    assert found.quantities["mu"].value == pytest.approx(0.032 / 3.807, rel=0.01)
    assert found.quantities["mu_momentum"].value == pytest.approx(0.032 / 3.807, rel=0.01)


def test_impacts_are_found_where_they_were(dwell, raw):
    found, truth = dwell, raw.truth
    true = np.array(truth["impacts"]["t"])
    true = true[(true > found.impacts["t"][0] - 1e-3) & (true < found.impacts["t"][-1] + 1e-3)]
    assert len(true) == len(found.impacts)
    assert np.max(np.abs(true - found.impacts["t"])) < 20e-6
    assert set(np.unique(found.impacts["side"])) == {-1.0, 1.0}


def test_the_pattern_of_a_dwell_on_1_to_1_is_1_to_1(dwell):
    assert (dwell.pattern.name, dwell.pattern.p, dwell.pattern.fraction) == ("1:1", 1, 1.0)


def test_a_ring_down_is_not_reconstructed(ringdown):
    settings = RigSettings(run_id="free", protocol="ringdown", ball=False, E=0.0, duration=2.0, settle=0.0)
    with pytest.raises(RigError, match="has no ball in it"):
        reconstruct(simulate_rig(settings, 2)[0], [ringdown])


def test_a_run_of_which_a_tenth_of_the_impacts_was_not_seen_is_not_accepted(dwell, raw, ringdown):
    kept = np.random.default_rng(3).random(len(dwell.impacts)) > 0.1
    seen = dwell.impacts[kept]
    again = reconstruct(read_raw(raw), [ringdown], impacts=(seen["t"], seen["v1_after"] - seen["v1"]))
    assert not again.accepted
    assert "suspect_impacts" in {finding.name for finding in again.findings if not finding.passed}


def test_soft_impacts_contradict_nothing(ringdown):
    """A heavy ball in chaos: impacts from .05 to 1.4 m/s, and slow flights in which its friction turns."""
    settings = RigSettings(
        duration=20.0, settle=30.0, E=0.015 * 0.0457, m=3.807 * 0.08, sigma_r=0.006, r=0.68, r_exponent=0.16,
        friction=0.004,
    )  # fmt: skip
    recording, truth = simulate_rig(settings, 4)
    found = reconstruct(recording, [ringdown])
    assert found.accepted, found.reasons
    speed, r = np.abs(truth["impacts"]["w_dot"]), np.array(truth["impacts"]["r"])
    assert np.ptp(np.log(speed)) > 2
    q = found.quantities
    assert q["r"].value == pytest.approx(np.sum(r * speed) / np.sum(speed), abs=0.002)
    assert q["r_mean"].value == pytest.approx(np.mean(r), abs=0.003)
    assert q["r"].value == pytest.approx(q["w_after"].value / q["w_before"].value, abs=0.002)
    assert q["sigma_r"].value == pytest.approx(settings.sigma_r, rel=0.2)
    assert q["mu_momentum"].value == pytest.approx(0.08, rel=0.005)
    t = np.array(truth["impacts"]["t"])
    away = np.min(np.abs(found.impacts["t"][:, None] - t), axis=1)
    assert np.sqrt(np.mean(away**2)) < 1e-5


def test_a_sensor_that_is_not_linear_hides_no_train_of_soft_impacts(ringdown):
    settings = RigSettings(
        duration=12.0, settle=30.0, E=0.015 * 0.0228, m=0.03807, r=0.65, r_speed=1.2, sigma_r=0.005, r_exponent=0.06,
        friction=0.002, contact_time=1.8e-4, laser_noise=6.5e-6, laser_linearity=-7e-4, missed=0.03, false=0.1,
    )  # fmt: skip
    recording, truth = simulate_rig(settings, 11)
    found = reconstruct(recording, [ringdown])
    assert truth["pattern"]["name"] in ("2:1", "1:2")
    assert found.pattern.name == truth["pattern"]["name"]
    assert found.accepted, found.reasons
    assert found.quantities["r_mean"].value == pytest.approx(np.mean(truth["impacts"]["r"]), abs=0.005)
