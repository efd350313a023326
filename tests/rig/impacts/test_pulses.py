"""Pulses of the acceleration: half sines that excite ringing are found with their area and centroid."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import bilinear, lfilter

from vines.rig import Sampled
from vines.rig.fit import Train
from vines.rig.impacts._pulses import SMOOTH, filled, find_pulses, pulses_of, refine_pulses

RATE, FINE = 51200.0, 16
MODES = ((1300.0, 0.01), (2900.0, 0.008), (6100.0, 0.006))
"""Frequency [Hz] and damping ratio of what rings."""


def heard(middles, areas, lengths, gains, seconds=0.4):
    """Return what an accelerometer shows of half-sine contacts: the rigid body, and modes that they excite."""
    fine = RATE * FINE
    t = (np.arange(round(seconds * fine)) + 0.5) / fine
    a = np.zeros(len(t))
    for middle, area, length in zip(middles, areas, lengths, strict=True):
        near = np.abs(t - middle) < 0.5 * length
        a[near] += area * 0.5 * np.pi / length * np.cos(np.pi * (t[near] - middle) / length)
    total = a.copy()
    for (f, zeta), gain in zip(MODES, gains, strict=True):
        w = 2 * np.pi * f
        total += gain * lfilter(*bilinear([1, 0, 0], [1, 2 * zeta * w, w**2], fine), a)
    values = total.reshape(-1, FINE).mean(axis=1)
    return Sampled("acc", "lo_acc", RATE, 0.5 / RATE, values, np.ones(len(values), bool))


PLACES = st.lists(st.floats(0.0, 1.0), min_size=1, max_size=6)


@settings(max_examples=25)
@given(
    places=PLACES,
    data=st.data(),
    gains=st.tuples(*(st.floats(-0.5, 0.5) for _ in MODES)),
)
def test_area_and_centroid_of_half_sines_that_ring(places, data, gains):
    count = len(places)
    # At least 12 ms apart, anywhere between samples.
    middles = 0.03 + 0.34 * (np.sort(places) * (1 - 0.036 * count) + 0.036 * np.arange(count))
    size = st.floats(3e-3, 4e-2).flatmap(lambda x: st.sampled_from([x, -x]))
    areas = np.array(data.draw(st.lists(size, min_size=count, max_size=count)))
    lengths = np.array(data.draw(st.lists(st.floats(70e-6, 200e-6), min_size=count, max_size=count)))
    pulses = pulses_of(heard(middles, areas, lengths, gains))
    found = find_pulses(pulses, 0.4)
    np.testing.assert_allclose(found.t, middles, rtol=0, atol=4e-6)
    # Far below its resonance a mode of gain g shows as -g/omega^2 of the second derivative of the smoothed pulse, which
    # takes g/2(omega s)^2 and 3g/4(omega s)^4 off its area.
    slow = [1 / (2 * np.pi * f * SMOOTH) ** 2 for f, _ in MODES]
    quiet = 1 - sum(gain * (x / 2 + 3 * x**2 / 4) for gain, x in zip(gains, slow, strict=True))
    np.testing.assert_allclose(found.dv, quiet * areas, rtol=0.004, atol=1e-5)


def test_noise_moves_a_pulse_by_its_own_error():
    """White noise that was smoothed by a Gaussian of s, then matched with it, in closed form."""
    rng = np.random.default_rng(9)
    middles = np.linspace(0.02, 0.38, 25) + 1e-5 * rng.uniform(size=25)
    clean = heard(middles, np.full(25, 0.01), np.full(25, 1e-4), (0.0, 0.0, 0.0))
    sigma, errors = 0.03, []
    for _ in range(20):
        values = clean.values + sigma * rng.normal(size=len(clean.values))
        found = find_pulses(pulses_of(Sampled("acc", "lo_acc", RATE, clean.start, values, clean.valid)), 1.0)
        errors.append(np.stack([found.t - middles, found.dv - 0.01]))
    u_dv = sigma * np.sqrt(SMOOTH / RATE * np.sqrt(2 * np.pi))
    u_t, seen = u_dv * SMOOTH / 0.01, np.std(errors, axis=(0, 2))
    assert seen[1] == pytest.approx(u_dv, rel=0.15)
    assert seen[0] == pytest.approx(u_t, rel=0.15)


def test_second_derivative_of_a_displacement_shows_the_same_jumps():
    t = (np.arange(round(0.4 * RATE)) + 0.5) / RATE
    middles, areas = np.array([0.0701, 0.1999, 0.3003]), np.array([0.02, -0.01, 0.03])
    x = sum(area * np.maximum(t - middle, 0.0) for middle, area in zip(middles, areas, strict=True))
    found = find_pulses(pulses_of(Sampled("laser", "lo_disp", RATE, t[0], x, np.ones(len(t), bool)), 0), 0.3)
    np.testing.assert_allclose(found.t, middles, rtol=0, atol=2e-6)
    np.testing.assert_allclose(found.dv, areas, rtol=2e-3)


def test_a_dropout_is_bridged_by_a_cubic():
    t = np.arange(4000) / RATE
    values = 3.0 + 40.0 * t - 900.0 * t**2 + 5e3 * t**3
    valid = np.ones(4000, bool)
    valid[1000:1040] = valid[2500:2503] = False
    spoilt = np.where(valid, values, 99.0)
    np.testing.assert_allclose(filled(Sampled("a", "lo_acc", RATE, 0.0, spoilt, valid)), values, rtol=1e-9)


def test_a_sloping_background_does_not_shift_a_small_pulse():
    """Harmonics that a displacement sensor adds are large in the acceleration: a slope under a small pulse."""
    middle, area = 0.2003, 2e-3
    pulses = pulses_of(heard([middle], [area], [2e-4], [0.0] * len(MODES)))
    sloping = pulses.less(-(0.1 + 60.0 * (pulses.t - middle)))
    known = Train.alike(np.array([middle]), np.array([area]), 1e-6)
    plain, level = refine_pulses(sloping, known), refine_pulses(sloping, known, level=True)
    assert abs(plain.t[0] - middle) > 1e-5
    assert level.t[0] == pytest.approx(middle, abs=1e-6)
    assert level.dv[0] == pytest.approx(area, rel=6e-3)
