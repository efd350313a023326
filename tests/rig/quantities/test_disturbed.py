"""Hum, modes, lost signal and trends: dealt with or named, each by a run that has them."""

import warnings
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from vines.rig import reconstruct, ring_down
from vines.rig.fit import Bins
from vines.rig.impacts import rung, still_rings
from vines.rig.quantities._dwells import dwells, envelope
from vines.rig.quantities._hum import without_hum
from vines.rig.quantities._trends import FALSE_ALARM, trend
from vines.rig.synth import Burst, Disturbances, Hum, RigSettings, Ringing, disturbed, raw_run, read_raw

SET = {"duration": 12.0, "settle": 40.0, "rate": 12800.0, "friction": 0.002, "E": 2.25e-4}


@pytest.fixture(scope="module")
def free():
    rest = RigSettings(
        protocol="ringdown", ball=False, E=0.0, settle=0.0, duration=15.0, rate=12800.0, start=(0.012, 0.0, 0.0, 0.0)
    )
    return [ring_down(read_raw(raw_run(rest, 5)))]


@pytest.fixture(scope="module")
def run():
    return raw_run(RigSettings(**SET), 7)


def found(findings, name):
    return next((each for each in findings if each.name == name), None)


def test_a_recording_without_hum_is_left_as_it_is(run):
    recording = read_raw(run)
    same, hum = without_hum(recording, 8.8155)
    assert same is recording
    assert hum is None


def test_hum_that_wanders_is_taken_off_and_told(run, free):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        plain = reconstruct(read_raw(run), free)
        noisy = reconstruct(read_raw(disturbed(run, Disturbances(hum=(Hum(50.03, 3e-3, 0.01),)), 1)), free)
    hum = found(noisy.findings, "hum")
    assert hum.passed
    assert "50.0" in hum.text
    assert "lo_disp" in hum.text
    assert len(noisy.impacts) == len(plain.impacts) == len(run.truth["impacts"]["t"])
    assert abs(noisy.quantities["r"].value - plain.quantities["r"].value) < 5e-4
    assert noisy.residual < 1.2 * plain.residual


@pytest.mark.full
def test_modes_that_hide_every_corner_are_found_with_their_frequencies(run, free):
    modes = tuple(Ringing("lo_disp", f, z, 0.2) for f, z in ((38.0, 0.02), (112.0, 0.015), (310.0, 0.01)))
    made = reconstruct(read_raw(disturbed(run, Disturbances(ringing=modes), 1)), free)
    text = found(made.findings, "frame_modes").text
    told = [float(part.split(" Hz")[0].split()[-1]) for part in text.split(", ", 1)[1].split("; ")]
    assert all(min(abs(f - one) for one in told) < 0.02 * f for f in (38.0, 112.0, 310.0))
    assert abs(len(made.impacts) - len(run.truth["impacts"]["t"])) <= 4
    assert abs(made.quantities["r"].value - 0.65) < 0.005


def left_over(size):
    """Return a response of which a fit left noise, and what two modes ring after impacts."""
    rng = np.random.default_rng(8)
    t = np.arange(12 * 3200) / 3200
    hits = np.sort(rng.uniform(0.0, 12.0, 90)) + 0.06 * np.arange(90)
    hits = hits[hits < 12.0]
    dv = 0.015 * rng.choice([-1.0, 1.0], len(hits))
    left = 5e-7 * rng.normal(size=len(t))
    for f in (37.0, 107.0):
        s = 2 * np.pi * f * complex(-0.02, 1.0)
        left += size * (rung(t, hits, dv, s)[0] / 0.015).imag
    fit = SimpleNamespace(left_t=t, left=left, jumps=SimpleNamespace(t=hits, dv=dv), noise=5e-7, residual=np.std(left))
    return SimpleNamespace(fit=fit, order=0, bins=SimpleNamespace(width=1 / 3200))


def test_what_rings_on_below_the_gates_is_seen_and_noise_is_not():
    size, frequencies = still_rings(left_over(2e-6))
    assert size > 0.5
    assert any(abs(f - 107.0) < 3 for f in frequencies)
    assert still_rings(left_over(0.0)) is None
    assert still_rings(left_over(2e-7)) is None


def test_lost_signal_is_bridged_counted_and_marked(run, free):
    t = np.array(run.truth["impacts"]["t"])
    bursts = tuple(
        Burst("lo_disp", kind, float(when) - 4e-3, 8e-3) for kind, when in (("held", t[40]), ("spike", t[90]))
    )
    made = reconstruct(read_raw(disturbed(run, Disturbances(bursts=bursts), 1)), free)
    told = found(made.findings, "lost_signal")
    assert told.passed
    assert "held" in told.text
    assert "wild" in told.text
    marked = made.impacts["t"][made.impacts["bridged"]]
    assert len(marked) == 2
    assert np.allclose(marked, t[[40, 90]], atol=1e-3)


def test_a_restitution_that_falls_is_named_and_not_accepted(free):
    worn = RigSettings(**SET | {"r": 0.68, "r_course": ((0.0, 0.0), (12.0, -0.07))})
    made = reconstruct(read_raw(raw_run(worn, 7)), free)
    assert not made.accepted
    assert made.reasons.startswith("the restitution changes by -0.0")
    # A sharp mean over impacts of 12 s: scatter .01 leaves .0024.
    assert abs(made.quantities["drift_r"].value + 0.07) < 0.01


def test_the_false_alarm_rate_of_a_trend_is_that_stated():
    rng = np.random.default_rng(4)
    alarms = 0
    for _ in range(1000):
        # Neighbours are alike, as periods of a wandering motion are.
        noise = np.convolve(rng.normal(size=220), np.ones(6), "valid")
        one = trend(np.arange(len(noise), dtype=float), noise)
        alarms += abs(one.value) > 3.2905 * one.u
    # One in a thousand is asked for; up to four were seen where neighbours are alike.
    assert alarms <= 10 * 1000 * FALSE_ALARM


def test_dwells_of_a_staircase_are_found_and_a_ramp_has_none():
    t = (np.arange(60 * 800) + 0.5) / 800
    stairs = np.select([t < 20, t < 40], [1.0, 1.1], 1.25)
    rng = np.random.default_rng(1)

    def shape(size):
        return envelope(Bins(t, size * np.sin(2 * np.pi * 8.8 * t) + 1e-3 * rng.normal(size=len(t)), 1 / 800), 8.8)

    told = dwells(shape(stairs))
    assert [round(each.size, 2) for each in told] == [1.0, 1.1, 1.25]
    assert all(abs(each.end - after.begin) < 1.0 for each, after in pairwise(told))
    assert len(dwells(shape(np.ones(len(t))))) == 1
    assert dwells(shape(1 + 0.02 * t)) == ()
