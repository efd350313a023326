"""Clocks of two recorders that saw one motion, by offsets and paces that are known."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vines.errors import RigError
from vines.rig.ingest._calibrate import Calibrated
from vines.rig.ingest._clock import align_clocks
from vines.rig.ingest._run_form import ChannelRow

F, RATE = 8.816, 2048.0


def channel(recorder, role, signal, offset=0.0, pace=1.0, u_delay=0.0, seconds=20.0):
    """Return what a recorder makes of a motion: it counts its own time, of which t = offset + pace * own."""
    quantity = "acceleration" if role.endswith("acc") else "displacement"
    row = ChannelRow(
        name=f"{role}_{recorder}", role=role, quantity=quantity, file="a", field="a", unit="V", sensitivity="scaled",
        u_sensitivity=0.0, sign="+1", fs=RATE, range=10.0, group_delay=0.0, u_delay=u_delay, recorder=recorder,
    )  # fmt: skip
    own = np.arange(round(seconds * RATE)) / RATE
    values = signal(offset + pace * own)
    return Calibrated(row, values, np.ones(len(own), bool), RATE, 0.0, 0)


def shaken(t):
    return np.sin(2 * np.pi * F * t + 0.4) + 0.02 * np.sin(4 * np.pi * F * t)


def pushed(t):
    return -((2 * np.pi * F) ** 2) * shaken(t)


@settings(max_examples=20)
@given(offset=st.floats(-0.045, 0.045), ppm=st.floats(-120, 120), roles=st.sampled_from([0, 1]))
def test_offset_and_pace_are_found(offset, ppm, roles):
    pace = 1 + 1e-6 * ppm
    first = channel("a", "base_acc", pushed)
    second = channel("b", *(("base_acc", pushed), ("base_disp", shaken))[roles], offset, pace)
    clocks = align_clocks([first, second], max_offset=0.05, ringdown=False)
    assert (clocks["a"].offset, clocks["a"].pace) == (0.0, 1.0)
    assert clocks["b"].pace == pytest.approx(pace, abs=2e-8)
    assert clocks["b"].offset == pytest.approx(offset, abs=1e-6)


def test_uncertainty_of_delays_counts():
    first = channel("a", "base_acc", pushed, u_delay=3e-6)
    second = channel("b", "base_acc", pushed, 0.01, u_delay=4e-6)
    assert align_clocks([first, second], max_offset=0.05, ringdown=False)["b"].u == pytest.approx(5e-6, rel=0.05)


def test_a_mode_louder_than_the_motion_is_no_clock_that_jumps():
    def rings(t):
        return pushed(t) + 9e3 * np.sin(2 * np.pi * 40.0 * t + 0.8 * (t > 7.3))

    pair = [channel("a", "base_acc", rings), channel("a", "base_disp", shaken)]
    assert set(align_clocks(pair, max_offset=0.05, ringdown=False)) == {"a"}
    with pytest.raises(RigError, match="jumps by about"):
        align_clocks(pair[:1], max_offset=0.05, ringdown=False)


def test_a_ring_down_is_aligned_by_the_oscillator():
    def decays(t):
        return np.exp(-0.3 * t) * np.cos(55.4 * t)

    pair = [channel("a", "lo_disp", decays), channel("b", "lo_disp", decays, 0.02, 1 + 5e-5)]
    found = align_clocks(pair, max_offset=0.05, ringdown=True)["b"]
    assert found.offset == pytest.approx(0.02, abs=2e-5)


@pytest.mark.parametrize(
    ("change", "max_offset", "reason"),
    [
        ({"pace": 1.0005}, 0.05, "ppm apart, allowed are 300; one sampling rate is wrong"),
        ({"offset": 0.03}, 0.02, r"is 30 ms off base_acc_a \(raw/a, a\), allowed are 20 ms \(max_offset in run.json\)"),
        ({"offset": 0.03}, 0.06, "tells offsets apart only below half its period"),
    ],
)
def test_clocks_that_cannot_be_aligned_say_why(change, max_offset, reason):
    pair = [channel("a", "base_acc", pushed), channel("b", "base_acc", pushed, **change)]
    with pytest.raises(RigError, match=reason) as caught:
        align_clocks(pair, max_offset=max_offset, ringdown=False)
    assert "\n" not in str(caught.value)


def test_samples_that_were_lost_are_seen():
    one = channel("a", "base_acc", pushed)
    cut = one.values.copy()
    cut[10_000:-40] = cut[10_040:]
    with pytest.raises(RigError, match=r"jumps by about .* near 4.* s: samples were lost"):
        align_clocks([replace(one, values=cut)], max_offset=0.05, ringdown=False)
